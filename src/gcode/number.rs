//! Numbers: decimal text becomes fixed point without a float in between.
//!
//! The nearest multiple of 2^-32 is taken, a tie goes away from zero. Ties are rarer than they look: an odd multiple of
//! 2^-33 has exactly 33 decimals. So shorter texts never lie half-way, and the first 33 decimals decide longer ones.
//!
//! There is no exponent: to every slicer and to Marlin `X1E5` is X1 and E5.

use core::fmt;
use core::num::NonZeroU64;

use fixed::types::I32F32;

/// A number of a G-code word; never beyond ±[`Number::LIMIT`], so that sums of a few cannot overflow.
///
/// It holds how far the bits are above `LEAST`. So nothing is zero, and an `Option` of it takes no more than a
/// number: commands consist of little else.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Number(NonZeroU64);

/// Bits below those of any number.
const LEAST: i64 = i64::MIN;

impl Number {
    /// The largest magnitude; larger texts and values saturate to it.
    pub const LIMIT: i32 = 1_000_000_000;

    /// Zero.
    pub const ZERO: Self = Self::from_bits(0);

    /// The number with these bits, which are above [`LEAST`].
    const fn from_bits(bits: i64) -> Self {
        match NonZeroU64::new(bits.wrapping_sub(LEAST).cast_unsigned()) {
            Some(above_least) => Self(above_least),
            None => Self(NonZeroU64::MIN),
        }
    }

    const fn bits(self) -> i64 {
        self.0.get().cast_signed().wrapping_add(LEAST)
    }

    /// The number nearest to `value`. Inlined, it would be repeated at every value that is shown.
    #[must_use]
    #[inline(never)]
    pub const fn saturating(value: I32F32) -> Self {
        const LIMIT_BITS: i64 = (Number::LIMIT as i64) << 32;
        let bits = value.to_bits();
        if bits > LIMIT_BITS {
            Self::from_bits(LIMIT_BITS)
        } else if bits < -LIMIT_BITS {
            Self::from_bits(-LIMIT_BITS)
        } else {
            Self::from_bits(bits)
        }
    }

    /// Reads the number that `text` begins with, and returns it with the text after it.
    ///
    /// A sign and the digits on one side of the point may be missing. `None` if there is no digit.
    #[must_use]
    pub fn read(text: &[u8]) -> Option<(Self, &[u8])> {
        let (is_negative, text) = match text {
            [b'-', after @ ..] => (true, after),
            [b'+', after @ ..] => (false, after),
            _ => (false, text),
        };
        let (magnitude, after) = read_short(text).or_else(|| read_long(text))?;
        let bits = if is_negative { -magnitude } else { magnitude };
        Some((Self::from_bits(bits), after))
    }

    /// The value.
    #[must_use]
    pub const fn value(self) -> I32F32 {
        I32F32::from_bits(self.bits())
    }

    /// The integer part; decimals are cut off towards zero.
    #[must_use]
    pub const fn to_int(self) -> i32 {
        let bits = self.bits();
        let magnitude = (bits.unsigned_abs() >> 32) as i32;
        if bits < 0 { -magnitude } else { magnitude }
    }

    /// The integer part if it is positive, otherwise 0.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        let int = self.to_int();
        if int < 0 { 0 } else { int as u32 }
    }

    /// The value in thousandths, rounded to the nearest (a tie away from zero).
    #[must_use]
    pub const fn to_thousandths(self) -> i64 {
        let bits = self.bits();
        let magnitude = bits.unsigned_abs();
        let fraction = ((magnitude & 0xFFFF_FFFF) * 1000 + (1 << 31)) >> 32;
        let thousandths = ((magnitude >> 32) * 1000 + fraction) as i64;
        if bits < 0 { -thousandths } else { thousandths }
    }
}

impl Default for Number {
    fn default() -> Self {
        Self::ZERO
    }
}

impl fmt::Debug for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl From<i32> for Number {
    fn from(int: i32) -> Self {
        Self::saturating(I32F32::from_bits(i64::from(int) << 32))
    }
}

/// Digits that the quick path takes, which fit 32 bits. Slicers write 3 decimals of positions and 5 of the extruder.
const QUICK: usize = 9;

/// 10^n, and floor(2^63 / 10^n), which spares the quick path a 64-bit division.
const POWERS: [(u32, u64); QUICK + 1] = {
    let mut table = [(1, 1 << 63); QUICK + 1];
    let mut n = 1;
    let mut power = 1;
    while n <= QUICK {
        power *= 10;
        table[n] = (power, (1 << 63) / power as u64);
        n += 1;
    }
    table
};

