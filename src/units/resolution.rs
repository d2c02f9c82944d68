//! Between millimetres and steps, by the resolution of a motor: lengths, and speeds.

use super::{Mm, MmPerSec, Steps, StepsPerMm, mul_div, part_of};
use core::ops::{Div, Mul};

/// Steps a second, times 2^32: all bits of a speed times a resolution.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
#[repr(transparent)]
pub struct StepRate(u64);

impl StepRate {
    /// At rest.
    pub const ZERO: Self = Self(0);

    /// So many whole steps a second.
    #[must_use]
    pub const fn of_whole(steps: u32) -> Self {
        Self((steps as u64) << 32)
    }

    /// Whole steps a second, cut off.
    #[must_use]
    pub const fn whole(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// The rate of finer or coarser steps, `times / of` of these; saturates.
    #[must_use]
    pub const fn scaled(self, times: u64, of: u64) -> Self {
        Self(mul_div(self.0, times, of))
    }
}

/// The steps that a motor makes at a speed.
impl Mul<StepsPerMm> for MmPerSec {
    type Output = StepRate;

    fn mul(self, resolution: StepsPerMm) -> StepRate {
        StepRate(u64::from(self.to_bits()) * u64::from(resolution.to_bits()))
    }
}

/// The greatest speed at which a motor makes no more steps, within the range.
impl Div<StepsPerMm> for StepRate {
    type Output = MmPerSec;

    fn div(self, resolution: StepsPerMm) -> MmPerSec {
        let bits = self.0 / u64::from(resolution.to_bits().max(1));
        MmPerSec::from_bits(u32::try_from(bits).unwrap_or(u32::MAX))
    }
}

/// The bits of steps: of a length times a resolution. Two halves need no product of 128 bits. Inlined, it would be in
/// 17 places.
#[inline(never)]
const fn steps(length: i64, resolution: u32) -> i64 {
    let upper = ((length >> 32) * resolution as i64) << (32 - StepsPerMm::FRAC_NBITS);
    let lower = ((length & 0xFFFF_FFFF) as u64 * resolution as u64) >> StepsPerMm::FRAC_NBITS;
    upper.wrapping_add(lower as i64)
}

/// The place of a length in steps; rounded down.
impl Mul<StepsPerMm> for Mm {
    type Output = Steps;

    #[inline(always)]
    fn mul(self, resolution: StepsPerMm) -> Steps {
        Steps::from_bits(steps(self.to_bits(), resolution.to_bits()))
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
        let of = u64::from(self.to_bits().max(1)) * u64::from(parts.max(1));
        Mm::from_bits(part_of(count, 1 << (Self::FRAC_NBITS + Mm::FRAC_NBITS), of))
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

    #[test]
    fn a_rate_and_a_speed_agree() {
        let (speed, resolution) = (MmPerSec::lit("12.5"), StepsPerMm::from_num(80));
        let rate = speed * resolution;
        assert_eq!((rate, rate / resolution), (StepRate::of_whole(1000), speed));
        assert_eq!((rate.scaled(256, 16).whole(), rate.scaled(1, 3).whole()), (16_000, 333));
        // A speed that is cut off makes no more steps, and the next one does.
        let (most, resolution) = (StepRate::of_whole(500_000), StepsPerMm::from_num(93));
        let fastest = most / resolution;
        assert!(fastest * resolution <= most && (fastest + MmPerSec::DELTA) * resolution > most);
        assert_eq!(StepRate::of_whole(u32::MAX) / StepsPerMm::ZERO, MmPerSec::MAX);
    }
}
