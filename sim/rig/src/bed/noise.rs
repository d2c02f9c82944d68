//! Noise that repeats: the n-th number of a seed, whatever was asked before.

use core::f64::consts::TAU;

/// SplitMix64 of seed and count (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014).
const fn bits(seed: u64, count: u64) -> u64 {
    let mut z = seed.wrapping_add(count.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ z >> 31
}

/// Above 0, at most 1.
fn unit(seed: u64, count: u64) -> f64 {
    ((bits(seed, count) >> 11) as f64 + 1.0) / (1_u64 << 53) as f64
}

/// The `count`-th number of a normal distribution with a sigma of 1 (Box and Muller, 1958).
#[must_use]
pub fn normal(seed: u64, count: u64) -> f64 {
    let (radius, angle) = (unit(seed, 2 * count), unit(seed, 2 * count + 1));
    libm::sqrt(-2.0 * libm::log(radius)) * libm::cos(TAU * angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_a_mean_of_0_and_a_sigma_of_1_and_repeats() {
        let n = 10_000;
        let (sum, squares) = (0..n).map(|count| normal(7, count)).fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
        assert!((sum / n as f64).abs() < 0.03, "{sum}");
        assert!((squares / n as f64 - 1.0).abs() < 0.05, "{squares}");
        assert_eq!(normal(7, 3), normal(7, 3));
        assert_ne!(normal(7, 3), normal(8, 3));
    }
}
