//! Units: the type of a number carries its unit, and conversions live here alone.
//!
//! Everything is integer or fixed point, so that every platform computes the same bits. The widths are
//! chosen so that the largest machine we drive leaves headroom: see the range beside each type.

use fixed::types::{I0F32, I12F20, I32F32, U8F24, U16F16, U24F8};

/// A length or position in millimetres; resolution 0.23 nm, range +-2.1e9 mm.
pub type Mm = I32F32;

/// A position of one motor or axis in (micro)steps, with the fraction that lies between two steps;
/// range +-2.1e9 steps. Arithmetic on absolute positions wraps (an extruder never comes back), so
/// differences are taken with `wrapping_sub`.
pub type Steps = I32F32;

/// A speed in mm/s; resolution 15 um/s, range 65 m/s.
pub type MmPerSec = U16F16;

/// An acceleration in mm/s2; resolution 0.004 mm/s2, range 16.7 km/s2.
pub type MmPerSec2 = U24F8;

/// A motor's resolution in (micro)steps a millimetre.
pub type StepsPerMm = U16F16;

/// A frequency; resolution 15 uHz.
pub type Hertz = U16F16;

/// A short time in s; resolution 0.06 us, range 256 s.
pub type Seconds = U8F24;

/// A ratio; resolution 15 millionths.
pub type Ratio = U16F16;

/// A temperature in degrees Celsius, or a difference in K; resolution a millionth, range +-2048.
pub type Celsius = I12F20;

/// A power in W; resolution 15 uW, range 65 kW.
pub type Watts = U16F16;

/// A heat capacity in J/K; resolution 15 millionths, range 65 kJ/K.
pub type JoulesPerKelvin = U16F16;

/// Heat that flows for each K of difference, in W/K, or that a mm of filament takes, in J/(K mm); range 256.
pub type WattsPerKelvin = U8F24;

/// The one tick of every platform: 0.1 us. An STM32F446 counts it exactly, in 18 cycles of 180 MHz.
pub const TICKS_PER_SECOND: u32 = 10_000_000;

/// The square of a speed, in 2^-32 mm2/s2: the square of a raw [`MmPerSec`]. Ramps and corners are laws of the square,
/// and a square cannot be taken for the speed itself.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
#[repr(transparent)]
pub struct SpeedSq(pub u64);

impl SpeedSq {
    /// At rest.
    pub const ZERO: Self = Self(0);
    /// No limit.
    pub const MAX: Self = Self(u64::MAX);

    /// The square of a speed.
    #[must_use]
    #[inline(always)]
    pub const fn of(speed: MmPerSec) -> Self {
        Self(speed.to_bits() as u64 * speed.to_bits() as u64)
    }

    /// The sum, at most [`MAX`](Self::MAX).
    #[must_use]
    #[inline(always)]
    pub const fn saturating_add(self, gain: Self) -> Self {
        Self(self.0.saturating_add(gain.0))
    }

    /// The difference, at least 0.
    #[must_use]
    #[inline(always)]
    pub const fn saturating_sub(self, loss: Self) -> Self {
        Self(self.0.saturating_sub(loss.0))
    }

    /// The sum, which wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_add(self, gain: Self) -> Self {
        Self(self.0.wrapping_add(gain.0))
    }

    /// The difference of two sums that have wrapped.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }

    /// The absolute difference.
    #[must_use]
    #[inline(always)]
    pub const fn abs_diff(self, other: Self) -> Self {
        Self(self.0.abs_diff(other.0))
    }
}

/// Motion time, or a length of it, in ticks times 2^16; 64 bits, so it never wraps. Only the step event itself is
/// rounded to a whole tick.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
#[repr(transparent)]
pub struct SubTicks(pub u64);

impl SubTicks {
    /// No time.
    pub const ZERO: Self = Self(0);
    /// Never.
    pub const MAX: Self = Self(u64::MAX);

    /// This many whole ticks.
    #[must_use]
    #[inline(always)]
    pub const fn of_ticks(ticks: u64) -> Self {
        Self(ticks << 16)
    }

    /// Whole ticks, cut off.
    #[must_use]
    #[inline(always)]
    pub const fn whole_ticks(self) -> u64 {
        self.0 >> 16
    }

