//! Numbers of motion: conversion between fixed point, which is exact, and single precision, which is fast.
//!
//! IEEE 754 defines every bit of the sum, difference, product and quotient of two single-precision numbers. This code
//! uses no other operation, so every platform computes the same.

use crate::units::{Feed, Length, MmPerSec, MmPerSec2, SpeedSq, Steps, SubTicks};

/// A time of less than 2^40 (16 s), in ticks times 2^16, as ticks.
pub(crate) fn ticks(time: SubTicks) -> f32 {
    ((time.0 >> 8) as u32) as f32 * const { 1.0 / 256.0 }
}

/// Ticks below 2^24 as a time in ticks times 2^16.
pub(crate) fn time(ticks: f32) -> SubTicks {
    SubTicks(u64::from((ticks * 256.0) as u32) << 8)
}

/// Ticks of any number as a time in ticks times 2^16.
#[inline(always)]
pub(crate) fn long_time(ticks: f32) -> SubTicks {
    SubTicks(to_bits(ticks * const { 1.0 / 65536.0 }))
}

/// A distance in steps, exact to 2^-24 of its value. A number and its negative have the same digits, so that mirrored
/// motors mirror each other to the tick.
#[inline(always)]
pub(crate) fn to_f32(steps: Steps) -> f32 {
    let bits = steps.to_bits();
    let size = bits.unsigned_abs();
    let size = ((size >> 32) as u32) as f32 + ((size as u32) as f32) * const { 1.0 / 4_294_967_296.0 };
    if bits < 0 { -size } else { size }
}

/// A distance below 2^31 steps.
#[inline(always)]
pub(crate) fn from_f32(steps: f32) -> Steps {
    let whole = steps as i32;
    let part = ((steps - whole as f32) * 2_147_483_648.0) as i32;
    Steps::from_bits((i64::from(whole) << 32) + (i64::from(part) << 1))
}

/// Square root, exact except for the last bit; 0 for a negative number. The first guess halves the exponent and is
/// wrong by 3.5 % at most; each Newton step squares this error.
pub(crate) fn root(square: f32) -> f32 {
    root_in_place(square)
}

/// The same for a loop, without a call.
#[inline(always)]
pub(crate) fn root_in_place(square: f32) -> f32 {
    if square <= 0.0 {
        return 0.0;
    }
    // Written out, because firmware is compiled for size, which does not unroll loops.
    let root = f32::from_bits((square.to_bits() >> 1) + 0x1FBD_1DF5);
    let root = 0.5 * (root + square / root);
    let root = 0.5 * (root + square / root);
    0.5 * (root + square / root)
}

/// Square root of a 64-bit square in 32 bits, wrong by at most one in the last bit.
pub(crate) fn root_of(square: u64) -> u32 {
    if square == 0 {
        return 0;
    }
    let shift = square.leading_zeros() & !1;
    large_root(square << shift) >> (shift / 2)
}

/// The same for a square of at least 2^60. A Newton step in integers corrects the error of single precision.
pub(crate) fn large_root(square: u64) -> u32 {
    let guess = root(((square >> 32) as u32) as f32);
    let whole = (guess * 65536.0) as u32;
    let remainder = square.wrapping_sub(u64::from(whole) * u64::from(whole)) as i64;
    let correction = ((remainder >> 16) as i32) as f32 / (guess + guess);
    whole.saturating_add_signed(correction as i32)
}

/// A length in mm.
pub(crate) fn mm(length: Length) -> f32 {
    from_bits(length.0)
}

/// A length of so many mm.
#[inline(always)]
pub(crate) fn length_of(mm: f32) -> Length {
    Length(to_bits(mm))
}

/// The square of a speed, in mm2/s2.
pub(crate) fn square(speed_sq: SpeedSq) -> f32 {
    from_bits(speed_sq.0)
}

/// A square of a speed of so many mm2/s2.
pub(crate) fn speed_sq(square: f32) -> SpeedSq {
    SpeedSq(to_bits(square))
}

