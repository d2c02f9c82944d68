//! Numbers of lines: read to the nearest value of a type, and printed so that they read back as the same value.

use crate::gcode::Number;
use crate::settings::ShaperKind;
use crate::units::{Mm, Quantity, Ratio, Seconds, part_of};
use core::fmt;
use fixed::types::I32F32;

/// The shapers, each at the place of its number in M593 T (Prusa-Firmware-Buddy).
pub(in crate::machine) const SHAPERS: [ShaperKind; 5] =
    [ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Mzv, ShaperKind::Ei, ShaperKind::TwoHumpEi];

/// The value nearest to a number.
pub(in crate::machine) fn nearest<T: Quantity>(number: Number) -> T {
    let half = I32F32::from_bits(1 << 31 >> T::FRAC_NBITS);
    T::saturating_from(number.value().saturating_add(half))
}

/// The rate of a time constant, in 1/s.
pub(in crate::machine) fn rate(lag: Seconds) -> Ratio {
    let bits = (1u64 << 40) + u64::from(lag.to_bits() / 2);
    Ratio::from_bits((bits / u64::from(lag.to_bits().max(1))).min(u64::from(u32::MAX)) as u32)
}

/// The number with the fewest decimals that is read as `value`. `fixed` can print that too, in 3 KiB of flash. Inlined,
/// it would be in 28 places.
#[inline(never)]
pub(in crate::machine) fn shortest<T: Quantity>(value: T) -> Number {
    shortest_with(value.into(), T::FRAC_NBITS)
}

/// The same for a value with so many bits after the point.
#[inline(never)]
pub(in crate::machine) fn shortest_with(value: I32F32, fraction_bits: u32) -> Number {
    let (bits, half) = (value.to_bits(), 1u64 << 31 >> fraction_bits);
    let fraction = bits as u64 & 0xFFFF_FFFF;
    let mut power = 1u64;
    let mut short = bits;
    for _ in 0..=9 {
        let decimals = (fraction * power + (1 << 31)) >> 32;
        let candidate = ((decimals << 32) + power / 2) / power;
        if candidate.abs_diff(fraction) < half {
            short = bits - fraction as i64 + candidate as i64;
            break;
        }
        power *= 10;
    }
    Number::saturating(I32F32::from_bits(short))
}

/// A setting with as many decimals as reading it back needs.
pub(in crate::machine) fn exact(value: impl Into<I32F32>) -> Number {
    Number::saturating(value.into())
}

/// The value to three decimals.
pub(in crate::machine) fn to_thousandth(value: I32F32) -> I32F32 {
    let doubled = part_of(Number::saturating(value).to_thousandths(), 1 << 33, 1000);
    I32F32::from_bits((doubled + doubled.signum()) / 2)
}

/// A length with three decimals.
pub(in crate::machine) struct Thousandths(pub Mm);

impl fmt::Display for Thousandths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bits = self.0.to_bits();
        // Millimetres and the thousandths behind the point, each of 32 bits.
        let (mm, fraction) = ((bits.unsigned_abs() >> 32) as u32, bits.unsigned_abs() & 0xFFFF_FFFF);
        let thousandths = ((fraction * 1000 + (1 << 31)) >> 32) as u32;
        let (mm, thousandths) = if thousandths < 1000 { (mm, thousandths) } else { (mm + 1, 0) };
        let sign = if bits < 0 && (mm, thousandths) != (0, 0) { "-" } else { "" };
        write!(f, "{sign}{mm}.{thousandths:03}")
    }
}

/// A value with two decimals, as hosts expect positions.
pub(in crate::machine) struct Hundredths(I32F32);

impl Hundredths {
    pub fn of(value: impl Into<I32F32>) -> Self {
        Self(value.into())
    }
}

impl fmt::Display for Hundredths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bits = self.0.to_bits();
        let hundredths = (bits >> 32) * 100 + (((bits & 0xFFFF_FFFF) * 100 + (1 << 31)) >> 32);
        let sign = if hundredths < 0 { "-" } else { "" };
        let hundredths = hundredths.unsigned_abs();
        write!(f, "{sign}{}.{:02}", hundredths / 100, hundredths % 100)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::units::{Hertz, Seconds};
    use std::string::{String, ToString};

    /// The printed form of a number that was read.
    fn printed<T: Quantity>(text: &str) -> String {
        let (number, _) = Number::read(text.as_bytes()).unwrap();
        shortest(nearest::<T>(number)).to_string()
    }

    #[test]
    fn values_are_printed_as_they_were_read() {
        for text in ["0", "0.05", "0.04", "0.00001", "0.1234567", "4", "0.9999999"] {
            assert_eq!(printed::<Seconds>(text), text);
        }
        for text in ["60", "61.1", "107.5", "499.99", "10.001", "0.055"] {
            assert_eq!(printed::<Hertz>(text), text);
        }
    }

    #[test]
    fn every_value_reads_back() {
        for bits in (0..1 << 26).step_by(997) {
            let value = Seconds::from_bits(bits);
            assert_eq!(nearest::<Seconds>(shortest(value)), value);
        }
        for bits in (0..500 << 16).step_by(13) {
            let value = Hertz::from_bits(bits);
            assert_eq!(nearest::<Hertz>(shortest(value)), value);
        }
    }
    #[test]
    fn positions_have_two_decimals_and_one_sign() {
        let text = |v: f64| Hundredths::of(Mm::from_num(v)).to_string();
        assert_eq!(text(1.005_1), "1.01");
        assert_eq!(text(-0.5), "-0.50");
        assert_eq!(text(-0.001), "0.00");
        assert_eq!(text(417.6), "417.60");
        assert_eq!(Hundredths::of(Mm::MAX).to_string(), "2147483648.00");
        assert_eq!(Hundredths::of(Mm::MIN).to_string(), "-2147483648.00");
    }
}
