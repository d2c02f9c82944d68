//! Phases: the parts of a move in which its speed rises, holds, or falls.

use crate::motion::moves::{Move, WHOLE};
use crate::motion::ramps::fraction;
use crate::units::{Steps, SubTicks, mul_div};
use heapless::Vec;

/// Change of speed in a phase.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Curve {
    /// Constant.
    Steady,
    /// Rising.
    Speeding,
    /// Falling.
    Slowing,
}

/// A phase of a move, or a part of one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Phase {
    pub curve: Curve,
    /// Covered fraction of the move at its end.
    pub end: u32,
    /// Part of its distance that its lower speed alone would cover in its time.
    pub slow_share: u32,
    /// In ticks times 2^16.
    pub time: SubTicks,
}

const fn part(a: u64, b: u64) -> u64 {
    a * b / WHOLE as u64
}

impl Phase {
    /// Covered fraction of its distance after the fraction `x` of its time, and the speed there relative to the mean,
    /// both scaled by [`WHOLE`].
    pub fn progress(&self, x: u64) -> (u64, u64) {
        let (whole, share) = (u64::from(WHOLE), u64::from(self.slow_share.min(WHOLE)));
        let way = |x: u64| part(share, x) + part(whole - share, part(x, x));
        let pace = |x: u64| share + 2 * part(whole - share, x);
        match self.curve {
            Curve::Steady => (x, whole),
            Curve::Speeding => (way(x), pace(x)),
            Curve::Slowing => (whole - way(whole - x), pace(whole - x)),
        }
    }

    /// A part of a steady phase that begins with the fraction `begin` of the move covered and a time `from`. Its
    /// duration matches the covered fraction at its end, which has 31 bits. In a move of minutes the last of these bits
    /// is ticks.
    pub fn cut_evenly(&self, begin: u32, from: SubTicks, time: SubTicks) -> Self {
        let (whole, part) = (u64::from(self.end.saturating_sub(begin)), self.cut(begin, from, from + time));
        let to = SubTicks(mul_div(self.time.0, u64::from(part.end.saturating_sub(begin)), whole));
        if part.end == self.end || to <= from { part } else { Self { time: to - from, ..part } }
    }

    /// Its part between two points of its time; it begins with the fraction `begin` of the move covered.
    pub fn cut(&self, begin: u32, from: SubTicks, to: SubTicks) -> Self {
        let x = |at: SubTicks| u64::from(fraction(at.min(self.time).0, self.time.0));
        let (_, pace_from) = self.progress(x(from));
        let (way_to, pace_to) = self.progress(x(to));
        let whole = u64::from(self.end.saturating_sub(begin));
        let end = if to >= self.time { self.end } else { begin + part(whole, way_to) as u32 };
        let slow = pace_from.min(pace_to);
        let slow_share = fraction(2 * slow, (pace_from + pace_to).max(1));
        Self { curve: self.curve, end, slow_share, time: to - from }
    }
}

/// The phases of a move. Phases without time are left out, and the last one ends where the move ends.
pub(crate) fn phases(m: &Move) -> Vec<Phase, 3> {
    let mut phases = Vec::new();
    let end = |fraction: u32, following: SubTicks| if following == SubTicks::ZERO { WHOLE } else { fraction };
    // Written out, because firmware is compiled for size, which does not unroll loops and arrays.
    if m.accelerate > SubTicks::ZERO {
        let curve = if m.brakes_first { Curve::Slowing } else { Curve::Speeding };
        let end = end(m.accelerated, m.cruise + m.decelerate);
        let _ = phases.push(Phase { curve, end, slow_share: m.entry_share, time: m.accelerate });
    }
    if m.cruise > SubTicks::ZERO {
        let end = end(m.cruised, m.decelerate);
        let _ = phases.push(Phase { curve: Curve::Steady, end, slow_share: 0, time: m.cruise });
    }
    if m.decelerate > SubTicks::ZERO {
        let _ = phases.push(Phase { curve: Curve::Slowing, end: WHOLE, slow_share: m.exit_share, time: m.decelerate });
    }
    phases
}

/// The point a fraction of the way from `first` to `last`.
pub(crate) fn point(first: Steps, last: Steps, fraction: u32) -> Steps {
    if fraction == WHOLE {
        return last;
    }
    // Rounded towards zero, so that mirrored groups stay mirrored.
    let way = i128::from(last.wrapping_sub(first).to_bits()) * i128::from(fraction) / i128::from(WHOLE);
    first.wrapping_add(Steps::from_bits(way as i64))
}