/// A value with 32 fractional bits, as a number.
#[inline(always)]
fn from_bits(bits: u64) -> f32 {
    ((bits >> 32) as u32) as f32 + ((bits as u32) as f32) * const { 1.0 / 4_294_967_296.0 }
}

/// A non-negative number with 32 fractional bits. Saturates, also for NaN.
#[inline(always)]
fn to_bits(number: f32) -> u64 {
    const MOST: f32 = 4_294_967_296.0;
    if number < MOST {
        // Both differences and products are exact.
        let whole = number as u32;
        u64::from(whole) << 32 | u64::from(((number - whole as f32) * MOST) as u32)
    } else {
        u64::MAX
    }
}

/// A speed in mm/s.
pub(crate) fn speed(v: MmPerSec) -> f32 {
    v.to_bits() as f32 * const { 1.0 / 65536.0 }
}

/// The speed of a feed in mm/s.
pub(crate) fn feed_speed(feed: Feed) -> f32 {
    feed.to_bits() as f32 * const { 1.0 / (1u32 << Feed::FRAC_NBITS) as f32 }
}

/// The feed of so many mm/s, within the range.
pub(crate) fn feed_of(speed: f32) -> Feed {
    Feed::from_bits((speed * const { (1u32 << Feed::FRAC_NBITS) as f32 }) as u32)
}

/// An acceleration in mm/s2.
pub(crate) fn acceleration(a: MmPerSec2) -> f32 {
    a.to_bits() as f32 * const { 1.0 / 256.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_exact_to_the_last_bit_but_one() {
        for i in 1..100_000u32 {
            for square in [i as f32 * 1e-9, i as f32 * 0.37, i as f32 * 1e9] {
                let (root, exact) = (root(square), f64::from(square).sqrt());
                assert!((f64::from(root) / exact - 1.0).abs() < 1.3e-7, "{square}: {root} {exact}");
            }
        }
        assert_eq!(root(0.0), 0.0);
    }

    #[test]
    fn roots_of_squares_have_32_bits() {
        for i in 0..64 {
            for square in [1u64 << i, (1u64 << i) - 1, u64::MAX >> i, 0xC0FF_EE00_1234_5678 >> i] {
                let exact = (square as f64).sqrt();
                let tolerance = 1.0 + exact * 3e-10;
                assert!(
                    (f64::from(root_of(square)) - exact).abs() <= tolerance,
                    "{square}: {} {exact}",
                    root_of(square)
                );
            }
        }
    }

    #[test]
    fn bits_survive_both_ways() {
        for bits in [0, 1, 1 << 20, 1 << 32, 0xFF_FFFF << 30, 3 << 60] {
            assert_eq!(to_bits(from_bits(bits)), bits);
        }
        // The first value that is too large, and the last that fits.
        assert_eq!(to_bits(4_294_967_296.0), u64::MAX);
        assert_eq!(to_bits(4_294_967_040.0), 4_294_967_040 << 32);
        assert_eq!(to_bits(f32::INFINITY), u64::MAX);
        assert_eq!(to_bits(-1.0), 0);
        assert_eq!(to_bits(f32::NAN), u64::MAX);
    }

    #[test]
    fn distances_survive_both_ways() {
        for v in [0.0f64, 0.25, -0.25, 1.0, -1.0, 4095.999, -4095.999, 33_000.5, -0.000_01] {
            let steps = Steps::from_num(v);
            let tolerance = 1.2e-7 * f64::max(v.abs(), 1.0);
            assert!((f64::from(to_f32(steps)) - v).abs() <= tolerance, "{v}");
            assert!((from_f32(to_f32(steps)).to_num::<f64>() - v).abs() <= tolerance, "{v}");
        }
    }

    #[test]
    fn times_survive_both_ways() {
        for ticks_ in [0.0, 0.5, 1234.25, 524_287.0] {
            assert_eq!(ticks(time(ticks_)), ticks_);
        }
    }
}
