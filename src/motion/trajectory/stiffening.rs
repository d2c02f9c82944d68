//! Stiffening: an axis with a higher frequency away from its middle, where the taps of its shaper are closer together.
//!
//! The taps of an axis have delays with a mean. Where the axis's period is `scale` times its period in the middle, a
//! tap's delay is the mean plus `scale` times the difference of its own delay from the mean. Each end of a span has its
//! own scale. Within the span the delay changes evenly between its ends, so the copy of that tap runs a little faster
//! or slower through the span than the other copies. At a boundary both spans have the same scale, so there is neither
//! a gap nor a jump.

use super::span::ONE;
use crate::motion::number::{root, to_f32};
use crate::units::Steps;

/// Lowest scale: an axis is at most 1.25 times as fast as in its middle. The belts of the CoreH-bot reach 1.14.
const LEAST: f32 = 0.8;

/// Period of an axis away from its middle: proportional to `sqrt(1 - k d^2)`, d being the distance in steps.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stiffening {
    /// The middle.
    pub centre: Steps,
    /// k; 0 for an axis with equal frequency everywhere.
    pub rate: f32,
}

impl Stiffening {
    /// Equal frequency everywhere.
    pub const NONE: Self = Self { centre: Steps::ZERO, rate: 0.0 };

    /// Period there relative to the period in the middle, in the fixed point of [`ONE`].
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
