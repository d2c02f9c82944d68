//! Pressure: limits on the speed of moves so that the extruder can also follow its pressure advance.
//!
//! With the advance K over the window h the extruder moves at `v + (q(t + h/2) - q(t - h/2)) / h`. Here v is the speed
//! of the filament, and q is K v in moves that print and 0 in others. Therefore
//!
//! - **a ramp** on which the filament speeds up by a adds K a to the extruder's speed. To its acceleration it adds K a
//!   / h where the window meets an end of the ramp. It adds twice that where the window meets both the end of one ramp
//!   and the begin of the opposite one, as in a corner.
//! - **a corner** where q jumps by J makes the extruder's speed jump by J / h twice: as it comes into the window and as
//!   it leaves it. In between that is added to the speed, together with all other jumps in the window.
//!
//! So the extruder's greatest speed V has three shares: for ramps, for jumps, and for the filament itself. None of them
//! is less than a sixteenth of V. A single jump counts as the extruder's jerk too. Moves of the extruder alone come
//! within half a window of the end of a ramp, so each of the two leaves room for the other. Derivation and figures:
//! docs/explanation/shaping.md#what-the-extruder-bears.
//!
//! The acceleration of the curve in a corner asks nothing of the extruder, so junction speeds are made with the
//! acceleration that is wanted.

use super::geometry::Geometry;
use crate::motion::number::{acceleration, speed};
use crate::motion::trajectory::MOST_PUSH;
use crate::settings::Settings;
use crate::units::Seconds;

/// Shares of the extruder's speed: the least that jumps and ramps get; ramps get no more than [`MOST_PUSH`].
const LEAST_ROOM: f32 = 1.0 / 16.0;
const LEAST_PUSH: f32 = 0.25;
/// The part of its speed that a move of the extruder alone may always use. Within half a window of it, ramps get their
/// full share, because half of the window sees them.
const FREE: f32 = 1.0 - MOST_PUSH / 2.0;
/// The most for such a move: the remainder is half of the least share of ramps.
const MOST_ALONE: f32 = 1.0 - LEAST_PUSH / 2.0;
/// The part of the extruder's acceleration that moves of the extruder alone leave to the ramp after them, and that
/// ramps leave to them. Within a window three may meet: a ramp, such a move, and the next ramp.
const LEAST_CHANGE: f32 = 0.25;
/// A jump that is a smaller part of all jumps in the window than this is rounding of E: slicers write five decimals.
const NOISE: f32 = 1.0 / 64.0;

/// The limits of a move: acceleration in mm/s2 and speed in mm/s.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::motion) struct Most {
    pub acceleration: f32,
    pub speed: f32,
}

/// A move as the extruder sees it.
pub(in crate::motion) struct Flow<'a> {
    pub geometry: &'a Geometry,
    /// K if it prints, else 0, in s.
    pub advance: f32,
    /// The commanded speed, in mm/s.
    pub feed: f32,
}

/// The extruder speed that moves need in addition to their own.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Asked {
    /// The least and the greatest q, for a speed of 1 mm/s.
    least_q: f32,
    most_q: f32,
    /// K a of ramps in moves that print.
    push: f32,
    /// Speed and acceleration of the filament in moves that do not print.
    alone_speed: f32,
    alone_accel: f32,
}

impl Asked {
    const fn of(q: f32) -> Self {
        Self { least_q: q, most_q: q, push: 0.0, alone_speed: 0.0, alone_accel: 0.0 }
    }

    /// The greatest of both.
    #[inline(always)]
    fn with(&self, other: &Self) -> Self {
        Self {
            least_q: least(self.least_q, other.least_q),
            most_q: greatest(self.most_q, other.most_q),
            push: greatest(self.push, other.push),
            alone_speed: greatest(self.alone_speed, other.alone_speed),
            alone_accel: greatest(self.alone_accel, other.alone_accel),
        }
    }
}

/// The part of the extruder's limits that the moves so far have left.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::motion) struct Pressure {
    /// The window, in s, and one over it; 0 if no advance is in use.
    window: f32,
    rate: f32,
    /// q of the last move, for a speed of 1 mm/s.
    q: f32,
    /// The share of jumps in the last move.
    room: f32,
    /// The needs of the last window, and of the present one. So at least the last window is known, at most two.
    before: Asked,
    now: Asked,
    /// The least duration of the one under way.
    elapsed: f32,
}

impl Pressure {
    /// No advance is in use.
    pub const NONE: Self = Self {
        window: 0.0,
        rate: 0.0,
        q: 0.0,
        room: f32::MAX,
        before: Asked::of(0.0),
        now: Asked::of(0.0),
        elapsed: 0.0,
    };

