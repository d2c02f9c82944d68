//! Crossings: when a motor's position crosses from one step to the next.
//!
//! In one piece of its way a motor's position is a quadratic in time. Seen from the end of the piece where it is slower,
//! with v the speed there, a distance of d steps is covered after
//!
//! ```text
//! t = 2 d / (v + sqrt(v^2 + 4 h d)),    h = (D - v T) / T^2
//! ```
//!
//! D being the way of the piece and T its time: nothing cancels, and both ends are exact. Nothing is summed up from
//! step to step, so an error cannot grow. Where the steps come evenly, the square root is saved: the last three
//! crossings tell the next to a thousandth, and one of Newton's steps, `t' = (d + h t^2) / (v + 2 h t)`, squares that.

use super::number::{root, ticks, to_f32};
use super::phase::Curve;
use crate::units::Steps;

/// Where and how fast a piece begins or ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// In ticks times 2^16.
    pub time: u64,
    pub position: Steps,
    /// In steps a tick.
    pub speed: f32,
}

/// Newton's step is good enough where the time between two steps changes by less than this part of itself from one to
/// the next: what three crossings foretell is then wrong by a thousandth of it.
const EVEN: f32 = 1.0 / 16.0;

/// A piece is steady if the change of its speed shifts no step by more than a quarter of this, in ticks.
const LEAST_SHIFT: f32 = 0.2;

/// The crossings of one piece, in order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossings {
    curve: Curve,
    /// Distance of the next crossing from the slow end: whole steps, which are counted, and the rest. A sum would lose the
    /// digits that matter where few steps are left.
    whole: i32,
    part: f32,
    /// v, or the time a step takes if it is always the same.
    slow: f32,
    /// h
    rise: f32,
    /// Time of the slow end from the whole tick `base`, and half a tick for rounding.
    offset: f32,
    base: u32,
    /// Time of the last crossing from the slow end.
    last: f32,
    /// The time from the crossing before it, and by how much that was more than the one before.
    pace: f32,
    bend: f32,
    /// Whether the above are known.
    known: u8,
}

impl Crossings {
    /// No piece.
    pub const NONE: Self = Self {
        curve: Curve::Steady,
        whole: 0,
        part: 0.0,
        slow: 0.0,
        rise: 0.0,
        offset: 0.0,
        base: 0,
        last: 0.0,
        pace: 0.0,
        bend: 0.0,
        known: 0,
    };

    /// The crossings between `from` and `to`, the first of which is at `first`; between them the direction does not
    /// change.
    pub fn new(from: &Edge, to: &Edge, first: Steps, is_forward: bool, shape: Option<(Curve, f32)>) -> Self {
        let distance = |from: Steps, to: Steps| {
            if is_forward { to.wrapping_sub(from) } else { from.wrapping_sub(to) }
        };
        let time = ticks(to.time - from.time);
        let way = to_f32(distance(from.position, to.position));
        // Where the motor's way is that of one span, its curve is the span's; a small difference of two great speeds
        // would say less well what that is.
        let (v0, v1) = (from.speed.abs(), to.speed.abs());
        let even = if v0 <= v1 { Curve::Speeding } else { Curve::Slowing };
        let (curve, covered) = match shape {
            Some((Curve::Steady, _)) => (Curve::Steady, way),
            Some((curve, share)) => (curve, way * share),
            None => (even, v0.min(v1) * time),
        };
        let gain = way - covered;
        let begin = ((from.time & 0xFFFF) as u32) as f32 * const { 1.0 / 65536.0 } + 0.5;
        let piece = Self { base: (from.time >> 16) as u32, offset: begin, ..Self::NONE };
        if gain * time < LEAST_SHIFT * way {
            return Self { slow: time / way, ..piece }.seen_from_slow_end(distance(from.position, first));
        }
        let piece = Self { slow: covered / time, rise: gain / (time * time), ..piece };
        if curve == Curve::Speeding {
            Self { curve, ..piece }.seen_from_slow_end(distance(from.position, first))
        } else {
            Self { curve, offset: begin + time, ..piece }.seen_from_slow_end(distance(first, to.position))
        }
    }

    /// The first crossing is so far from the slow end.
    fn seen_from_slow_end(self, distance: Steps) -> Self {
        let bits = distance.to_bits();
        Self { whole: (bits >> 32) as i32, part: ((bits as u32) as f32) * const { 1.0 / 4_294_967_296.0 }, ..self }
    }

    /// All crossings at once.
    pub fn at_once(time: u64) -> Self {
        Self { base: (time >> 16) as u32, offset: 0.5, ..Self::NONE }
    }

    /// The tick of the next crossing.
    #[inline(always)]
    pub fn next(&mut self) -> u32 {
        let distance = self.whole as f32 + self.part;
        if self.curve == Curve::Steady {
            let at = self.offset + distance * self.slow;
            self.whole += 1;
            return self.base.wrapping_add(at as u32);
        }
        // Not `max`, which the target has no instruction for.
        let distance = if distance < 0.0 { 0.0 } else { distance };
        let at = if self.known > 2 && self.bend.abs() < self.pace.abs() * EVEN {
            let guess = self.last + (self.pace + self.bend);
            let gain = self.rise * guess;
            (distance + gain * guess) / (self.slow + gain + gain)
        } else {
            let square = self.slow * self.slow + 4.0 * (self.rise * distance);
            let fast = root(square);
            if fast > 0.0 { (distance + distance) / (self.slow + fast) } else { 0.0 }
        };
        let pace = at - self.last;
        self.bend = pace - self.pace;
        self.pace = pace;
        self.last = at;
        self.known = self.known.saturating_add(1);
        let at = if self.curve == Curve::Slowing {
            self.whole -= 1;
            self.offset - at
        } else {
            self.whole += 1;
            self.offset + at
        };
        self.base.wrapping_add(at as u32)
    }
}
