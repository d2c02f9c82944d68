//! Spans: pieces of the trajectory in which the tool goes straight and its speed changes evenly.
//!
//! All axes share the covered fraction of the distance. With x, the fraction of the span's time since its slow end, it
//! is `g(x) = s x + (1 - s) x^2`. The share s is the part that the slow end's speed alone would cover. A span with
//! falling speed is the same seen from its end, so a position is exact at both ends and most accurate where it is
//! slowest.

use super::phase::{Curve, Phase};
use crate::motion::moves::WHOLE;
use crate::motion::number::{from_f32, ticks, to_f32};
use crate::motion::ticks::FAR;
use crate::units::{Steps, SubTicks};

/// Axes of the trajectory: x, y, z, e, and the advance, with a speed equal to the pressure that the extruder builds up.
pub(crate) const AXES: usize = 5;

/// The axis between bed and nozzle.
pub(crate) const Z: usize = 2;

/// The axis of the advance.
pub(crate) const ADVANCE: usize = 4;

/// Longest span, in ticks times 2^16. Single precision is finer than a 20th of a tick in it.
pub(crate) const LONGEST: SubTicks = SubTicks::of_ticks(1 << 19);
// A known rest must be longer, and a time within a span has less than 40 bits.
const _: () = assert!(LONGEST.0 < (FAR as u64) << 16 && LONGEST.0 < 1 << 40);

/// One in the fixed point of scales.
pub(crate) const ONE: u32 = 1 << 30;

/// Positions of all axes.
pub(crate) type Position = [Steps; AXES];

/// Position and speed of an axis, in steps and steps a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct AxisState {
    pub position: Steps,
    pub speed: f32,
}

impl AxisState {
    /// At rest.
    pub const fn at_rest(position: Steps) -> Self {
        Self { position, speed: 0.0 }
    }
}

/// Place and time at which a span begins or ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boundary {
    /// In ticks times 2^16.
    pub time: SubTicks,
    pub position: Position,
    /// Scale of the taps' delays of x and y here.
    pub scale: [u32; 2],
}

impl Boundary {
    /// At a position with unscaled taps.
    pub const fn new(time: SubTicks, position: Position) -> Self {
        Self { time, position, scale: [ONE; 2] }
    }

    /// Position of an axis.
    pub fn at(&self, axis: usize) -> Steps {
        self.position.get(axis).copied().unwrap_or_default()
    }
}

/// A piece of the trajectory. It ends where and when the next one begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub begin: Boundary,
    /// One over its time, in ticks; with the sign bit, its speed falls.
    rate: f32,
    /// s of the formula; with the sign bit, its speed changes. As a field, the curve would take 8 bytes.
    slow_share: f32,
}

const _: () = assert!(size_of::<Span>() == 64);

impl Span {
    /// No span. It is all zeros, which take no flash in static memory.
    pub const EMPTY: Self = Self {
        begin: Boundary { time: SubTicks::ZERO, position: [Steps::ZERO; AXES], scale: [0; 2] },
        rate: 0.0,
        slow_share: 0.0,
    };

    /// The curve of its speed.
    #[inline]
    pub const fn curve(&self) -> Curve {
        if self.slow_share.is_sign_positive() {
            Curve::Steady
        } else if self.rate.is_sign_negative() {
            Curve::Slowing
        } else {
            Curve::Speeding
        }
    }

    /// s of the formula.
    #[inline]
    pub const fn slow_share(&self) -> f32 {
        self.slow_share.abs()
    }

    /// Becomes the span of a phase from `begin` on.
    pub fn lay(&mut self, begin: &Boundary, phase: &Phase) {
        self.begin = *begin;
        let rate = 1.0 / ticks(phase.time).max(1.0 / 256.0);
        let slow_share = phase.slow_share.min(WHOLE) as f32 * const { 1.0 / WHOLE as f32 };
        (self.rate, self.slow_share) = match phase.curve {
            Curve::Steady => (rate, slow_share),
            Curve::Speeding => (rate, -slow_share),
            Curve::Slowing => (-rate, -slow_share),
        };
    }

    /// The state of an axis at `time` within the span, which ends at `end`.
    pub fn state(&self, axis: usize, end: &Boundary, time: SubTicks) -> AxisState {
        self.state_between(axis, end, (self.begin.time, end.time, self.rate.abs()), time)
    }

    /// The same for a copy with another begin and end.
    pub fn warped(
        &self,
        axis: usize,
        end: &Boundary,
        (begins, ends): (SubTicks, SubTicks),
        time: SubTicks,
    ) -> AxisState {
        let rate = 1.0 / ticks(ends.saturating_sub(begins)).max(1.0 / 256.0);
        self.state_between(axis, end, (begins, ends, rate), time)
    }

    #[inline]
    fn state_between(
        &self,
        axis: usize,
        end: &Boundary,
        (begins, ends, rate): (SubTicks, SubTicks, f32),
        time: SubTicks,
    ) -> AxisState {
        let (from, to) = (self.begin.at(axis), end.at(axis));
        let way = to.wrapping_sub(from);
        if way == Steps::ZERO {
            return AxisState::at_rest(from);
        }
        let way = to_f32(way);
        let mean = way * rate;
        let from_begin = ticks(time.saturating_sub(begins)) * rate;
        let (curve, slow_share) = (self.curve(), self.slow_share());
        if curve == Curve::Steady {
            // At the ends it is the boundary itself, so that no rounding is handed on from span to span.
            let position = if time >= ends { to } else { from.wrapping_add(from_f32(way * from_begin)) };
            return AxisState { position, speed: mean };
        }
        let fast_share = 1.0 - slow_share;
        let is_slowing = curve == Curve::Slowing;
        // Seen from the slow end, where both terms are small and single precision is finest.
        let x = if is_slowing { ticks(ends.saturating_sub(time)) * rate } else { from_begin };
        let x = x.min(1.0);
        let speed = mean * (slow_share + 2.0 * (fast_share * x));
        let gone = way * (x * (slow_share + fast_share * x));
        let position = if time >= ends {
            to
        } else if time <= begins {
            from
        } else if is_slowing {
            to.wrapping_sub(from_f32(gone))
        } else {
            from.wrapping_add(from_f32(gone))
        };
        AxisState { position, speed }
    }
}