    /// The tick nearest to it.
    #[must_use]
    #[inline(always)]
    pub const fn nearest_tick(self) -> u64 {
        self.0.saturating_add(1 << 15) >> 16
    }

    /// The difference, at least none.
    #[must_use]
    #[inline(always)]
    pub const fn saturating_sub(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }
}

impl core::ops::Add for SubTicks {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl core::ops::AddAssign for SubTicks {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl core::ops::Sub for SubTicks {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

/// Ticks in a millisecond.
pub const TICKS_PER_MS: u32 = TICKS_PER_SECOND / 1000;

/// A point of real time on the step timer's 32-bit counter; it wraps after 429 s.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Tick(pub u32);

impl Tick {
    /// The tick `span` later.
    #[must_use]
    pub const fn after(self, span: u32) -> Self {
        Self(self.0.wrapping_add(span))
    }

    /// Whether this tick comes before `other`; right for distances below 214 s.
    #[must_use]
    pub const fn is_before(self, other: Self) -> bool {
        (self.0.wrapping_sub(other.0) as i32) < 0
    }

    /// Ticks from `earlier` to this one, across a wrap.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u32 {
        self.0.wrapping_sub(earlier.0)
    }
}

/// A point of real time for the Console, in ticks since start; 64 bits, so it never wraps.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub struct Instant(pub u64);

impl Instant {
    /// The instant `ms` milliseconds later.
    #[must_use]
    pub const fn after_ms(self, ms: u32) -> Self {
        Self(self.0.saturating_add(ms as u64 * TICKS_PER_MS as u64))
    }
}

/// The part of a difference that a lag of the first order makes up for in one of `rate` periods a second; a half, if
/// the lag is shorter than two periods. The product of such a part and a word has the word's size without a shift or a
/// check.
#[must_use]
pub const fn part_per_period(lag: Seconds, rate: u32) -> I0F32 {
    const ONE: u64 = 1 << I0F32::FRAC_NBITS;
    let product = lag.to_bits() as u64 * rate as u64;
    let part = (ONE << Seconds::FRAC_NBITS) / if product == 0 { 1 } else { product };
    if part < ONE / 2 { I0F32::from_bits(part as i32) } else { I0F32::MAX }
}

/// Periods, `rate` of them a second, in this many lags; cut off.
#[must_use]
pub const fn periods_in(lags: u32, lag: Seconds, rate: u32) -> u32 {
    // 32 bits are enough for half an hour at a rate of 100,000.
    ((lag.to_bits() as u64 * lags as u64 * rate as u64) >> Seconds::FRAC_NBITS) as u32
}

/// Multiplies before it divides, with all the bits in between; saturates instead of wrapping and
/// treats a division by zero as infinite.
#[must_use]
pub const fn mul_div(a: u64, b: u64, divisor: u64) -> u64 {
    if divisor == 0 {
        return u64::MAX;
    }
    // The narrow path is the common one, and a 128-bit division costs a Cortex-M4 some thousand cycles.
    match a.checked_mul(b) {
        Some(product) => product / divisor,
        None => wide_mul_div(a, b, divisor),
    }
}

/// The wide path of [`mul_div`]: a product of 128 bits divided in two digits of 32 bits (D. E. Knuth, The Art of
/// Computer Programming, 4.3.1, algorithm D). Compilers for 32 bits expand such a division bit by bit at each use, 800
/// bytes of it.
#[cold]
#[inline(never)]
const fn wide_mul_div(a: u64, b: u64, divisor: u64) -> u64 {
    let product = a as u128 * b as u128;
    if (product >> 64) as u64 >= divisor {
        return u64::MAX;
    }
    // With its highest bit set, the divisor's upper half alone gives a digit to within two.
    let shift = divisor.leading_zeros();
    let (product, divisor) = (product << shift, divisor << shift);
    let (first, rest) = digit((product >> 64) as u64, (product >> 32) as u32, divisor);
    let (second, _) = digit(rest, product as u32, divisor);
    first << 32 | second
}

/// The number of times that `divisor` is contained in `rest` followed by `next`, and the remainder. `rest` is less than
/// `divisor`, and the highest bit of `divisor` is set.
const fn digit(rest: u64, next: u32, divisor: u64) -> (u64, u64) {
    let (upper, lower) = (divisor >> 32, divisor & 0xFFFF_FFFF);
    let (mut digit, mut left) = (rest / upper, rest % upper);
    while digit >> 32 != 0 || (left >> 32 == 0 && digit * lower > (left << 32 | next as u64)) {
        digit -= 1;
        left += upper;
    }
    (digit, (rest << 32 | next as u64).wrapping_sub(digit.wrapping_mul(divisor)))
}

/// The part `part / whole` of a value with a sign, cut off towards zero; saturates as [`mul_div`] does.
#[must_use]
#[inline(never)]
pub const fn part_of(value: i64, part: u64, whole: u64) -> i64 {
    let magnitude = mul_div(value.unsigned_abs(), part, whole);
    if value < 0 { 0i64.saturating_sub_unsigned(magnitude) } else { 0i64.saturating_add_unsigned(magnitude) }
}

/// The integer nearest to the square root. A root that is always cut short would make every speed a little
/// too small, and the error would add up over a print.
#[must_use]
pub const fn root(square: u64) -> u64 {
    let root = square.isqrt();
    if square - root * root > root { root + 1 } else { root }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_compare_across_the_wrap() {
        let before = Tick(u32::MAX - 5);
        let after = before.after(10);
        assert_eq!(after, Tick(4));
        assert!(before.is_before(after));
        assert!(!after.is_before(before));
        assert_eq!(after.since(before), 10);
    }

    #[test]
    fn roots_are_the_nearest() {
        for (square, expected) in [(0, 0), (2, 1), (3, 2), (6, 2), (7, 3), (u64::MAX, 1 << 32)] {
            assert_eq!(root(square), expected);
        }
    }

    #[test]
    fn lags_are_parts_and_numbers_of_periods() {
        let parts = [("2", 50), ("0.5", 50), ("0.02", 50), ("0.001", 50), ("0", 50), ("200", 1000)];
        for (lag, rate) in parts.map(|(lag, rate)| (Seconds::lit(lag), rate)) {
            let wanted = (1.0 / (lag.to_num::<f64>() * f64::from(rate))).min(0.5);
            assert!((part_per_period(lag, rate).to_num::<f64>() - wanted).abs() < 1e-9, "{lag}");
        }
        assert_eq!(periods_in(6, Seconds::lit("2.5"), 50), 750);
        assert_eq!(periods_in(5, Seconds::lit("0.019"), 50), 4);
        assert_eq!(periods_in(u32::from(u16::MAX), Seconds::MAX, 50), 838_847_999);
    }

    #[test]
    fn mul_div_keeps_every_bit_and_saturates() {
        assert_eq!(mul_div(u64::MAX, 6, 3), u64::MAX);
        assert_eq!(mul_div(u64::MAX / 2, 4, 8), u64::MAX / 4);
        assert_eq!(mul_div(7, 3, 2), 10);
        assert_eq!(mul_div(7, 3, 0), u64::MAX);
        // Digits that are estimated one and two too great at first, and a divisor of few bits.
        let edges = [1, 3, 0xFFFF_FFFF, 1 << 32, 0x8000_0000_0000_0001, 0x8000_0000_FFFF_FFFF, u64::MAX - 1, u64::MAX];
        for (a, b, divisor) in edges.iter().flat_map(|a| edges.iter().flat_map(|b| edges.map(|d| (*a, *b, d)))) {
            let exact = u128::from(a) * u128::from(b) / u128::from(divisor);
            assert_eq!(mul_div(a, b, divisor), u64::try_from(exact).unwrap_or(u64::MAX), "{a} {b} {divisor}");
        }
    }

    #[test]
    fn a_part_keeps_the_sign_and_is_cut_off_towards_zero() {
        for (value, part) in [(7, 4), (-7, -4), (i64::MAX, 5_534_023_222_112_865_484), (0, 0)] {
            assert_eq!(part_of(value, 3, 5), part);
        }
        assert_eq!(part_of(i64::MAX, 5, 3), i64::MAX);
        assert_eq!(part_of(i64::MIN, 5, 3), i64::MIN);
        assert_eq!(part_of(i64::MIN, 1, 1), i64::MIN);
    }
}
