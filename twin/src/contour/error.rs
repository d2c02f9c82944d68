//! Error: distances of the tool from its line.
//!
//! Only the part of the line is looked at where the tool may be, so that a line beside it is not taken for its own: by the time
//! if the tool follows the line's own steps, otherwise by how far along the line it has come. Near a corner an error towards the inside is rounding, one towards the outside overshoot.

use super::path::{Vertex, nearest};
use super::trail::Trail;
use crate::steps::TICKS_PER_SECOND;

/// The tool is nowhere where it was sent longer ago than this, in ticks: three periods of 60 Hz.
const LATE: u64 = 500_000;

/// Nor where it will be sent later than this, in ticks.
const EARLY: u64 = 20_000;

/// A tool that has its own time is no farther from where it was on the line, in mm.
const NEAR_MM: f64 = 2.0;

/// Of lines as far from the tool as this, to so many mm, the last is the one that it is on: it goes forth and back on some.
const TIE_MM: f64 = 1e-4;

/// A bend of less is none, in rad: chords of curves turn by less.
const LEAST_TURN: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A line that turns by more goes back on itself, along its bisector rather than across it, in rad.
const MOST_TURN: f64 = 136.0 * std::f64::consts::PI / 180.0;

/// Lines shorter than this have the direction of their steps, not their own, in mm.
const LEAST_LINE_MM: f64 = 0.1;

/// An error this far along the line is not the corner's any more, in mm.
const REACH_MM: f64 = 5.0;

/// A corner of the line and the greatest errors about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where it is, in mm.
    pub at: [f64; 2],
    /// When the tool was sent there, in ticks.
    pub tick: u64,
    /// By how much the line turns, in rad, to the left positive.
    pub turn_rad: f64,
    /// Greatest error towards the inside.
    pub rounding_mm: f64,
    /// Greatest error towards the outside.
    pub overshoot_mm: f64,
    /// How far from the corner the tool first crossed its bisector (equation 17 of Yin et al.), inside positive; none if it
    /// never did, or the line turns right back.
    pub bisector_mm: Option<f64>,
    /// Where it is along the line.
    along_mm: f64,
    /// Directions into it and out of it.
    into: [f64; 2],
    out: [f64; 2],
    /// How far the tool was beyond the bisector, and along it towards the inside.
    last: Option<[f64; 2]>,
}

impl Corner {
    /// The greater of its errors.
    #[must_use]
    pub fn worst_mm(&self) -> f64 {
        self.rounding_mm.max(self.overshoot_mm)
    }

    /// The tool is about it. The first crossing of the bisector counts; between two looks its path is a chord.
    fn cross(&mut self, tool: [f64; 2]) {
        let to = [tool[0] - self.at[0], tool[1] - self.at[1]];
        let inside = [self.out[0] - self.into[0], self.out[1] - self.into[1]];
        let length = inside[0].hypot(inside[1]);
        let now = [dot(to, self.into) + dot(to, self.out), dot(to, inside) / length];
        if let (None, Some(before)) = (self.bisector_mm, self.last)
            && before[0] < 0.0
            && now[0] >= 0.0
            && self.turn_rad.abs() < MOST_TURN
        {
            let part = before[0] / (before[0] - now[0]);
            self.bisector_mm = Some(before[1] + part * (now[1] - before[1]));
        }
        self.last = Some(now);
    }

    /// When the tool was sent there.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.tick as f64 / TICKS_PER_SECOND
    }
}

/// Errors of a tool that follows a line.
#[derive(Clone, Debug)]
pub struct ContourError {
    /// The line.
    pub vertices: Vec<Vertex>,
    /// Greatest distance while each vertex was the end of the nearest part of the line, in mm.
    pub errors_mm: Vec<f32>,
    /// Length of the line before each vertex.
    along_mm: Vec<f64>,
    /// Corners in the order of the line.
    pub corners: Vec<Corner>,
    /// First line that is looked at.
    first: usize,
    /// How far the tool has come along the line, if it has its own time.
    come_mm: Option<f64>,
    /// Where the tool was beside the line, for pictures.
    pub trail: Trail,
    /// Greatest distance.
    pub greatest_mm: f64,
    squares: f64,
    samples: u64,
}

