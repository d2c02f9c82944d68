//! Plain numbers: quantities are made from them, and turned into them. `fixed` does that for numbers of any width, in
//! 4 KB of flash.

use fixed::types::I32F32;

/// An integer, a float, or a fixed-point number without a unit.
pub trait PlainNumber: Copy {
    /// The number in parts of 2^-`bits`, with up to 32 bits; at the end of the range if it is beyond. Floats are
    /// rounded to the nearest part, a half to the even one, and fixed point is rounded down.
    #[must_use]
    fn to_parts(self, bits: u32) -> i64;

    /// The number with so many parts of 2^-`bits`. Integers are rounded down and wrap, floats are the nearest.
    #[must_use]
    fn of_parts(parts: i64, bits: u32) -> Self;
}

/// The parts of a whole number. Inlined, it would be at each integer that becomes a quantity.
#[inline(never)]
const fn parts_of_whole(number: i64, bits: u32) -> i64 {
    let parts = number << bits;
    if parts >> bits == number {
        parts
    } else if number < 0 {
        i64::MIN
    } else {
        i64::MAX
    }
}

macro_rules! integers {
    ($($integer:ty),+) => {
        $(impl PlainNumber for $integer {
            #[inline(always)]
            fn to_parts(self, bits: u32) -> i64 {
                parts_of_whole(self.into(), bits)
            }

            #[inline(always)]
            fn of_parts(parts: i64, bits: u32) -> Self {
                (parts >> bits) as Self
            }
        })+
    };
}
integers!(i8, i16, i32, i64, u8, u16, u32);

macro_rules! large_integers {
    ($($integer:ty),+) => {
        $(impl PlainNumber for $integer {
            #[inline(always)]
            fn to_parts(self, bits: u32) -> i64 {
                parts_of_whole(i64::try_from(self).unwrap_or(i64::MAX), bits)
            }

            #[inline(always)]
            fn of_parts(parts: i64, bits: u32) -> Self {
                (parts >> bits) as Self
            }
        })+
    };
}
large_integers!(u64, usize);

impl PlainNumber for f32 {
    /// By the bits of the float: the processor turns floats into numbers of 32 bits only.
    #[inline(never)]
    fn to_parts(self, bits: u32) -> i64 {
        let (sign, exponent) = (self.to_bits() >> 31, (self.to_bits() >> 23) & 0xFF);
        let significand = u64::from(self.to_bits() & 0x7F_FFFF | 1 << 23);
        let parts = match (exponent + bits).checked_sub(150) {
            Some(left @ ..=39) => (significand << left) as i64,
            Some(_) => return if sign == 0 { i64::MAX } else { i64::MIN },
            None => {
                let right = (150 - exponent - bits).min(32);
                let (whole, rest, half) = (significand >> right, significand << (64 - right), 1 << 63);
                (whole + u64::from(rest > half || (rest == half && whole & 1 == 1))) as i64
            }
        };
        if sign == 0 { parts } else { -parts }
    }

    #[inline(never)]
    fn of_parts(parts: i64, bits: u32) -> Self {
        parts as Self * Self::from_bits((127 - bits) << 23)
    }
}

impl PlainNumber for f64 {
    fn to_parts(self, bits: u32) -> i64 {
        const WHOLE: f64 = 4_503_599_627_370_496.0;
        let parts = self * Self::from_bits(u64::from(1023 + bits) << 52);
        let shift = WHOLE.copysign(parts);
        (if parts.abs() < WHOLE { parts + shift - shift } else { parts }) as i64
    }

    fn of_parts(parts: i64, bits: u32) -> Self {
        parts as Self * Self::from_bits(u64::from(1023 - bits) << 52)
    }
}

impl PlainNumber for I32F32 {
    #[inline(always)]
    fn to_parts(self, bits: u32) -> i64 {
        self.to_bits() >> (Self::FRAC_NBITS - bits)
    }

    #[inline(always)]
    fn of_parts(parts: i64, bits: u32) -> Self {
        Self::from_bits(parts << (Self::FRAC_NBITS - bits))
    }
}

