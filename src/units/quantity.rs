//! Quantities: numbers of one unit.
//!
//! A quantity is a fixed-point number behind a name. It has the operations that keep its unit: sums and differences of
//! its own kind, products and quotients with a plain number, comparison. A product of two quantities has another unit,
//! so `units` has a function for each one that the machine needs. All cost as much as the bare number.

use core::fmt;
use fixed::types::I32F32;

/// Any quantity, for code that reads and prints them all alike.
pub trait Quantity: Copy + PartialOrd + fmt::Display + Into<I32F32> {
    /// Bits after the point.
    const FRAC_NBITS: u32;

    /// The value of a plain number, with the bits that the type has; at the end of the range if it is beyond.
    #[must_use]
    fn saturating_from(number: I32F32) -> Self;
}

impl Quantity for I32F32 {
    const FRAC_NBITS: u32 = Self::FRAC_NBITS;

    fn saturating_from(number: I32F32) -> Self {
        number
    }
}

/// Makes a quantity: `NAME(NUMBER, BITS)`.
macro_rules! quantity {
    ($(#[$doc:meta])+ $name:ident($number:ty, $bits:ty)) => {
        $(#[$doc])+
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, serde::Serialize, serde::Deserialize)]
        #[serde(transparent)]
        #[repr(transparent)]
        pub struct $name($number);

        impl $name {
            /// None of it.
            pub const ZERO: Self = Self(<$number>::ZERO);
            /// One of the unit.
            pub const ONE: Self = Self(<$number>::ONE);
            /// The least value.
            pub const MIN: Self = Self(<$number>::MIN);
            /// The greatest value.
            pub const MAX: Self = Self(<$number>::MAX);
            /// The least difference of two values.
            pub const DELTA: Self = Self(<$number>::DELTA);
            /// Bits after the point.
            pub const FRAC_NBITS: u32 = <$number>::FRAC_NBITS;

            /// The value of a decimal text, for constants.
            #[must_use]
            pub const fn lit(text: &str) -> Self {
                Self(<$number>::lit(text))
            }

            /// So many of the unit, for constants.
            #[must_use]
            #[inline(always)]
            pub const fn const_from_int(units: $bits) -> Self {
                Self(<$number>::const_from_int(units))
            }

            /// The value with these bits.
            #[must_use]
            #[inline(always)]
            pub const fn from_bits(bits: $bits) -> Self {
                Self(<$number>::from_bits(bits))
            }

            /// Its bits.
            #[must_use]
            #[inline(always)]
            pub const fn to_bits(self) -> $bits {
                self.0.to_bits()
            }

            /// The value of a plain number, which must be in the range.
            #[must_use]
            #[inline(always)]
            pub fn from_num<N: $crate::units::PlainNumber>(number: N) -> Self {
                Self::saturating_from_num(number)
            }

            /// The value of a plain number, or the end of the range.
            #[must_use]
            #[inline(always)]
            pub fn saturating_from_num<N: $crate::units::PlainNumber>(number: N) -> Self {
                let parts = number.to_parts(Self::FRAC_NBITS);
                Self::from_bits(<$bits as $crate::units::plain::Bits>::saturating(parts))
            }

            /// The value of a plain number, if it is in the range.
            #[must_use]
            #[inline(always)]
            pub fn checked_from_num<N: $crate::units::PlainNumber>(number: N) -> Option<Self> {
                let parts = number.to_parts(Self::FRAC_NBITS);
                let bits = <$bits as $crate::units::plain::Bits>::saturating(parts);
                let is_within = i64::from(bits) == parts && parts != i64::MAX && parts != i64::MIN;
                is_within.then_some(Self::from_bits(bits))
            }

            /// The plain number of units.
            #[must_use]
            #[inline(always)]
            pub fn to_num<N: $crate::units::PlainNumber>(self) -> N {
                N::of_parts(i64::from(self.to_bits()), Self::FRAC_NBITS)
            }

            /// The sum, within the range.
            #[must_use]
            #[inline(never)]
            pub const fn saturating_add(self, other: Self) -> Self {
                Self(self.0.saturating_add(other.0))
            }

            /// The difference, within the range.
            #[must_use]
            #[inline(never)]
            pub const fn saturating_sub(self, other: Self) -> Self {
                Self(self.0.saturating_sub(other.0))
            }

            /// So many times as much, within the range.
            #[must_use]
            #[inline(always)]
            pub const fn saturating_mul_int(self, times: $bits) -> Self {
                Self(self.0.saturating_mul_int(times))
            }
        }

        impl $crate::units::quantity::Quantity for $name {
            const FRAC_NBITS: u32 = <$number>::FRAC_NBITS;

            fn saturating_from(number: fixed::types::I32F32) -> Self {
                Self::saturating_from_num(number)
            }
        }

        impl From<$name> for fixed::types::I32F32 {
            #[inline(always)]
            fn from(value: $name) -> Self {
                value.0.into()
            }
        }

        impl core::ops::Add for $name {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }

        impl core::ops::Sub for $name {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }

        impl core::ops::AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                self.0 += other.0;
            }
        }

        impl core::ops::SubAssign for $name {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                self.0 -= other.0;
            }
        }

        impl core::ops::Mul<$bits> for $name {
            type Output = Self;

            #[inline(always)]
            fn mul(self, times: $bits) -> Self {
                Self(self.0 * times)
            }
        }

        impl core::ops::Div<$bits> for $name {
            type Output = Self;

            #[inline(always)]
            fn div(self, parts: $bits) -> Self {
                Self(self.0 / parts)
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                self.0.fmt(f)
            }
        }

        impl core::fmt::Debug for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                core::fmt::Debug::fmt(&self.0, f)
            }
        }
    };
}
pub(super) use quantity;

/// Adds to a quantity what only numbers with a sign have: the opposite, and magnitudes.
macro_rules! signed {
    ($($name:ident),+) => {
        $(impl $name {
            /// Its magnitude, within the range.
            #[must_use]
            #[inline(always)]
            pub const fn saturating_abs(self) -> Self {
                Self(self.0.saturating_abs())
            }

            /// The opposite, within the range.
            #[must_use]
            #[inline(always)]
            pub const fn saturating_neg(self) -> Self {
                Self(self.0.saturating_neg())
            }
        }

        impl core::ops::Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        /// So many times halved; rounded down.
        impl core::ops::Shr<u32> for $name {
            type Output = Self;

            #[inline(always)]
            fn shr(self, times: u32) -> Self {
                Self(self.0 >> times)
            }
        })+
    };
}
pub(super) use signed;

/// Adds to a quantity sums and differences that wrap, for positions that never come back.
macro_rules! wrapping {
    ($($name:ident),+) => {
        $(impl $name {
            /// The sum, which wraps.
            #[must_use]
            #[inline(always)]
            pub const fn wrapping_add(self, way: Self) -> Self {
                Self(self.0.wrapping_add(way.0))
            }

            /// The difference of positions that may have wrapped.
            #[must_use]
            #[inline(always)]
            pub const fn wrapping_sub(self, from: Self) -> Self {
                Self(self.0.wrapping_sub(from.0))
            }
        })+
    };
}
pub(super) use wrapping;
