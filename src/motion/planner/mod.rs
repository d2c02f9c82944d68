//! The planner: from targets to moves with speeds, looking ahead. The Console runs it.
//!
//! ```text
//! push(Target) -> step_scale -> geometry -> junction -> | window: moves that wait  | -> profile -> pop() -> Move
//!                 mm to steps   length,     speed at    | planned, planned, ...    |    trapezoid
//!                               direction   the corner  | ^ passes: replan, count  |
//! ```
//!
//! A stream of moves comes by [`add`](Planner::add), which first joins chords that are one line ([`joining`]); `push`
//! plans each move by itself.
//!
//! Positions are kept in steps with their fractions, so that no rounding adds up from move to move. The geometry of a
//! move is computed from the commanded positions. The generator computes the times of its steps.
//!
//! # Words
//!
//! - **look-ahead**, **window**: the moves with speeds that may still change, oldest first. **slot**: where a move is
//!   stored. Its size is `LOOKAHEAD_MOVES` in `planned`.
//! - **purpose**: the use of a move (print, travel, retract), each with its acceleration and least speed; limits of
//!   speed are `Limits` in `geometry`.
//! - **junction speed**: the greatest speed at a corner. **entry**, **exit speed**: how fast a move begins and ends.
//! - **final**: an exit speed that no later move can change. **forced**: a move that leaves though its exit speed is
//!   not final. For it, the window ends where it ended when the move was forced.
//! - **gain**: the possible growth of the square of the speed over a move, `2 a L`.
//! - **pass**: work over all moves of the window, done a few moves at a time.
//! - **chord**: a move that is a part of a curve, or of a straight line. **bend**: where several of them turn the path.
//!   **open line**: see [`joining`]. **pressure**: the extra motion of the extruder for pressure advance, see
//!   [`pressure`]. **lead**: see [`path_curvature`]. **ramp**, **cruise**: the phases of a trapezoid in which the speed
//!   changes, and holds.

mod bed;
mod filament;
mod geometry;
mod joining;
mod junction;
mod leaving;
mod overrides;
mod passes;
mod path_curvature;
mod planned;
mod pressure;
mod profile;
mod step_scale;
mod window;

pub use overrides::WHOLE_SHARE;

use crate::kinematics::Groups;
use crate::motion::moves::{LONG_TIME, Move};
use crate::motion::number::{acceleration, feed_of, feed_speed};
use crate::motion::surface::SurfaceFrame;
use crate::port::EndstopSet;
use crate::settings::Settings;
use crate::surface::Mesh;
use crate::units::{Feed, Length, Mm, MmPerSec, MmPerSec2, Seconds, SpeedSq, Steps};
use bed::{Bed, Demand, bent_limits};
use geometry::{Belts, Geometry, Limits, Shares};
use joining::OpenLine;
use junction::{AccelLimits, Arc, junction_speed_sq};
use overrides::Override;
use path_curvature::PathCurvature;
use planned::Planned;
pub use planned::{LOOKAHEAD_MOVES, MoveMemory};
use pressure::{Flow, Most, Pressure};
use profile::{AdvanceAndWatch, MoveSpec, max_ramp_length};
use step_scale::StepScale;
use window::Window;

/// Where to go, and how fast.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Target {
    /// x, y, z and e.
    pub position: [Mm; 4],
    /// Speed along the path.
    pub speed: Feed,
    /// Whether the feed and the flow override have a say in it.
    pub has_overrides: bool,
    /// Endstops that end the move early; such a move begins and ends at rest.
    pub watch: EndstopSet,
}

/// Moves shorter than this wait for the next target instead of being planned. A move of 0.5 um is a twentieth of a step
/// of the belt, and its time would be lost between two ticks.
const LEAST_LENGTH: Length = Length((1 << 32) / 2000);

/// From this many ticks on, 27 s, the 30 bits of a length are too few for its time.
const LONG_TICKS: u32 = LONG_TIME.whole_ticks() as u32;

/// Between millimetres and steps of x, y, z and e.
fn step_scales(settings: &Settings) -> [StepScale; 4] {
    settings.axes.map(|a| StepScale::new(a.steps_per_mm)).to_array()
}