/// The bits of a quantity.
pub trait Bits {
    /// So many parts, or the end of the range.
    fn saturating(parts: i64) -> Self;
}

impl Bits for i64 {
    #[inline(always)]
    fn saturating(parts: i64) -> Self {
        parts
    }
}

impl Bits for i32 {
    #[inline(never)]
    fn saturating(parts: i64) -> Self {
        parts.clamp(Self::MIN.into(), Self::MAX.into()) as Self
    }
}

impl Bits for u32 {
    #[inline(never)]
    fn saturating(parts: i64) -> Self {
        parts.clamp(0, Self::MAX.into()) as Self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Celsius, Mm, MmPerSec2, Seconds};
    use fixed::traits::{FromFixed, ToFixed};
    use fixed::types::{I12F20, U8F24, U24F8};

    const FLOATS: [f64; 19] = [
        0.0,
        0.5,
        1.5,
        -0.5,
        -1.5,
        2.5,
        0.1,
        -0.1,
        1e-9,
        -1e-9,
        3.0e5,
        32_767.499_999,
        8_388_607.5,
        16_777_215.7,
        1e9,
        -1e9,
        1e12,
        -1e12,
        f64::INFINITY,
    ];

    /// Numbers become the same bits as those of `fixed`.
    fn becomes<N: PlainNumber + ToFixed>(number: N) {
        assert_eq!(Mm::saturating_from_num(number).to_bits(), I32F32::saturating_from_num(number).to_bits());
        assert_eq!(Celsius::saturating_from_num(number).to_bits(), I12F20::saturating_from_num(number).to_bits());
        assert_eq!(Seconds::saturating_from_num(number).to_bits(), U8F24::saturating_from_num(number).to_bits());
        assert_eq!(MmPerSec2::saturating_from_num(number).to_bits(), U24F8::saturating_from_num(number).to_bits());
    }

    #[test]
    fn numbers_become_quantities_as_fixed_makes_them() {
        for float in FLOATS {
            for parts in [-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5] {
                for unit in [8, 20, 24, 32].map(|bits| f64::from(bits).exp2_of()) {
                    becomes(float + parts * unit);
                    becomes((float + parts * unit) as f32);
                }
            }
        }
        for whole in [0, 1, -1, 255, 256, 2047, 2048, -2048, -2049, i32::MAX, i32::MIN] {
            becomes(whole);
            becomes(i64::from(whole) * 3);
            becomes(whole.unsigned_abs());
            becomes(I32F32::from_bits(i64::from(whole) * 0x1234_5679));
        }
        becomes(u64::MAX);
    }

    /// 2^-n of a float n, without the standard library.
    trait Exp2 {
        fn exp2_of(self) -> f64;
    }

    impl Exp2 for f64 {
        fn exp2_of(self) -> f64 {
            f64::from_bits((1023 - self as u64) << 52)
        }
    }

    fn turns<N: PlainNumber + FromFixed + PartialEq + core::fmt::Debug>() {
        for bits in [0i64, 1, -1, 1 << 31, -(1 << 31), 0x1234_5678_9ABC, -0x1234_5678_9ABC, 127 << 32] {
            let (mm, fixed) = (Mm::from_bits(bits), I32F32::from_bits(bits));
            assert_eq!(mm.to_num::<N>(), fixed.wrapping_to_num::<N>());
            let (time, fixed) = (Seconds::from_bits(bits as u32), U8F24::from_bits(bits as u32));
            assert_eq!(time.to_num::<N>(), fixed.wrapping_to_num::<N>());
        }
    }

    #[test]
    fn quantities_become_numbers_as_fixed_makes_them() {
        turns::<f32>();
        turns::<f64>();
        turns::<i32>();
        turns::<i64>();
        turns::<i16>();
        turns::<u32>();
    }

    #[test]
    fn numbers_out_of_range_are_none() {
        assert_eq!(Mm::checked_from_num(1e12), None);
        assert_eq!(Seconds::checked_from_num(-1), None);
        assert_eq!(Seconds::checked_from_num(255.5), Some(Seconds::lit("255.5")));
    }
}
