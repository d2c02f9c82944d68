//! Arithmetic of the thermal room: everything saturates, so that no input gives nonsense.

use crate::units::{self, Celsius, Power, Ratio, Seconds};
use fixed::FixedI32;
use fixed::types::extra::{LeEqU32, Unsigned};
use fixed::types::{I0F32, I8F24, I12F20};

/// Control periods a second.
pub const RATE: i32 = 50;

/// Milliseconds of a control period.
pub const PERIOD_MS: u32 = 1000 / RATE.unsigned_abs();

/// The fraction of a difference that a lag closes in a control period.
pub fn part_per_period(lag: Seconds) -> I0F32 {
    units::part_per_period(lag, RATE.unsigned_abs())
}

/// A quantity of 32 bits, which keeps its unit when a factor is a plain number.
pub trait Word: Copy {
    /// The value with these bits.
    fn of(bits: i32) -> Self;

    /// Its bits.
    fn bits(self) -> i32;
}

impl Word for Celsius {
    fn of(bits: i32) -> Self {
        Self::from_bits(bits)
    }

    fn bits(self) -> i32 {
        self.to_bits()
    }
}

impl Word for Power {
    fn of(bits: i32) -> Self {
        Self::from_bits(bits)
    }

    fn bits(self) -> i32 {
        self.to_bits()
    }
}

/// A quantity times a plain factor, or a part of it.
#[inline(always)]
pub fn times<Q: Word, F: Unsigned + LeEqU32>(value: Q, factor: FixedI32<F>) -> Q {
    Q::of(product(value.bits(), factor))
}

/// Bits times a factor.
#[inline(always)]
fn product<F: Unsigned + LeEqU32>(bits: i32, factor: FixedI32<F>) -> i32 {
    saturated((i64::from(bits) * i64::from(factor.to_bits())) >> F::U32)
}

/// A difference of temperatures as a plain number of K.
#[inline(always)]
pub const fn kelvin(difference: Celsius) -> I12F20 {
    I12F20::from_bits(difference.to_bits())
}

/// The power that a difference of temperatures drives, with a factor in W/K. With a factor in J/K it is heat in J, as
/// the power that would bring it in a second.
#[inline(always)]
pub fn driven<F: Unsigned + LeEqU32>(difference: Celsius, factor: FixedI32<F>) -> Power {
    Power::from_bits(product(difference.to_bits(), factor))
}

/// The rise by a power, with a factor in K/W.
#[inline(always)]
pub fn rise<F: Unsigned + LeEqU32>(power: Power, factor: FixedI32<F>) -> Celsius {
    Celsius::from_bits(product(power.to_bits(), factor))
}

/// A product or quotient in 32 bits.
#[inline(always)]
pub fn saturated(wide: i64) -> i32 {
    let narrow = wide as i32;
    // The upper bits are copies of the sign: two instructions, where a comparison with both limits takes ten.
    if i64::from(narrow) == wide { narrow } else { out_of_range(wide) }
}

/// The nearest limit for a value of more than 32 bits.
#[inline(always)]
const fn out_of_range(wide: i64) -> i32 {
    i32::MAX ^ (wide >> 63) as i32
}

/// A truncated quotient; the greatest number if it has more than 32 bits. It uses two digits of 16 bits (D. E. Knuth,
/// The Art of Computer Programming, 4.3.1, algorithm D): a division of 64 bits by 64 takes a Cortex-M4 six times as
/// long.
pub fn quotient(dividend: u64, divisor: u32) -> u32 {
    let (upper, lower) = ((dividend >> 32) as u32, dividend as u32);
    if upper >= divisor {
        return u32::MAX;
    }
    if upper == 0 {
        return lower / divisor;
    }
    // With its highest bit set, the divisor's upper half alone gives a digit to within two.
    let shift = divisor.leading_zeros();
    let divisor = divisor << shift;
    // In two shifts: where `shift` is 0 a single one would be by 32, which is not defined.
    let (upper, lower) = (upper << shift | lower >> 1 >> (31 - shift), lower << shift);
    let (first, rest) = digit(upper, lower >> 16, divisor);
    let (second, _) = digit(rest, lower & 0xFFFF, divisor);
    first << 16 | second
}