/// Reads up to [`QUICK`] digits and the point among them: their value in units of 2^-32, and the text after them.
/// `None` if there are none, or more.
fn read_short(text: &[u8]) -> Option<(i64, &[u8])> {
    let (mut digits, mut decimals_begin) = (0u32, None);
    let mut bytes = text.iter();
    let after = loop {
        let after = bytes.as_slice();
        let Some(&byte) = bytes.next() else { break after };
        let digit = u32::from(byte).wrapping_sub(u32::from(b'0'));
        if digit < 10 {
            // Wraps after the tenth digit only, and then `count` refuses it.
            digits = digits.wrapping_mul(10).wrapping_add(digit);
        } else if byte == b'.' && decimals_begin.is_none() {
            // As a length that is left, because its difference to the end is the number of decimals.
            decimals_begin = Some(bytes.len());
        } else {
            break after;
        }
    };
    let decimals = decimals_begin.map_or(0, |length| length - after.len());
    let count = text.len() - after.len() - usize::from(decimals_begin.is_some());
    if count == 0 || count > QUICK {
        return None;
    }
    let &(power, reciprocal) = POWERS.get(decimals)?;
    // 32 bits: the processor divides them in some ten cycles, and 64 in some hundreds.
    let whole = digits / power;
    let magnitude = (u64::from(whole) << 32) + scale(digits - whole * power, power, reciprocal);
    Some((magnitude.cast_signed(), after))
}

/// As [`read_short`], for any number of digits; `None` only if there is none.
#[cold]
fn read_long(text: &[u8]) -> Option<(i64, &[u8])> {
    let mut integer = 0u32;
    let mut after = text;
    while let [digit @ b'0'..=b'9', tail @ ..] = after {
        integer = integer.saturating_mul(10).saturating_add(u32::from(digit - b'0'));
        after = tail;
    }
    let has_integer = after.len() < text.len();
    let mut fraction = 0;
    if let [b'.', decimals @ ..] = after {
        let (value, tail) = read_fraction(decimals);
        if !has_integer && tail.len() == decimals.len() {
            return None;
        }
        fraction = value;
        after = tail;
    } else if !has_integer {
        return None;
    }
    let magnitude = (u64::from(integer.min(Number::LIMIT as u32)) << 32) + fraction;
    Some((magnitude.min((Number::LIMIT as u64) << 32) as i64, after))
}

/// The last power of the table.
const POWERS_END: u32 = 1_000_000_000;

/// `decimals / power` in units of 2^-32, rounded to the nearest; `decimals` must be below `power`.
///
/// The reciprocal is too small by less than 1. So the estimate is too small by less than decimals / 2^31 < 0.47 before
/// its own decimals are cut off. The remainder is less than 1.47 `power`, and rounding adds 1 at the most.
#[inline(always)]
fn scale(decimals: u32, power: u32, reciprocal: u64) -> u64 {
    let quotient = (u64::from(decimals) * reciprocal) >> 31;
    let power = u64::from(power);
    let remainder = (u64::from(decimals) << 32).wrapping_sub(quotient * power);
    quotient + u64::from(2 * remainder >= power)
}

/// Reads the decimals that `text` begins with, any number of them: long multiplication by 2^32 in base 10^9.
///
/// Four limbs hold 36 decimals. The decimals cut off after them cannot lift a value to a tie, because ties are whole
/// multiples of 10^-33.
fn read_fraction(text: &[u8]) -> (u64, &[u8]) {
    let mut limbs = [0u32; 4];
    let mut after = text;
    for limb in &mut limbs {
        for _ in 0..QUICK {
            *limb *= 10;
            if let [digit @ b'0'..=b'9', tail @ ..] = after {
                *limb += u32::from(digit - b'0');
                after = tail;
            }
        }
    }
    while let [b'0'..=b'9', tail @ ..] = after {
        after = tail;
    }
    let base = u64::from(POWERS_END);
    let mut carry = 0;
    for limb in limbs.iter_mut().rev() {
        let product = (u64::from(*limb) << 32) + carry;
        carry = product / base;
        *limb = (product % base) as u32;
    }
    // The carry is the value in units of 2^-32; the limbs are the decimals of one more unit.
    let is_half_or_more = limbs[0] >= POWERS_END / 2;
    (carry + u64::from(is_half_or_more), after)
}

/// Prints the fewest decimals that read back as the same number; ten always do, because half a unit of
/// the tenth is less than 2^-33.
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bits = self.bits();
        let magnitude = bits.unsigned_abs();
        let fraction = magnitude & 0xFFFF_FFFF;
        if bits < 0 {
            f.write_str("-")?;
        }
        write!(f, "{}", magnitude >> 32)?;
        if fraction == 0 {
            return Ok(());
        }
        for (n, &(power, reciprocal)) in POWERS.iter().enumerate() {
            let decimals = ((fraction * u64::from(power) + (1 << 31)) >> 32) as u32;
            // Rounded up to `power` it would be the next whole number.
            if decimals < power && scale(decimals, power, reciprocal) == fraction {
                return write!(f, ".{decimals:0n$}");
            }
        }
        // Ten decimals times 32 bits are more than 64, so the tenth comes by itself.
        let nine = fraction * u64::from(POWERS_END);
        let ten = (nine >> 32) * 10 + (((nine & 0xFFFF_FFFF) * 10 + (1 << 31)) >> 32);
        write!(f, ".{ten:010}")
    }
}

#[cfg(test)]
mod tests;
