//! Lengths of paths.

use super::{Mm, Ratio, mul_div};

/// The length of a path, in 2^-32 mm: a raw [`Mm`] without a sign, so the longest way between two positions fits. It is
/// no position, and it has no direction.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[repr(transparent)]
pub struct Length(pub u64);

impl Length {
    /// No way.
    pub const ZERO: Self = Self(0);

    /// The length of a way along an axis.
    #[must_use]
    #[inline(always)]
    pub const fn of(way: Mm) -> Self {
        Self(way.to_bits().unsigned_abs())
    }

    /// The difference, at least none.
    #[must_use]
    #[inline(always)]
    pub const fn saturating_sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// The sum, which wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_add(self, more: Self) -> Self {
        Self(self.0.wrapping_add(more.0))
    }

    /// The difference of two sums, which wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_sub(self, less: Self) -> Self {
        Self(self.0.wrapping_sub(less.0))
    }

    /// This part of it, at most all; cut off.
    #[must_use]
    #[inline(always)]
    pub const fn ratio(self, part: Ratio) -> Self {
        const WIDTH: u32 = Ratio::FRAC_NBITS;
        let part = part.to_bits() as u64;
        Self((((self.0 >> 32) * part) << (32 - WIDTH)) + (((self.0 & 0xFFFF_FFFF) * part) >> WIDTH))
    }

    /// `part` of `whole` parts of it; cut off.
    #[must_use]
    #[inline(always)]
    pub const fn part(self, part: u64, whole: u64) -> Self {
        Self(mul_div(self.0, part, whole))
    }

    /// The number of parts that it covers of a length that has `whole` of them; cut off.
    #[must_use]
    #[inline(always)]
    pub const fn parts_of(self, all: Self, whole: u64) -> u64 {
        mul_div(self.0, whole, all.0)
    }

    /// Whole millimetres, cut off.
    #[must_use]
    pub const fn whole_mm(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// Whole micrometres, cut off; the count wraps.
    #[must_use]
    pub const fn wrapping_um(self) -> u32 {
        ((self.0 as u128 * 1000) >> 32) as u32
    }
}

/// Its bits alone, as all quantities are shown as plain numbers.
impl core::fmt::Debug for Length {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_cut_into_parts() {
        let length = Length::of(Mm::lit("-2.5"));
        assert_eq!(length, Length(5 << 31));
        assert_eq!((length.part(3, 5), length.ratio(Ratio::lit("0.5"))), (Length(3 << 31), Length(5 << 30)));
        assert_eq!(length.part(1, 2).parts_of(length, 1 << 31), 1 << 30);
        assert_eq!((length.whole_mm(), length.wrapping_um()), (2, 2500));
        assert_eq!(Length::of(Mm::MIN).ratio(Ratio::ONE), Length(1 << 63));
        assert_eq!(Length::ZERO.parts_of(Length::ZERO, 7), u64::MAX, "nothing has no parts");
    }
}
