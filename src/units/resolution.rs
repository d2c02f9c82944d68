//! Between millimetres and steps, by the resolution of a motor.

use super::{Mm, Steps, StepsPerMm};
use core::ops::Mul;

/// The place of a length in steps; rounded down.
impl Mul<StepsPerMm> for Mm {
    type Output = Steps;

    #[inline(always)]
    fn mul(self, resolution: StepsPerMm) -> Steps {
        let wide = i128::from(self.to_bits()) * i128::from(resolution.to_bits());
        Steps::from_bits((wide >> StepsPerMm::FRAC_NBITS) as i64)
    }
}

impl StepsPerMm {
    /// The length of so many whole steps, cut off towards zero.
    #[must_use]
    pub fn length_of(self, steps: i64) -> Mm {
        self.length_of_parts(steps, 1)
    }

    /// The length of so many parts of a step, cut off towards zero; `parts` of them are a step.
    #[must_use]
    pub fn length_of_parts(self, count: i64, parts: u32) -> Mm {
        let bits = i128::from(count) << (Self::FRAC_NBITS + Mm::FRAC_NBITS);
        Mm::from_bits((bits / (i128::from(self.to_bits().max(1)) * i128::from(parts.max(1)))) as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_and_steps_agree() {
        let resolution = StepsPerMm::from_num(80);
        assert_eq!(Mm::lit("1.25") * resolution, Steps::from_num(100));
        assert_eq!(-Mm::DELTA * StepsPerMm::lit("1.5"), Steps::from_bits(-2), "rounded down");
        assert_eq!(
            (resolution.length_of(-40), resolution.length_of_parts(400, 1000)),
            (Mm::lit("-0.5"), Mm::lit("0.005"))
        );
        assert_eq!(StepsPerMm::from_num(3).length_of(-1), Mm::from_bits(-0x5555_5555), "cut off");
        assert_eq!(StepsPerMm::ZERO.length_of_parts(0, 0), Mm::ZERO);
    }
}
