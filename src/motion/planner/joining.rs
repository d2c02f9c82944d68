//! Joining: a straight line that comes in fine chords is one move.
//!
//! The look-ahead has a number of places. With chords of 0.05 mm they are a few millimetres, and the tool can be no
//! faster than it brakes in them. So chords that are one line are joined before they take a place. The last move is
//! held outside of the [window](super::window) as the **open line** while it is short. A chord that continues it only
//! moves its end.
//!
//! # Which chords are one line
//!
//! - Line and chord are short: see [`BRAKING_PART`].
//! - They have the same feed, and filament goes in the same direction in both, or in neither.
//! - The chord leads on along the **main axis**, along which the first chord is longest.
//! - Every point that is left out lies within a tolerance of the line along each axis, filament included. The line here
//!   moves in proportion to the main axis.
//!
//! The last rule needs no points in memory. A point is at `(m, k)` from the begin, with m along the main axis. It
//! restricts the slope of the line to `(k - t) / m` to `(k + t) / m`. All points together restrict it to one range for
//! each axis, and a chord continues the line if the slope of its end lies in each range. So the tolerance holds for the
//! whole line: bends that are small by themselves do not add up.
//!
//! | tolerance t | where |
//! |---|---|
//! | [`ROUNDED`] | x, y and z, if the point is away from the begin by whole thousandths of a millimetre |
//! | [`EXACT`] | x, y and z otherwise: the host has more digits, so the bend of a polygon is meant |
//! | half a step | filament |
//!
//! # When it is closed
//!
//! The open line is planned and takes its place (it is **closed**) when
//!
//! - a chord makes it long,
//! - a move comes that does not continue it,
//! - settings change, or a fan gets its turn among the moves,
//! - a command waits for the motion,
//! - the look-ahead has no place left, and its first move is not final.
//!
//! All of these depend on the commands alone, and so do the lines. Time has a say where it always has: a stream that
//! runs dry **cuts** the line. The planner remembers that, and a chord that would have continued the line makes an
//! underrun, which is counted.

use super::geometry::Geometry;
use super::{Planner, Target, max_ramps, purpose};
use crate::motion::number::{acceleration, feed_speed};
use crate::port::EndstopSet;
use crate::settings::{Axes, Settings};
use crate::units::{Feed, Mm, MmPerSec2, Steps, TICKS_PER_SECOND};
use core::cmp::Ordering;

/// The largest error of a point along an axis, in mm, where coordinates are rounded to thousandths. It is half a
/// thousandth at the point, and half a thousandth at the ends of the line.
const ROUNDED: f32 = 0.001;

/// The same where coordinates have more digits: their rounding is at least ten times finer.
const EXACT: f32 = 0.000_1;

/// A distance counts as whole thousandths of a millimetre within this error, in raw `Mm` bits times 1000. Both of its
/// ends are rounded by half a bit, and offsets are added to them.
const THOUSANDTHS_SLACK: u32 = 4096;

/// The line grows by at least this many mm along its main axis with each chord: less is no move
/// ([`LEAST_LENGTH`](super::LEAST_LENGTH)).
const LEAST_GROWTH: f32 = 0.0005;

/// A line is long, and closed, when it has this part of the distance in which it brakes from its feed to rest. The
/// look-ahead sees 128 moves at least, so eight times that distance: longer moves need no joining, and keep their
/// corners to the last bit.
const BRAKING_PART: f32 = 1.0 / 16.0;

/// So is a line that takes this long, in seconds at its feed. No more is held back than the stream may have left when
/// it counts as dry (`QUEUE_LOW` of the release policy).
const LONGEST_SECONDS: f32 = 0.02;

/// And a line of this many mm along its main axis: 128 of them are half a metre, more than machines of this kind are
/// long.
const LONGEST: f32 = 4.0;

/// Slopes that points leave to the line, along one axis.
#[derive(Clone, Copy, Debug)]
struct Slopes {
    least: f32,
    most: f32,
}

impl Slopes {
    /// All of them.
    const ALL: Self = Self { least: f32::NEG_INFINITY, most: f32::INFINITY };

