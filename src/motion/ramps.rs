//! Ramps: the formulas of motion at a constant acceleration, for the planner and for a brake that was not planned.
//!
//! Over the length L the square of the speed changes by `2 a L`.

use super::moves::WHOLE;
use super::number::{acceleration, from_bits, root_of, to_bits};
use crate::units::{MmPerSec2, SpeedSq};

/// Speed squared gained over `length` (raw `Mm` bits): 2 a L, saturating.
#[must_use]
pub(in crate::motion) const fn gain_sq(a: MmPerSec2, length: u64) -> SpeedSq {
    // Acceleration has 8 fractional bits, so 2 a L is a product shifted by 7; in two halves, to save its upper 64 bits.
    let a = a.to_bits() as u64;
    let (high, low) = (a * (length >> 32), (a * (length & 0xFFFF_FFFF)) >> 7);
    if high >> 38 != 0 { SpeedSq::MAX } else { SpeedSq((high << 25).saturating_add(low)) }
}

/// The speed of a given square, in 2^-32 mm/s. The square is scaled up first, so that the root has 31
/// significant bits however slow the move is: at 200 mm/s2 the 2^-16 mm/s of `MmPerSec` are a tick.
pub(in crate::motion) fn speed_of(SpeedSq(square): SpeedSq) -> u64 {
    let shift = square.leading_zeros() & !1;
    if square == 0 { 0 } else { (u64::from(root_of(square << shift)) << 16) >> (shift / 2) }
}

/// Distance in raw `Mm` bits over which the squared speed changes by `change`: v^2 / 2a.
pub(in crate::motion) fn ramp_length(change: SpeedSq, a: MmPerSec2) -> u64 {
    to_bits(from_bits(change.0) / (acceleration(a) * 2.0))
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
                // 32 fractional bits of the square make 16 of the speed, and the speed has 32.
                let exact = (square as f64).sqrt() * 65_536.0;
                let found = speed_of(SpeedSq(square)) as f64;
                assert!((found - exact).abs() < 1.0 + 1.5e-9 * exact, "{square}: {found}, not {exact}");
            }
        }
        assert_eq!(speed_of(SpeedSq(0)), 0);
    }
}