impl ContourError {
    /// A tool that is to follow a line.
    #[must_use]
    pub fn new(vertices: Vec<Vertex>) -> Self {
        let length = |pair: &[Vertex]| match pair {
            [a, b] => (b.at[0] - a.at[0]).hypot(b.at[1] - a.at[1]),
            _ => 0.0,
        };
        let ends = vertices.windows(2).scan(0.0, |sum, pair| {
            *sum += length(pair);
            Some(*sum)
        });
        let along_mm: Vec<f64> = std::iter::once(0.0).chain(ends).collect();
        let corners = corners(&vertices, &along_mm);
        let errors_mm = vec![0.0; vertices.len()];
        Self {
            vertices,
            errors_mm,
            along_mm,
            corners,
            first: 0,
            come_mm: None,
            trail: Trail::default(),
            greatest_mm: 0.0,
            squares: 0.0,
            samples: 0,
        }
    }

    /// The same for a tool that goes the line in a time of its own.
    #[must_use]
    pub fn untimed(vertices: Vec<Vertex>) -> Self {
        Self { come_mm: Some(0.0), ..Self::new(vertices) }
    }

    /// Root of the mean square of all distances, in mm.
    #[must_use]
    pub fn rms_mm(&self) -> f64 {
        if self.samples == 0 { 0.0 } else { (self.squares / self.samples as f64).sqrt() }
    }

    /// The tool is here at a time; says how far from the line, in mm.
    pub fn sample(&mut self, tick: u64, tool: [f64; 2]) -> f64 {
        let come = self.come_mm;
        let is_over = |end: usize| match come {
            Some(come) => self.along_mm.get(end).is_some_and(|along| along + NEAR_MM < come),
            None => self.vertices.get(end).is_some_and(|end| end.tick + LATE < tick),
        };
        while is_over(self.first + 1) && self.first + 2 < self.vertices.len() {
            self.first += 1;
        }
        let Some((line, way, distance)) = self.nearest_line(tick, tool) else { return 0.0 };
        if let (Some(come), Some(begin), Some(end)) =
            (&mut self.come_mm, self.along_mm.get(line), self.along_mm.get(line + 1))
        {
            *come = come.max(begin + way * (end - begin));
        }
        self.greatest_mm = self.greatest_mm.max(distance);
        self.squares += distance * distance;
        self.samples += 1;
        if let Some(error) = self.errors_mm.get_mut(line + 1) {
            *error = error.max(distance as f32);
        }
        if let (Some(a), Some(b)) = (self.vertices.get(line), self.vertices.get(line + 1)) {
            let near = [0, 1].map(|i| a.at[i] + way * (b.at[i] - a.at[i]));
            self.trail.add(near, [0, 1].map(|i| tool[i] - near[i]));
        }
        self.put_down(line, way, distance, tool);
        distance
    }

    /// Puts an error at a part of the line (0 at its begin, 1 at its end) down to a corner, if one is near.
    fn put_down(&mut self, line: usize, way: f64, distance: f64, tool: [f64; 2]) {
        let (Some(a), Some(b)) = (self.vertices.get(line), self.vertices.get(line + 1)) else { return };
        let (Some(begin), Some(end)) = (self.along_mm.get(line), self.along_mm.get(line + 1)) else { return };
        let along = begin + way * (end - begin);
        // At a vertex nothing inside of the bend is nearest.
        let is_at_end = way <= 0.0 || way >= 1.0;
        let left = cross([b.at[0] - a.at[0], b.at[1] - a.at[1]], [tool[0] - a.at[0], tool[1] - a.at[1]]);
        self.note(along, distance, if is_at_end { None } else { Some(left) }, tool);
    }

    /// The line that is nearest to the tool, where on it, and how far.
    fn nearest_line(&self, tick: u64, tool: [f64; 2]) -> Option<(usize, f64, f64)> {
        let lines = self.vertices.windows(2).enumerate().skip(self.first);
        let mut best: Option<(usize, f64, f64)> = None;
        for (line, pair) in lines {
            let [a, b] = pair else { continue };
            let is_ahead = match self.come_mm {
                Some(come) => self.along_mm.get(line).is_some_and(|along| *along > come + NEAR_MM),
                None => a.tick > tick + EARLY,
            };
            if is_ahead && best.is_some() {
                break;
            }
            let (way, distance) = nearest(a.at, b.at, tool);
            let tie = if self.come_mm.is_some() { TIE_MM } else { 0.0 };
            if best.is_none_or(|(_, _, least)| distance < least + tie) {
                best = Some((line, way, distance));
            }
        }
        best
    }