/// Looks ahead over targets and releases moves.
pub struct Planner<'m> {
    pub(in crate::motion) window: Window<'m>,
    pub(in crate::motion) step_scale: [StepScale; 4],
    pub(in crate::motion) belts: Belts,
    bed: Bed,
    /// Where the last move ends.
    pub(in crate::motion) end: [Steps; 4],
    /// The last target: an axis with the same target again stays where it is.
    pub(in crate::motion) asked: [Mm; 4],
    /// The vector of the planned move; while a line is open, its first chord. It is made here, because a copy of it
    /// takes as long as making it.
    vector: Geometry,
    /// The last move, needed for the next corner.
    last: Geometry,
    /// The limit of its exit speed squared.
    pub(in crate::motion) last_exit_limit_sq: SpeedSq,
    /// What the rule for corners gives it.
    last_arc: Arc,
    /// How the path bends there.
    path_curvature: PathCurvature,
    /// The last move, if chords may continue it.
    line: OpenLine,
    /// The part of the extruder's limits that the moves so far have left.
    pressure: Pressure,
    /// Nominal time of the moves in the window, in ticks.
    pub(in crate::motion) waiting: u64,
    /// The wanted share of the feed.
    pub(in crate::motion) wanted: Override,
    /// Filament where the last move ends that has left.
    pub(in crate::motion) released_filament: Steps,
    moves: u32,
    /// Moves that the mesh has made slower, wrapping.
    slowed_moves: u32,
    /// Moves that wait: the moves of the window, and the open line. Each turn of the Console reads it.
    count: usize,
    /// Path of the tool; wraps.
    path: Length,
}

impl<'m> Planner<'m> {
    /// A planner for a machine that stands at `position` (x, y, z, e).
    #[must_use]
    pub fn new(memory: &'m mut MoveMemory, settings: &Settings, position: [Mm; 4]) -> Self {
        let mut planner = Self {
            window: Window::new(memory),
            step_scale: step_scales(settings),
            belts: Belts::new(&Groups::new(&settings.mechanism)),
            bed: Bed::new(),
            end: [Steps::ZERO; 4],
            asked: position,
            vector: Geometry::NONE,
            last: Geometry::NONE,
            last_exit_limit_sq: SpeedSq::ZERO,
            last_arc: Arc::NONE,
            path_curvature: PathCurvature::default(),
            line: OpenLine::NONE,
            pressure: Pressure::NONE,
            waiting: 0,
            wanted: Override::NONE,
            released_filament: Steps::ZERO,
            moves: 0,
            slowed_moves: 0,
            count: 0,
            path: Length::ZERO,
        };
        planner.end = planner.steps(position);
        planner.released_filament = planner.end[3];
        planner
    }

    /// Takes over new resolutions (M92) at rest.
    pub fn set_resolution(&mut self, settings: &Settings) {
        self.step_scale = step_scales(settings);
        if self.bed.is_in_use() {
            self.bed.use_it(true, settings);
        }
    }

    /// Has another mesh of the bed, or none. It is not in use; the caller gives the planner its position.
    pub fn set_mesh(&mut self, mesh: Option<Mesh>) {
        self.bed.set(mesh);
    }

    /// Counts z from the mesh, or from the machine's zero; the machine is at rest, and its position follows.
    pub fn use_mesh(&mut self, is_in_use: bool, settings: &Settings) {
        self.bed.use_it(is_in_use, settings);
    }

    /// The mesh of the bed, in use or not.
    #[must_use]
    pub fn mesh(&self) -> Option<&Mesh> {
        self.bed.mesh()
    }

    /// Moves that are slower on the mesh than on a flat bed, wrapping.
    #[must_use]
    pub const fn slowed_moves(&self) -> u32 {
        self.slowed_moves
    }

    /// Where the mesh lies, for the generator; none if it is not in use.
    #[must_use]
    pub const fn surface(&self) -> &SurfaceFrame {
        self.bed.frame()
    }

    /// The motors' position for a position of the planner.
    #[must_use]
    pub fn to_real(&self, position: [Steps; 4]) -> [Steps; 4] {
        self.bed.to_real(position)
    }

    /// The planner's position for a position of the motors.
    #[must_use]
    pub fn to_planned(&self, position: [Steps; 4]) -> [Steps; 4] {
        self.bed.to_planned(position)
    }

    /// Takes over another grouping of motors with its settings; the machine is at rest, and its position follows.
    pub fn regroup(&mut self, settings: &Settings, groups: &Groups) {
        self.set_resolution(settings);
        self.belts = Belts::new(groups);
    }