    #[inline(always)]
    fn has(self, slope: f32) -> bool {
        self.least <= slope && slope <= self.most
    }

    /// A point with that slope may be off by `off` of slope.
    #[inline(always)]
    fn narrow(&mut self, slope: f32, off: f32) {
        let (least, most) = (slope - off, slope + off);
        if self.least < least {
            self.least = least;
        }
        if self.most > most {
            self.most = most;
        }
    }
}

/// An axis of the tool.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Main {
    X,
    Y,
    Z,
}

/// Whether chords may continue the line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum State {
    /// There is none.
    None,
    /// It is held outside of the window.
    Open,
    /// It has its place in the window, before its time.
    Cut,
}

/// The last move, if chords may continue it.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct OpenLine {
    state: State,
    /// Where it begins.
    begin: [Steps; 4],
    /// Where it was commanded to begin.
    asked: [Mm; 4],
    feed: Feed,
    has_overrides: bool,
    /// The direction of the filament.
    filament: Ordering,
    main: Main,
    /// Its length along the main axis, in mm.
    reached: f32,
    /// The length in mm along the main axis at which it is closed.
    longest: f32,
    /// The ranges of slopes that its points leave for the two other axes and the filament.
    slopes: [Slopes; 3],
    /// Whether it is more than one chord. If not, its vector is [`Planner::vector`].
    is_joined: bool,
}

/// A vector in mm, as slopes are made of it.
struct Way {
    main: f32,
    others: [f32; 2],
    filament: f32,
}

impl OpenLine {
    pub const NONE: Self = Self {
        state: State::None,
        begin: [Steps::ZERO; 4],
        asked: [Mm::ZERO; 4],
        feed: Feed::ZERO,
        has_overrides: false,
        filament: Ordering::Equal,
        main: Main::X,
        reached: 0.0,
        longest: 0.0,
        slopes: [Slopes::ALL; 3],
        is_joined: false,
    };

    /// Whether a line is held outside of the window.
    #[inline(always)]
    pub const fn is_open(&self) -> bool {
        matches!(self.state, State::Open)
    }

    /// Where it begins.
    pub const fn begin(&self) -> [Steps; 4] {
        self.begin
    }

    /// Whether it is long enough to be closed.
    #[inline(always)]
    fn is_long(&self) -> bool {
        self.reached.abs() >= self.longest
    }

    /// No move continues the line.
    pub const fn forget(&mut self) {
        self.state = State::None;
    }

    /// Begins a line with a move from `begin`, with `asked` as the commanded position there; false if the move is too
    /// long for it.
    #[inline(always)]
    fn start(
        &mut self,
        target: &Target,
        first: &Geometry,
        (begin, asked): ([Steps; 4], [Mm; 4]),
        filament_step: f32,
        settings: &Settings,
    ) -> bool {
        let ([x, y, z], Axes { x: of_x, y: of_y, z: of_z, .. }) = (first.direction, &settings.axes);
        let (x, y, z) = (x.abs(), y.abs(), z.abs());
        let (main, share, axis) = match (x, y, z) {
            _ if x >= y && x >= z => (Main::X, x, of_x),
            _ if y >= z => (Main::Y, y, of_y),
            _ => (Main::Z, z, of_z),
        };
        let (_, most) = purpose(first, settings);
        let longest = longest(target.speed, most.min(axis.max_acceleration).min(settings.motor_max_acceleration));
        if first.size * share >= longest {
            return false;
        }
        let [.., from] = asked;
        // Coordinate by coordinate: firmware is made for size, which copies arrays by a call.
        let ([x, y, z, e], [asked_x, asked_y, asked_z, asked_e]) = (begin, asked);
        (self.begin, self.asked) = ([x, y, z, e], [asked_x, asked_y, asked_z, asked_e]);
        (self.feed, self.has_overrides) = (target.speed, target.has_overrides);
        (self.filament, self.main, self.longest) = (filament_way(target, from), main, longest);
        (self.slopes, self.is_joined) = ([Slopes::ALL, Slopes::ALL, Slopes::ALL], false);
        let Some(way) = self.way_to(target.position) else { return false };
        self.note(&way, target.position, filament_step);
        self.state = State::Open;
        true
    }