    /// Puts an error so far along the line down to the nearest corner, if one is near.
    fn note(&mut self, along: f64, distance: f64, left: Option<f64>, tool: [f64; 2]) {
        let next = self.corners.partition_point(|corner| corner.along_mm < along);
        let near = [next.checked_sub(1), Some(next)].into_iter().flatten();
        let far = |index: &usize| self.corners.get(*index).map_or(f64::INFINITY, |c| (c.along_mm - along).abs());
        let Some(index) = near.min_by(|a, b| far(a).total_cmp(&far(b))) else { return };
        if far(&index) > REACH_MM {
            return;
        }
        let Some(corner) = self.corners.get_mut(index) else { return };
        corner.cross(tool);
        let is_inside = left.is_some_and(|left| left * corner.turn_rad > 0.0);
        let worst = if is_inside { &mut corner.rounding_mm } else { &mut corner.overshoot_mm };
        *worst = worst.max(distance);
    }
}

/// The vertices at which the line turns.
fn corners(vertices: &[Vertex], along_mm: &[f64]) -> Vec<Corner> {
    let mut corners = Vec::new();
    for (three, along) in vertices.windows(3).zip(along_mm.iter().skip(1)) {
        let [a, b, c] = three else { continue };
        let (into, out) = ([b.at[0] - a.at[0], b.at[1] - a.at[1]], [c.at[0] - b.at[0], c.at[1] - b.at[1]]);
        if into[0].hypot(into[1]) < LEAST_LINE_MM || out[0].hypot(out[1]) < LEAST_LINE_MM {
            continue;
        }
        let turn_rad = cross(into, out).atan2(into[0] * out[0] + into[1] * out[1]);
        if turn_rad.abs() >= LEAST_TURN {
            let Vertex { at, tick } = *b;
            corners.push(Corner {
                at,
                tick,
                turn_rad,
                rounding_mm: 0.0,
                overshoot_mm: 0.0,
                bisector_mm: None,
                along_mm: *along,
                into: unit(into),
                out: unit(out),
                last: None,
            });
        }
    }
    corners
}

fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y);
    [x / length, y / length]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Above 0 if `b` points to the left of `a`.
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> ContourError {
        let at = |x: f64, y: f64, tick| Vertex { at: [x, y], tick };
        ContourError::new(vec![at(0.0, 0.0, 0), at(10.0, 0.0, 1000), at(10.0, 10.0, 2000)])
    }

    #[test]
    fn rounding_is_inside_and_overshoot_outside() {
        let mut error = corner();
        error.sample(900, [9.0, 0.2]);
        error.sample(1000, [10.1, 0.5]);
        assert_eq!(error.corners.len(), 1);
        let found = error.corners[0];
        assert!((found.rounding_mm - 0.2).abs() < 1e-12 && (found.overshoot_mm - 0.1).abs() < 1e-12, "{found:?}");
        assert!((error.greatest_mm - 0.2).abs() < 1e-12);
        assert!((error.rms_mm() - (0.025_f64).sqrt()).abs() < 1e-12);
        error.sample(1100, [10.3, -0.4]);
        assert!((error.corners[0].overshoot_mm - 0.5).abs() < 1e-12);
    }

    /// Forth and back on 10 mm and then aside, in twice the time: the tool is never off.
    #[test]
    fn a_tool_with_its_own_time_is_found_on_its_line() {
        let at = |x: f64, y: f64, tick| Vertex { at: [x, y], tick };
        let line = vec![at(0.0, 0.0, 0), at(10.0, 0.0, 1000), at(0.0, 0.0, 2000), at(0.0, 10.0, 3000)];
        let [mut own, mut timed] = [ContourError::untimed(line.clone()), ContourError::new(line)];
        for sample in 0..=300 {
            let way = f64::from(sample) * 0.1;
            let tool = if way < 20.0 { [10.0 - (way - 10.0).abs(), 0.0] } else { [0.0, way - 20.0] };
            let tick = 1_000_000 + 2_000_000 * sample as u64;
            assert!(own.sample(tick, tool) < 1e-9, "{way}");
            timed.sample(tick, tool);
        }
        assert!(timed.greatest_mm > 5.0);
    }

    /// From (9.6, 0) to (10, 0.4) the path is on the line x - y = 9.6, which meets the bisector x + y = 10 at (9.8, 0.2).
    #[test]
    fn a_cut_corner_is_measured_along_its_bisector() {
        let mut error = corner();
        error.sample(900, [9.6, 0.0]);
        error.sample(1000, [10.0, 0.4]);
        error.sample(1100, [10.0, 0.6]);
        let found = error.corners[0].bisector_mm.unwrap();
        assert!((found - 0.2 * std::f64::consts::SQRT_2).abs() < 1e-12, "{found}");
    }

    #[test]
    fn an_error_far_from_the_corner_is_not_the_corners() {
        let mut error = corner();
        error.sample(200, [2.0, -1.0]);
        assert!(error.corners[0].worst_mm() == 0.0 && error.greatest_mm == 1.0);
    }
}