    /// The generator follows an advance over that window from now on, if any; the machine stands.
    pub fn set_advance_window(&mut self, window: Option<Seconds>) {
        self.pressure = Pressure::new(window);
    }

    /// Whether the window of the advance is still in memory as it was.
    #[must_use]
    pub fn has_advance_window(&self, window: Option<Seconds>) -> bool {
        self.pressure.is_for(window)
    }

    /// Whether the values derived from the settings are unchanged in memory: resolutions, the rows of the belt
    /// motors, and the mesh with its place.
    #[must_use]
    pub fn is_whole(&self, settings: &Settings, groups: &Groups) -> bool {
        self.step_scale == step_scales(settings) && self.belts == Belts::new(groups) && self.bed.is_whole(settings)
    }

    /// A position in steps.
    #[must_use]
    pub fn steps(&self, position: [Mm; 4]) -> [Steps; 4] {
        let [x, y, z, e] = self.step_scale;
        let [px, py, pz, pe] = position;
        [x.steps(px), y.steps(py), z.steps(pz), e.steps(pe)]
    }

    /// A position in mm. The counts of e wrap in a long print, so its position is the one nearest to the last target.
    #[must_use]
    pub fn mm(&self, steps: [Steps; 4]) -> [Mm; 4] {
        let ([x, y, z, e], [.., asked]) = (self.step_scale, self.asked);
        let [sx, sy, sz, se] = steps;
        let [x, y, z] = [x.mm(sx), y.mm(sy), z.mm(sz)];
        [x, y, z, e.mm_near(se, asked)]
    }

    /// The vector between two positions.
    #[inline(never)]
    fn geometry_between(&self, from: [Steps; 4], [x, y, z, e]: [Steps; 4]) -> Geometry {
        let ([px, py, pz, pe], [from_x, from_y, from_z, from_e]) = (&self.step_scale, from);
        let (x, y) = (px.distance(x.wrapping_sub(from_x)), py.distance(y.wrapping_sub(from_y)));
        Geometry::new(&[x, y, pz.distance(z.wrapping_sub(from_z)), pe.distance(e.wrapping_sub(from_e))])
    }

    /// Forgets all moves: the machine stands at `position` in steps.
    pub fn stand_at(&mut self, position: [Steps; 4]) {
        if self.line.is_open() {
            // It was planned, and the path that is not made will be taken back.
            self.path = self.path.wrapping_add(self.geometry_between(self.line.begin(), self.end).path());
        }
        self.line.forget();
        self.window.clear();
        self.count = 0;
        // The direction of the last move no longer matters.
        self.last = Geometry::NONE;
        self.pressure.rest();
        self.waiting = 0;
        self.end = position;
        self.released_filament = position[3];
        self.asked = self.mm(position);
    }

    /// Where the last planned move ends, in steps.
    #[must_use]
    pub const fn end(&self) -> [Steps; 4] {
        self.end
    }

    /// Plans a single move to `target`; false if it has no length and so is no move. The caller has asked
    /// [`has_room`](Self::has_room).
    pub fn push(&mut self, target: &Target, settings: &Settings) -> bool {
        self.close_line(settings);
        while !self.replan() {}
        let begin = self.end;
        if !self.go_to(&target.position) {
            return false;
        }
        self.count_move();
        self.place(target, &begin, max_ramps(&self.vector, settings), settings);
        true
    }

    /// There is another move, in the window or the open line.
    #[inline(always)]
    const fn count_move(&mut self) {
        self.moves = self.moves.wrapping_add(1);
        self.count += 1;
    }

    /// Goes to `position`, which then is the end of the last move, and finds the vector. False if that is too short to
    /// be a move.
    #[inline(always)]
    fn go_to(&mut self, position: &[Mm; 4]) -> bool {
        let is_move = find_path(&self.step_scale, &self.asked, position, &mut self.end, &mut self.vector);
        // Written out, for copies of arrays are calls.
        let [x, y, z, e] = *position;
        self.asked = [x, y, z, e];
        is_move
    }

