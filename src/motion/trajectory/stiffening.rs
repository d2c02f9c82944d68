//! Stiffening: an axis that rings faster away from its middle, so that the taps of its shaper stand closer there.
//!
//! The taps of an axis have delays, and these a mean. Where the axis rings with the period `scale` times that in the middle,
//! a tap is late by the mean plus `scale` times what its own delay differs from the mean. Both ends of a span have a scale of
//! their own. Within the span the delay of a tap changes evenly from that at its begin to that at its end, so the copy
//! of that tap runs through the span a little faster or slower than the other copies do. At a boundary both spans have the same
//! scale, so there is neither a gap nor a jump.

use super::span::ONE;
use crate::motion::number::{root, to_f32};
use crate::units::Steps;

/// Least scale: an axis is 1.25 times as fast as in its middle at most. The belts of the CoreH-bot make 1.14 of it.
const LEAST: f32 = 0.8;

/// How the period of an axis falls away from its middle: as `sqrt(1 - k d^2)`, d being the distance in steps.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stiffening {
    /// The middle.
    pub centre: Steps,
    /// k; 0 for an axis that is the same everywhere.
    pub rate: f32,
}

impl Stiffening {
    /// The same everywhere.
    pub const NONE: Self = Self { centre: Steps::ZERO, rate: 0.0 };

    /// The period there, as a part of that in the middle, in the fixed point of [`ONE`].
    pub(super) fn scale(&self, at: Steps) -> u32 {
        if self.rate <= 0.0 {
            return ONE;
        }
        let d = to_f32(at.wrapping_sub(self.centre));
        let scale = root(1.0 - self.rate * (d * d));
        let scale = if scale > LEAST { scale } else { LEAST };
        ((scale * const { (ONE >> 6) as f32 }) as u32) << 6
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_period_is_that_of_the_law_and_no_less_than_four_fifths() {
        // 834.6 mm of belt at 80 steps/mm.
        let law = Stiffening { centre: Steps::from_num(15_600), rate: 4.0 / (834.6f32 * 80.0).powi(2) };
        let scale = |mm: f64| f64::from(law.scale(Steps::from_num(80.0 * mm))) / f64::from(ONE);
        assert!((scale(195.0) - 1.0).abs() < 1e-7);
        // mechanism of the paper: 13.1 % faster 195 mm off the middle.
        assert!((1.0 / scale(0.0) - 1.131).abs() < 1e-3 && (1.0 / scale(390.0) - 1.131).abs() < 1e-3);
        assert!((scale(5000.0) - 0.8).abs() < 1e-7);
        assert_eq!(Stiffening::NONE.scale(Steps::from_num(1e6)), ONE);
    }
}