    /// Takes up a chord that continues the line; false if it does not. The chord begins with filament commanded at
    /// `from`, and filament may be off by half of `filament_step` mm.
    #[inline(always)]
    fn takes(&mut self, target: &Target, from: Mm, filament_step: f32) -> bool {
        if target.speed != self.feed
            || target.has_overrides != self.has_overrides
            || !target.watch.is_empty()
            || filament_way(target, from) != self.filament
        {
            return false;
        }
        let Some(way) = self.way_to(target.position) else { return false };
        let grown = if self.reached < 0.0 { self.reached - way.main } else { way.main - self.reached };
        if grown < LEAST_GROWTH || grown >= self.longest {
            return false;
        }
        let (inverse, [a, b], [in_a, in_b, in_filament]) = (1.0 / way.main, way.others, self.slopes);
        // A straight line to this point must pass every point that is left out, as near as that point asks for.
        if !in_a.has(a * inverse) || !in_b.has(b * inverse) || !in_filament.has(way.filament * inverse) {
            return false;
        }
        self.note(&way, target.position, filament_step);
        self.is_joined = true;
        true
    }

    /// The line ends there now; if it is continued, that becomes a point that is left out.
    #[inline(always)]
    fn note(&mut self, way: &Way, position: [Mm; 4], filament_step: f32) {
        let (inverse, [a, b], [in_a, in_b, in_filament]) = (1.0 / way.main, way.others, &mut self.slopes);
        let tolerance = if is_thousandths(position, self.asked) { ROUNDED } else { EXACT };
        let size = inverse.abs();
        in_a.narrow(a * inverse, tolerance * size);
        in_b.narrow(b * inverse, tolerance * size);
        in_filament.narrow(way.filament * inverse, 0.5 * filament_step * size);
        self.reached = way.main;
    }

    /// The vector from its begin to `position`, if it is a short one.
    #[inline(always)]
    fn way_to(&self, [x, y, z, e]: [Mm; 4]) -> Option<Way> {
        let [from_x, from_y, from_z, from_e] = self.asked;
        let (x, y, z) = (short(x, from_x)?, short(y, from_y)?, short(z, from_z)?);
        let (main, others) = match self.main {
            Main::X => (x, [y, z]),
            Main::Y => (y, [x, z]),
            Main::Z => (z, [x, y]),
        };
        Some(Way { main, others, filament: short(e, from_e)? })
    }
}

/// The length in mm at which a line is closed that accelerates no faster than its main axis does.
#[inline(always)]
fn longest(feed: Feed, most: MmPerSec2) -> f32 {
    let speed = feed_speed(feed);
    let seconds = speed * (0.5 * BRAKING_PART) / acceleration(most);
    let longest = speed * if seconds < LONGEST_SECONDS { seconds } else { LONGEST_SECONDS };
    if longest < LONGEST { longest } else { LONGEST }
}

/// The direction of the filament from `from`.
#[inline(always)]
fn filament_way(target: &Target, from: Mm) -> Ordering {
    let [.., to] = target.position;
    to.wrapping_sub(from).cmp(&Mm::ZERO)
}

/// A length of less than 16 mm, in mm.
#[inline(always)]
fn short(to: Mm, from: Mm) -> Option<f32> {
    let bits = to.wrapping_sub(from).to_bits() >> 5;
    let is_short = i64::from(bits as i32) == bits;
    is_short.then_some(bits as i32 as f32 * const { 1.0 / (1 << 27) as f32 })
}

/// Whether the tool's move has whole thousandths of a millimetre along each axis.
#[inline(always)]
fn is_thousandths([x, y, z, _]: [Mm; 4], [from_x, from_y, from_z, _]: [Mm; 4]) -> bool {
    let is_whole = |to: Mm, from: Mm| {
        let part = to.wrapping_sub(from).to_bits() as u32;
        part.wrapping_mul(1000).wrapping_add(THOUSANDTHS_SLACK) <= 2 * THOUSANDTHS_SLACK
    };
    is_whole(x, from_x) && is_whole(y, from_y) && is_whole(z, from_z)
}