    /// Gives the move from `begin` to the end of the last move its place in the window. Its vector is known (`vector`),
    /// and this part of its length may be for ramps.
    #[inline(never)]
    fn place(&mut self, target: &Target, begin: &[Steps; 4], max_ramp_length: Length, settings: &Settings) {
        let vector = &self.vector;
        let is_extruder_only = vector.is_extruder_only();
        let (least, most) = purpose(vector, settings);
        let feed = target.speed.max(least.into());
        let is_on_bed = self.bed.is_in_use();
        let demand = if is_on_bed {
            let [_, _, last_up] = self.last.direction;
            let ends = [begin, &self.end];
            self.bed.demand(ends, vector.direction, last_up == 0.0, acceleration(most), settings)
        } else {
            Demand::FLAT
        };
        let shares = Shares::new(vector.direction, vector.extrusion, &self.belts, &demand);
        let mut limits = Limits::of_acceleration(settings);
        // Without a wanted speed: M220 may ask for a faster one while the move waits.
        let max_speed = shares.bound(f32::INFINITY, &Limits::of_speed(settings));
        let [_, _, of_z, _] = &mut limits.axes;
        let [max_speed, left] = bent_limits(&demand, max_speed, *of_z);
        // Acceleration that z spends on the surface's curve is missing in ramps and corners.
        *of_z = left;
        if is_on_bed && is_faster_on_flat(vector, &self.belts, [max_speed, feed_speed(feed)], settings) {
            self.slowed_moves = self.slowed_moves.wrapping_add(1);
        }
        let wanted_accel = shares.bound(acceleration(most), &limits);
        let arc = Arc::new(settings.corner, wanted_accel, acceleration(most));
        // The extruder limits ramps, but not corners: there the tool accelerates sideways, and the filament does not.
        let mut most = Most { acceleration: wanted_accel, speed: max_speed };
        // For lines that print: not for retractions, nor for wipes that retract on their way.
        let advance = if vector.extrusion > 0.0 && !is_extruder_only { settings.advance.time } else { Seconds::ZERO };
        let jump = if self.pressure.is_in_use() {
            let flow = Flow { geometry: vector, advance: advance.to_num(), feed: feed_speed(feed) };
            self.pressure.bound(&flow, &self.last, &mut most, settings)
        } else {
            (self.last.extrusion - vector.extrusion).abs()
        };
        let accel_limits = AccelLimits {
            acceleration: wanted_accel,
            max_speed: most.speed,
            limits: &limits,
            belts: &self.belts,
            demand: &demand,
            arcs: [self.last_arc, arc],
        };
        let junction_sq =
            junction_speed_sq(&self.last, vector, &mut self.path_curvature, jump, &accel_limits, settings);
        let (has_overrides, [x, y, z, e]) = (target.has_overrides, self.end);
        let cumulative_gain_sq = self.window.total_gain_sq();
        let pushed = self.window.push(|planned| {
            *planned = Planned {
                spec: MoveSpec {
                    length: vector.length,
                    max_ramp_length,
                    // Cut off, so never above the limit, and never 0, which would be a ramp without an end.
                    acceleration: MmPerSec2::from_bits((most.acceleration * 256.0) as u32).max(MmPerSec2::DELTA),
                    nominal: feed,
                    max_speed: feed_of(most.speed),
                    end: [x, y, z, e],
                    own: AdvanceAndWatch::new(advance, target.watch),
                },
                feed: if has_overrides { feed } else { Feed::ZERO },
                junction_sq,
                max_entry_sq: SpeedSq::ZERO,
                cumulative_gain_sq,
                forced_end_sq: SpeedSq::ZERO,
                nominal_ticks: 0,
            };
            planned.set_nominal(if has_overrides { self.wanted.of(feed) } else { feed });
            // With the exit limit of the move before, which is replaced by its own in the next line.
            planned.limit_entry(self.last_exit_limit_sq);
            self.last_exit_limit_sq = planned.exit_limit_sq();
            self.waiting += u64::from(planned.nominal_ticks);
            if planned.nominal_ticks >= LONG_TICKS {
                planned.spec.length = exact_length(&self.step_scale, begin, &self.end, vector.length);
            }
        });
        debug_assert!(pushed.is_ok(), "the caller has made room");
        if pushed.is_err() {
            // It is left out, and the next one starts where it would have.
            (self.count, self.end, self.asked) = (self.window.len(), *begin, self.mm(*begin));
            return;
        }
        self.last.copy_from(&self.vector);
        self.last_arc = arc;
        self.path = self.path.wrapping_add(self.vector.path());
    }