    /// At rest, with an advance over that window.
    pub fn new(window: Option<Seconds>) -> Self {
        match window {
            Some(window) if window > Seconds::ZERO => {
                let window = window.to_num::<f32>();
                Self { window, rate: 1.0 / window, ..Self::NONE }
            }
            _ => Self::NONE,
        }
    }

    /// The machine has come to rest, and the next moves are unknown.
    pub fn rest(&mut self) {
        *self = Self { window: self.window, rate: self.rate, ..Self::NONE };
    }

    /// Whether an advance is in use.
    #[inline(always)]
    pub const fn is_in_use(&self) -> bool {
        self.rate > 0.0
    }

    /// Whether it is for this window.
    pub fn is_for(&self, window: Option<Seconds>) -> bool {
        let other = Self::new(window);
        self.window == other.window && self.rate == other.rate
    }

    /// Reduces the next move's limits to the extruder's. Returns the jump of the extruder's speed in the corner before
    /// the move, in mm/s for a speed of 1 mm/s. The speed of that corner is at most the extruder's jerk divided by
    /// this.
    #[inline(never)]
    pub fn bound(&mut self, flow: &Flow<'_>, last: &Geometry, most: &mut Most, s: &Settings) -> f32 {
        let ratio = flow.geometry.extrusion.abs();
        let q = flow.advance * ratio;
        let (v, a) = (speed(s.axes.e.max_speed), acceleration(s.axes.e.max_acceleration));
        let wanted = least(flow.feed, most.speed) * ratio;
        let before = self.before.with(&self.now);
        let mut asked = Asked::of(q);
        let mut room = self.room;
        if q > 0.0 {
            // Half of the window sees the ramp next to a move of the extruder alone. Twice the least room is set aside,
            // because jumps get half of the rest below.
            let share = least(v * (1.0 - 2.0 * LEAST_ROOM) - wanted, 2.0 * (v - before.alone_speed));
            let share = least(greatest(share, v * LEAST_PUSH), v * MOST_PUSH);
            limit(&mut most.acceleration, q, share);
            // Twice, for the corner in which one ramp ends and the opposite one begins.
            limit(&mut most.acceleration, ratio + 2.0 * q * self.rate, a);
            if before.alone_accel > 0.0 {
                let left = a - before.alone_accel - before.push * self.rate;
                limit(&mut most.acceleration, q * self.rate, greatest(left, a * LEAST_CHANGE));
            }
            // After all limits of the acceleration, and before those of the speed, which leave this much.
            asked.push = q * most.acceleration;
            room = greatest(0.5 * (v - wanted - asked.push), v * LEAST_ROOM);
            limit(&mut most.speed, ratio, v - asked.push - room);
        } else if ratio > 0.0 {
            let share = least(greatest(wanted, v * FREE), v * MOST_ALONE);
            // Only half of the window sees the ramp before it.
            limit(&mut most.speed, ratio, least(share, v - 0.5 * before.push));
            let left = a * (1.0 - LEAST_CHANGE) - before.push * self.rate;
            limit(&mut most.acceleration, ratio, greatest(left, a * LEAST_CHANGE));
            (asked.alone_speed, asked.alone_accel) = (share, ratio * most.acceleration);
            room = greatest(0.5 * (v - wanted), v * LEAST_ROOM);
        }
        // Before `q` and `room` become those of this move: the jump is from the last one. The corner has the lesser
        // room of both.
        let jump = self.jump(&before.with(&asked), q, least(room, self.room), s);
        (self.q, self.room) = (q, room);
        // The least time that the move can take, so needs are kept for at least a window.
        self.go_on(&asked, flow.geometry.size / most.speed);
        // The filament's own speed jumps too where the line gets wider, with or without an advance.
        greatest((last.extrusion - flow.geometry.extrusion).abs(), jump)
    }

    /// The jump at the corner to a move of that q, given the needs in the window and the share of jumps.
    #[inline(always)]
    fn jump(&self, asked: &Asked, q: f32, room: f32, s: &Settings) -> f32 {
        let jump = (q - self.q).abs() * self.rate;
        let all = (asked.most_q - asked.least_q) * self.rate;
        let jerk = speed(s.extruder_jerk);
        // All jumps of the window have their share, which counts where this one takes part in it.
        if jump > all * NOISE && room * jump < jerk * all { jerk * all / room } else { jump }
    }

    /// A move with these needs follows, and takes at least this long, in s.
    #[inline(always)]
    fn go_on(&mut self, asked: &Asked, time: f32) {
        self.now = self.now.with(asked);
        self.elapsed += time;
        if self.elapsed >= self.window {
            self.before = if time >= self.window { *asked } else { self.now };
            (self.now, self.elapsed) = (*asked, 0.0);
        }
    }
}

/// Brings a value down so that `share` of it is no more than `most`.
#[inline(always)]
fn limit(value: &mut f32, share: f32, most: f32) {
    if *value * share > most {
        *value = most / share;
    }
}

#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