impl Planner<'_> {
    /// Plans a move to `target` as a part of a stream: it continues the open line, or begins one, or gets its place at
    /// once. False if it has no length and so is no move. The caller has asked [`has_room`](Self::has_room).
    pub fn add(&mut self, target: &Target, settings: &Settings) -> bool {
        let ([.., from], filament_step) = (self.asked, self.filament_step());
        if self.line.is_open() && self.line.takes(target, from, filament_step) {
            self.go_on_to(target.position);
            if self.line.is_long() {
                self.close_line(settings);
            }
            return true;
        }
        self.close_line(settings);
        let (begin, asked) = (self.end, self.asked);
        if !self.go_to(&target.position) {
            return false;
        }
        self.count_move();
        let is_line = target.watch.is_empty() && !self.vector.is_extruder_only();
        if !is_line || !self.line.start(target, &self.vector, (begin, asked), filament_step, settings) {
            while !self.replan() {}
            self.place(target, &begin, max_ramps(&self.vector, settings), settings);
        }
        true
    }

    /// Whether a move to `target` would have continued a line that was [cut](Self::cut_line): the stream ran dry in it.
    pub fn was_cut_before(&mut self, target: &Target) -> bool {
        let ([.., from], filament_step) = (self.asked, self.filament_step());
        self.line.state == State::Cut && self.line.takes(target, from, filament_step)
    }

    /// Gives the open line its place in the window, with the settings at its begin; afterwards no chord continues it.
    /// False if there is none.
    #[inline(always)]
    pub fn close_line(&mut self, settings: &Settings) -> bool {
        let is_open = self.line.is_open();
        if is_open {
            self.place_line(settings);
        }
        self.line.forget();
        is_open
    }

    /// Gives the open line its place because the stream is dry. False if there is none.
    pub fn cut_line(&mut self, settings: &Settings) -> bool {
        let is_open = self.line.is_open();
        if is_open {
            self.place_line(settings);
            self.line.state = State::Cut;
        }
        is_open
    }

    #[inline(never)]
    fn place_line(&mut self, settings: &Settings) {
        while !self.replan() {}
        let OpenLine { begin, feed, has_overrides, is_joined, .. } = self.line;
        let target = Target { position: self.asked, speed: feed, has_overrides, watch: EndstopSet::NONE };
        let max_ramp_length = if is_joined {
            self.vector = self.geometry_between(begin, self.end);
            // A chain of chords may brake where it has just accelerated, so the line may.
            self.vector.length
        } else {
            max_ramps(&self.vector, settings)
        };
        self.place(&target, &begin, max_ramp_length, settings);
    }

    /// The open line is continued to `position`.
    #[inline(always)]
    fn go_on_to(&mut self, position: [Mm; 4]) {
        let ([x, y, z, e], [asked_x, asked_y, asked_z, asked_e]) = (position, self.asked);
        let ([px, py, pz, pe], [at_x, at_y, at_z, at_e]) = (&self.step_scale, self.end);
        self.end =
            [px.end(x, asked_x, at_x), py.end(y, asked_y, at_y), pz.end(z, asked_z, at_z), pe.end(e, asked_e, at_e)];
        self.asked = [x, y, z, e];
    }

    /// The filament of a step, in mm.
    #[inline(always)]
    fn filament_step(&self) -> f32 {
        let [.., e] = &self.step_scale;
        e.step()
    }

    /// The filament of the open line, and the ticks that it takes at its feed.
    pub(super) fn open_filament(&self) -> Option<(Steps, u64)> {
        let OpenLine { begin, feed, .. } = self.line;
        self.line.is_open().then(|| {
            let ([.., from], [.., to]) = (begin, self.end);
            let seconds = self.geometry_between(begin, self.end).size / feed_speed(feed);
            // It takes LONGEST_SECONDS a few times at the most, and the processor has no conversion to 64 bits.
            (to.wrapping_sub(from), u64::from((seconds * const { TICKS_PER_SECOND as f32 }) as u32))
        })
    }
}
