//! Crossings: when a motor's position reaches a given value.
//!
//! In one phase of a move a motor's position is a quadratic in time. Written with x, the fraction of the
//! phase's time T that has passed since its slow end, and D, its distance, it is `d(x) = b x + c x^2` with
//! b the distance that the slow end's speed alone would cover and `b + c = D`. The time at which a distance
//! d is reached follows without cancellation from
//!
//! ```text
//! x = 2 d / (b + sqrt(b^2 + 4 c d))
//! ```
//!
//! A decelerating phase is the same seen from its end. There is no sampling and nothing is summed up:
//! every crossing is computed from the phase's own ends, which are exact, so an error cannot grow.
//!
//! All distances of a phase are scaled so that D has 30 bits (32 in a steady phase, which needs no square
//! root): a crossing is then right to about 2^-30 of the phase's time, for any speed and length.

use crate::motion::moves::WHOLE;
use crate::units::Steps;

/// How speed changes in a phase.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Curve {
    /// It does not.
    Steady,
    /// It grows.
    Speeding,
    /// It falls.
    Slowing,
}

/// The way of one motor group in one phase.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Path {
    from: Steps,
    to: Steps,
    curve: Curve,
    /// Left shift that brings distances to their scale; right if negative.
    shift: i32,
    /// Scaled distance.
    distance: u64,
    /// Scaled b of the formula.
    linear: u64,
    /// Time of the phase, ticks times 2^16.
    time: u64,
    /// Time scaled to 32 or 33 bits, and the shift that did it.
    scaled_time: u64,
    time_shift: u32,
}

impl Path {
    /// A phase in which a group goes from `from` to `to` within `time` (ticks times 2^16); `slow_share` is
    /// the part b / D of the distance, scaled by [`WHOLE`].
    #[must_use]
    pub fn new(from: Steps, to: Steps, curve: Curve, slow_share: u32, time: u64) -> Self {
        let raw = to.wrapping_sub(from).to_bits().unsigned_abs();
        let (distance_bits, time_bits) = if curve == Curve::Steady { (32, 32) } else { (30, 33) };
        let shift = distance_bits - (64 - raw.leading_zeros() as i32);
        let distance = scale(raw, shift);
        let time_shift = (64 - time.leading_zeros()).saturating_sub(time_bits);
        Self {
            from,
            to,
            curve,
            shift,
            distance,
            linear: distance * u64::from(slow_share.min(WHOLE)) / u64::from(WHOLE),
            time,
            scaled_time: time >> time_shift,
            time_shift,
        }
    }

    /// Where the phase ends.
    #[must_use]
    pub const fn end(&self) -> Steps {
        self.to
    }

    /// How long the phase takes, in ticks times 2^16.
    #[must_use]
    pub const fn time(&self) -> u64 {
        self.time
    }

    /// Whether the position grows.
    #[must_use]
    pub fn is_forward(&self) -> bool {
        self.to.wrapping_sub(self.from) >= Steps::ZERO
    }

    /// When the position is reached, in ticks times 2^16 from the phase's begin; 0 for what lies behind,
    /// the whole time for what lies ahead of its end.
    #[must_use]
    pub fn reaches(&self, position: Steps) -> u64 {
        let ahead = position.wrapping_sub(self.from).to_bits();
        let ahead = if self.is_forward() { ahead } else { ahead.wrapping_neg() };
        let length = self.to.wrapping_sub(self.from).to_bits().unsigned_abs();
        if ahead <= 0 {
            return 0;
        }
        let ahead = ahead.unsigned_abs();
        if ahead >= length {
            return self.time;
        }
        match self.curve {
            Curve::Steady => (scale(ahead, self.shift) * self.scaled_time / self.distance.max(1)) << self.time_shift,
            Curve::Speeding => self.time_from_slow_end(ahead),
            Curve::Slowing => self.time.saturating_sub(self.time_from_slow_end(length - ahead)),
        }
        .min(self.time)
    }

    fn time_from_slow_end(&self, distance: u64) -> u64 {
        let d = scale(distance, self.shift);
        let (b, c) = (self.linear, self.distance - self.linear);
        let half = (b + (b * b + 4 * c * d).isqrt()) / 2;
        (d * self.scaled_time / half.max(1)) << self.time_shift
    }
}

const fn scale(value: u64, shift: i32) -> u64 {
    if shift >= 0 { value << shift } else { value >> -shift }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time at which a phase between two speeds reaches a distance, in floating point.
    fn exact(distance: f64, v0: f64, v1: f64, time: f64) -> f64 {
        let a = (v1 - v0) / time;
        if a == 0.0 {
            return distance / v0;
        }
        ((v0 * v0 + 2.0 * a * distance).sqrt() - v0) / a
    }

    fn worst(v0: f64, v1: f64, ticks: u64) -> f64 {
        let length = (v0 + v1) / 2.0 * ticks as f64;
        let curve = if v0 == v1 {
            Curve::Steady
        } else if v0 < v1 {
            Curve::Speeding
        } else {
            Curve::Slowing
        };
        let share = (2.0 * v0.min(v1) / (v0 + v1) * f64::from(WHOLE)) as u32;
        let from = Steps::from_num(12345.678);
        let to = from + Steps::from_num(length);
        let path = Path::new(from, to, curve, share, ticks << 16);
        let mut worst = 0f64;
        for i in 1..1000 {
            let d = length * f64::from(i) / 1000.0;
            let got = path.reaches(from + Steps::from_num(d)) as f64 / 65536.0;
            worst = worst.max((got - exact(d, v0, v1, ticks as f64)).abs());
        }
        worst
    }

    #[test]
    fn crossings_are_right_to_a_fraction_of_a_tick() {
        // Steps a tick: 300 mm/s at 80 steps/mm are 0.0024.
        assert!(worst(0.0024, 0.0024, 13_000_000) < 0.05, "390 mm cruise: {}", worst(0.0024, 0.0024, 13_000_000));
        assert!(worst(0.0, 0.0024, 600_000) < 0.05, "from rest: {}", worst(0.0, 0.0024, 600_000));
        assert!(worst(0.0024, 0.0, 600_000) < 0.05, "to rest: {}", worst(0.0024, 0.0, 600_000));
        assert!(worst(0.001, 0.0011, 20_000) < 0.05, "gentle: {}", worst(0.001, 0.0011, 20_000));
        assert!(worst(0.0016, 0.0016, 170_000_000) < 0.2, "335 mm of screw: {}", worst(0.0016, 0.0016, 170_000_000));
    }

    #[test]
    fn what_lies_outside_is_at_the_ends() {
        let path = Path::new(Steps::from_num(5), Steps::from_num(-5), Curve::Steady, 0, 1000);
        assert!(!path.is_forward());
        assert_eq!(path.reaches(Steps::from_num(6)), 0);
        assert_eq!(path.reaches(Steps::from_num(-6)), 1000);
        assert_eq!(path.reaches(Steps::from_num(0)), 500);
    }

    #[test]
    fn a_position_may_wrap() {
        let from = Steps::MAX - Steps::from_num(3);
        let to = from.wrapping_add(Steps::from_num(10));
        let path = Path::new(from, to, Curve::Steady, 0, 1000 << 16);
        assert!(path.is_forward());
        assert_eq!(path.reaches(from.wrapping_add(Steps::from_num(5))), 500 << 16);
    }
}