    /// Whether a target at `position` would be a move.
    #[must_use]
    pub fn is_move(&self, position: [Mm; 4]) -> bool {
        let (mut end, mut vector) = (self.end, Geometry::NONE);
        find_path(&self.step_scale, &self.asked, &position, &mut end, &mut vector)
    }

    /// The last move ended early, at `position`: takes back the path that was not made.
    pub fn fall_short(&mut self, position: [Steps; 4]) {
        self.path = self.path.wrapping_sub(self.geometry_between(self.end, position).path());
    }
}

/// Takes `end` to the end of the move from there to `position`, and finds its vector; `asked` is the position that was
/// commanded before. False if it is too short to be a move: then the end stays, and the vector says nothing.
#[inline(never)]
fn find_path(
    step_scale: &[StepScale; 4],
    asked: &[Mm; 4],
    position: &[Mm; 4],
    end: &mut [Steps; 4],
    vector: &mut Geometry,
) -> bool {
    // Written out: firmware is made for size, which leaves loops and arrays as they are.
    let ([x, y, z, e], [asked_x, asked_y, asked_z, asked_e]) = (*position, *asked);
    let ([px, py, pz, pe], [from_x, from_y, from_z, from_e]) = (step_scale, *end);
    let (x, dx) = px.end_and_distance(x, asked_x, from_x);
    let (y, dy) = py.end_and_distance(y, asked_y, from_y);
    let (z, dz) = pz.end_and_distance(z, asked_z, from_z);
    let (e, de) = pe.end_and_distance(e, asked_e, from_e);
    vector.set(&[dx, dy, dz, de]);
    let is_of_tool = !vector.is_extruder_only() && vector.length >= LEAST_LENGTH;
    if is_of_tool {
        *end = [x, y, z, e];
        return true;
    }
    // The rest of an axis is made up when it is next sent to another position.
    vector.set(&[Mm::ZERO, Mm::ZERO, Mm::ZERO, de]);
    let is_of_filament = vector.length >= LEAST_LENGTH;
    if is_of_filament {
        *end = [from_x, from_y, from_z, e];
    }
    is_of_filament
}

/// The exact distance from `begin` to `end`, given one with 30 right bits.
#[cold]
#[inline(never)]
fn exact_length(step_scale: &[StepScale; 4], begin: &[Steps; 4], end: &[Steps; 4], about: Length) -> Length {
    let mut ways = [0; 4];
    for (((way, scale), to), from) in ways.iter_mut().zip(step_scale).zip(end).zip(begin) {
        *way = scale.mm(to.wrapping_sub(*from)).to_bits();
    }
    let [x, y, z, e] = ways;
    let square = |way: i64| i128::from(way) * i128::from(way);
    let sum = if x | y | z == 0 { square(e) } else { square(x) + square(y) + square(z) };
    // One of Newton's steps.
    let about = about.0.cast_signed();
    Length(about.saturating_add((sum - square(about)) as i64 / about.saturating_mul(2).max(1)).unsigned_abs())
}

/// The part of a move's length that may be for ramps.
#[inline(always)]
fn max_ramps(vector: &Geometry, settings: &Settings) -> Length {
    if vector.is_extruder_only() {
        vector.length
    } else {
        max_ramp_length(vector.length, settings.minimum_cruise_ratio)
    }
}

/// Whether a move that may go at `most` instead of `feed` may go faster on a flat bed.
#[inline(never)]
fn is_faster_on_flat(vector: &Geometry, belts: &Belts, [most, feed]: [f32; 2], s: &Settings) -> bool {
    let flat = Shares::new(vector.direction, vector.extrusion, belts, &Demand::FLAT);
    most < feed && most < flat.bound(feed, &Limits::of_speed(s))
}

/// Least speed and acceleration of a move, by its purpose: print, travel, or retract.
#[inline(always)]
fn purpose(vector: &Geometry, s: &Settings) -> (MmPerSec, MmPerSec2) {
    if vector.is_extruder_only() {
        (MmPerSec::ZERO, s.retract_acceleration)
    } else if vector.extrusion != 0.0 {
        (s.min_feed, s.print_acceleration)
    } else {
        (s.min_travel, s.travel_acceleration)
    }
}
