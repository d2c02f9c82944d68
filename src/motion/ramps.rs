//! Ramps: formulas of motion at constant acceleration, for the planner and for unplanned braking.
//!
//! Over the length L the square of the speed changes by `2 a L` ([`SpeedSq::gained`]).

use super::moves::WHOLE;
use super::number::{acceleration, length_of, root_of, square};
use crate::units::{Length, MmPerSec2, SpeedSq};

/// Speed of a square, in 2^-32 mm/s. Scaling the square up first gives the root 31 significant bits for slow moves too:
/// at 200 mm/s2 the 2^-16 mm/s of `MmPerSec` are a tick.
pub(in crate::motion) fn speed_of(SpeedSq(square): SpeedSq) -> u64 {
    let shift = square.leading_zeros() & !1;
    if square == 0 { 0 } else { (u64::from(root_of(square << shift)) << 16) >> (shift / 2) }
}

/// Length over which the squared speed changes by `change`: v^2 / 2a.
pub(in crate::motion) fn ramp_length(change: SpeedSq, a: MmPerSec2) -> Length {
    length_of(square(change) / (acceleration(a) * 2.0))
}

/// `part / whole`, scaled by [`WHOLE`].
pub(in crate::motion) const fn fraction(part: u64, whole: u64) -> u32 {
    // 33 bits of the whole are enough, and the product fits.
    let shift = 31u32.saturating_sub(whole.leading_zeros());
    let (part, whole) = (part >> shift, whole >> shift);
    match (part * WHOLE as u64).checked_div(whole) {
        Some(scaled) if scaled < WHOLE as u64 => scaled as u32,
        _ => WHOLE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_is_the_root_of_its_square_however_slow() {
        for bits in 0..63 {
            for square in [1u64 << bits, (1 << bits) | (1 << bits >> 1), (1 << bits) + ((1 << bits) - 1)] {
                // 32 fractional bits of the square give 16 of the speed, and the speed has 32.
                let exact = (square as f64).sqrt() * 65_536.0;
                let found = speed_of(SpeedSq(square)) as f64;
                assert!((found - exact).abs() < 1.0 + 1.5e-9 * exact, "{square}: {found}, not {exact}");
            }
        }
        assert_eq!(speed_of(SpeedSq(0)), 0);
    }

    #[test]
    fn a_fraction_is_at_most_one() {
        for whole in [1u64, 3, 1000, (1 << 33) - 1, 1 << 33, (1 << 40) + 12_345, u64::MAX >> 1] {
            for part in [0, whole / 7, whole / 2, whole - 1, whole] {
                let exact = part as f64 / whole as f64 * f64::from(WHOLE);
                assert!((f64::from(fraction(part, whole)) - exact).abs() <= 2.0, "{part} of {whole}");
            }
        }
        // Rounded roots may exceed the faster of two speeds by their last bit.
        assert_eq!((fraction(1001, 1000), fraction(0, 0)), (WHOLE, WHOLE));
    }

    #[test]
    fn what_a_ramp_gains_is_lost_on_its_length() {
        for (a, mm) in [(1u32, 0.001), (3000, 0.5), (5000, 300.0), (20_000, 4000.0)] {
            let (a, length) = (MmPerSec2::from_num(a), Length((mm * 4_294_967_296.0) as u64));
            let gained = SpeedSq::gained(a, length);
            let exact = 2.0 * a.to_num::<f64>() * mm;
            assert!((gained.0 as f64 / 4_294_967_296.0 - exact).abs() <= 1e-6 + 1e-9 * exact, "{a} {mm}");
            assert!((ramp_length(gained, a).0 as f64 / length.0 as f64 - 1.0).abs() < 1e-5, "{a} {mm}");
        }
        // The last value that fits, and the first that does not.
        let (a, length) = (MmPerSec2::from_bits(1 << 16), Length((1 << 54) - 1));
        assert_eq!(SpeedSq::gained(a, length), SpeedSq(length.0 << 9));
        assert_eq!(SpeedSq::gained(a, Length(1 << 54)), SpeedSq::MAX);
    }
}