/// The digit of `rest` followed by `next` over `divisor`, and the remainder. `rest` is less than `divisor`, which has
/// its highest bit set.
#[inline(always)]
const fn digit(rest: u32, next: u32, divisor: u32) -> (u32, u32) {
    let (upper, lower) = (divisor >> 16, divisor & 0xFFFF);
    let (mut digit, mut left) = (rest / upper, rest % upper);
    // At most twice: the estimate is too great by two at most.
    while left >> 16 == 0 && (digit >> 16 != 0 || digit * lower > (left << 16 | next)) {
        digit -= 1;
        left += upper;
    }
    (digit, (rest << 16 | next).wrapping_sub(digit.wrapping_mul(divisor)))
}

/// A power over a factor above 0.
pub fn over(value: Power, factor: I8F24) -> Power {
    let magnitude = u64::from(value.to_bits().unsigned_abs()) << I8F24::FRAC_NBITS;
    let magnitude = i64::from(quotient(magnitude, factor.unsigned_abs().to_bits()));
    Power::from_bits(saturated(if value < Power::ZERO { -magnitude } else { magnitude }))
}

/// A duty of 0 to 65,535 as a fraction.
#[inline(always)]
pub fn share(duty: u16) -> Ratio {
    Ratio::from_bits(u32::from(duty) + u32::from(duty >> 15))
}

/// `value` over `whole`, as a duty.
#[inline(always)]
pub fn duty(value: Power, whole: Power) -> u16 {
    if whole <= Power::ZERO {
        return 0;
    }
    let product = u64::from(value.max(Power::ZERO).to_bits().unsigned_abs()) * 65_535;
    quotient(product, whole.to_bits().unsigned_abs()).min(65_535) as u16
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn quotients_are_those_of_64_bits() {
        let edges = [1, 2, 3, 0xFFFE, 0xFFFF, 0x1_0000, 0x1_0001, 0x7FFF_FFFF, 0x8000_0000, 0x8000_FFFF, u32::MAX];
        let numbers = edges.iter().flat_map(|upper| edges.map(|lower| u64::from(*upper) << 32 | u64::from(lower)));
        for dividend in numbers.chain(edges.map(u64::from)).flat_map(|n| [n - 1, n, n >> 13]) {
            for divisor in edges {
                let exact = dividend / u64::from(divisor);
                assert_eq!(
                    quotient(dividend, divisor),
                    u32::try_from(exact).unwrap_or(u32::MAX),
                    "{dividend} {divisor}"
                );
            }
            assert_eq!(quotient(dividend, 0), u32::MAX);
        }
        // Digits that are estimated too great by one and by two, in both places.
        let mut random = 1u64;
        for _ in 0..200_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let divisor = (random >> 32) as u32 >> (random & 31) | 1;
            let dividend = random.rotate_left(17) % (u64::from(divisor) << 32);
            assert_eq!(u64::from(quotient(dividend, divisor)), dividend / u64::from(divisor), "{dividend} {divisor}");
        }
    }

    #[test]
    fn what_does_not_fit_is_a_limit() {
        let limits = [i64::from(i32::MIN), i64::from(i32::MAX)];
        assert_eq!(limits.map(saturated), [i32::MIN, i32::MAX]);
        assert_eq!([i64::MIN, limits[0] - 1].map(saturated), [i32::MIN; 2]);
        assert_eq!([i64::MAX, limits[1] + 1].map(saturated), [i32::MAX; 2]);
        let (half, ten) = (I8F24::lit("0.5"), Power::lit("-10.25"));
        assert_eq!((over(ten, half), over(Power::MIN, half)), (Power::lit("-20.5"), Power::MIN));
        assert_eq!((over(Power::MAX, half), over(Power::ONE, I8F24::ZERO)), (Power::MAX, Power::MAX));
        assert_eq!([Power::MIN, Power::ZERO, Power::MAX].map(|whole| duty(Power::ONE, whole)), [0, 0, 31]);
        assert_eq!(
            [-1, 10, 20, 30].map(|watts| duty(Power::from_num(watts), Power::from_num(20))),
            [0, 32_767, 65_535, 65_535]
        );
    }
}
