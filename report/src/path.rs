//! Tool path: where the tool went, exact to one step and of any length.
//!
//! The line is drawn through places at which the tool was, and no place is further from it than a step. Each stretch of
//! step events is cut where it is furthest from its chord, until every place is near enough (Douglas and Peucker,
//! 1973). A straight move seen in whole steps is no further from its chord than that, so it becomes one line. Lines are
//! also cut where the tool would not be there in time, so every line has its speed.
//!
//! The lines go at once to a file from the caller; the memory used here does not grow.

mod filament;
mod store;

pub use store::{Bounds, CHUNK, Chunk, Stored};

use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot_sim::axis_sums::AxisSums;
use corehbot_twin::contour::cut::ends;
use filament::Filament;
use std::io::{self, Write};
use store::Store;

/// Step events that are checked together.
const BLOCK: usize = 1024;

/// How far the tool may be ahead of or after its place on a line that is run at one speed, in mm.
const AHEAD: f64 = 0.25;

/// A stretch of a line that is printed, while other parts of it are not, counts from this length on, in mm.
const SHORTEST_MIX: f64 = 0.3;

/// Where the tool was after a step event.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Place {
    /// In mm.
    at: [f64; 3],
    /// In ticks of motion time.
    tick: u64,
    /// Whether filament was laid on the way here.
    is_printing: bool,
    /// Whether the filament turned here, so that a line ends.
    is_turn: bool,
}

/// The end of a line.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Vertex {
    /// Position in mm.
    pub at: [f64; 3],
    /// When, in ticks of motion time.
    pub tick: u64,
    /// Whether filament was laid on the way here.
    pub is_printing: bool,
}

/// Follows the steps and stores the lines.
pub struct ToolPath<F: Write> {
    axes: AxisSums,
    /// The sums of x, y, z and e, and the mm of a unit of x, y and z.
    sums: [i64; 4],
    unit: [f64; 3],
    origin: [f64; 3],
    /// How far a place may be from its line, in mm.
    tolerance: f64,
    /// The program's z, if z follows a mesh. Real z would show the bed instead of layers.
    on_mesh: Option<f64>,
    filament: Filament,
    /// Places since the last vertex; the first is the vertex.
    places: Vec<Place>,
    store: Store<F>,
}

impl<F: Write> ToolPath<F> {
    /// The path of a tool that begins at `origin` (mm); its lines go to `file`, which is empty.
    #[must_use]
    pub fn new(s: &Settings, origin: [f64; 3], file: F) -> Self {
        let step = [s.axes.x, s.axes.y, s.axes.z].map(|a| 1.0 / a.steps_per_mm.to_num::<f64>());
        let axes = AxisSums::new(&s.mechanism);
        let begin = Place { at: origin, tick: 0, is_printing: false, is_turn: false };
        let mut store = Store::new(file);
        store.add(Vertex { at: begin.at, tick: 0, is_printing: false });
        Self {
            unit: std::array::from_fn(|i| step[i] / axes.over()[i] as f64),
            axes,
            sums: [0; 4],
            origin,
            tolerance: step[0].max(step[1]),
            on_mesh: None,
            filament: Filament::new(origin),
            places: vec![begin],
            store,
        }
    }

    /// From the next event on the path shows this z, or real z.
    pub const fn stand_on_mesh(&mut self, z: Option<f64>) {
        self.on_mesh = z;
    }

    /// One instant in which `steps` move, each forward or backward.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.axes.add_event(&mut self.sums, steps, forward);
        let mut at = std::array::from_fn(|i| self.origin[i] + self.sums[i] as f64 * self.unit[i]);
        if let Some(z) = self.on_mesh {
            at[2] = z;
        }
        let Self { filament, places, sums, .. } = self;
        filament.event(at, tick, sums[3], |place| places.push(place));
        if self.places.len() >= BLOCK {
            self.cut(false);
        }
    }

    /// The whole path.
    ///
    /// # Errors
    /// If a line could not be stored.
    pub fn finish(mut self) -> io::Result<Stored<F>> {
        let Self { filament, places, .. } = &mut self;
        filament.finish(|place| places.push(place));
        self.cut(true);
        self.store.finish()
    }

    /// Makes lines of the places; the last line may still grow unless it is the end.
    fn cut(&mut self, is_end: bool) {
        let last = self.places.len() - 1;
        let ends = ends(last, |begin, end| self.furthest(begin, end));
        // A last line that would be checked again and again is ended as well.
        let is_long = |begin: usize| last - begin > BLOCK / 2;
        let mut begin = 0;
        for end in ends {
            if end == last && !is_end && !is_long(begin) {
                break;
            }
            self.line(begin, end);
            begin = end;
        }
        self.places.drain(..begin);
    }

    /// The place between two others that is furthest from the line between them, if it is too far.
    fn furthest(&self, begin: usize, end: usize) -> Option<usize> {
        let (a, b) = (self.places.get(begin)?, self.places.get(end)?);
        let along: [f64; 3] = std::array::from_fn(|i| b.at[i] - a.at[i]);
        let square = dot(along, along);
        let time = (b.tick - a.tick) as f64;
        // Divisions and roots are taken once for the line: distances are compared by their squares.
        let a_square = if square > 0.0 { 1.0 / square } else { 0.0 };
        let a_tick = if time > 0.0 { 1.0 / time } else { 0.0 };
        let (off_scale, ahead_scale) = (1.0 / (self.tolerance * self.tolerance), square / (AHEAD * AHEAD));
        let mut found = (1.0, None);
        for (index, place) in self.places.iter().enumerate().take(end).skip(begin + 1) {
            if place.is_turn {
                return Some(index);
            }
            let to: [f64; 3] = std::array::from_fn(|i| place.at[i] - a.at[i]);
            let share = (dot(along, to) * a_square).clamp(0.0, 1.0);
            let off: [f64; 3] = std::array::from_fn(|i| to[i] - share * along[i]);
            let ahead = if time > 0.0 { share - (place.tick - a.tick) as f64 * a_tick } else { 0.0 };
            let far = (dot(off, off) * off_scale).max(ahead * ahead * ahead_scale);
            if far > found.0 {
                found = (far, Some(index));
            }
        }
        found.1
    }

    /// Stores the line from one place to another, in parts if only a part of it is printed.
    fn line(&mut self, begin: usize, end: usize) {
        let Some(places) = self.places.get(begin..=end) else { return };
        let mut runs: Vec<(usize, f64, bool)> = Vec::new();
        for (index, pair) in places.windows(2).enumerate() {
            let length = distance(pair[0].at, pair[1].at);
            match runs.last_mut() {
                Some((last, sum, is_printing)) if *is_printing == pair[1].is_printing => {
                    (*last, *sum) = (index + 1, *sum + length);
                }
                _ => runs.push((index + 1, length, pair[1].is_printing)),
            }
        }
        // Steps of the filament are few, so short runs are noise.
        let printed: f64 = runs.iter().filter(|run| run.2).map(|run| run.1).sum();
        let whole: f64 = runs.iter().map(|run| run.1).sum();
        if printed.min(whole - printed) < SHORTEST_MIX {
            runs = vec![(places.len() - 1, whole, printed > 0.5 * whole)];
        }
        for (last, _, is_printing) in runs {
            if let Some(Place { at, tick, .. }) = places.get(last) {
                self.store.add(Vertex { at: *at, tick: *tick, is_printing });
            }
        }
    }
}

fn dot(u: [f64; 3], v: [f64; 3]) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let off = std::array::from_fn(|i| a[i] - b[i]);
    dot(off, off).sqrt()
}
