//! Functions that IEEE 754 does not define to the last bit, with the same bits on every platform.
//!
//! The standard library takes sine, exponential and their relatives from the platform: glibc's differ from a browser's
//! in the last bits, and even between processors with and without fused multiplication. Here they come from the crate
//! `libm`, which is sums and products only. So a machine in a browser and in a terminal ends at the same place.
//!
//! Sums, products, quotients, square roots, remainders and rounding are exact anyway, and stay the language's. clippy
//! refuses the language's other functions in the crates that deny `clippy::disallowed_methods` (clippy.toml names
//! them). Matrices are held to the same rule by nalgebra's features (Cargo.toml).

pub use libm::{acos, asin, atan2, cos, exp, log as ln, log10, pow as powf, sin, sincos as sin_cos, tanh};

/// The length of a vector of two. For lengths, forces and speeds of machines: their squares neither overflow nor
/// vanish. So the guards of a general hypotenuse, which take three times as long, are left out.
#[must_use]
pub fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// x^2.
#[must_use]
pub const fn square(x: f64) -> f64 {
    x * x
}

/// x^n, by squares. The language leaves the order of the products open.
#[must_use]
pub fn powi(x: f64, n: i32) -> f64 {
    let (mut power, mut left, mut product) = (x, n.unsigned_abs(), 1.0);
    while left > 0 {
        if left & 1 == 1 {
            product *= power;
        }
        power *= power;
        left >>= 1;
    }
    if n < 0 { 1.0 / product } else { product }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bits are those of the correctly rounded values, from 60 decimal digits.
    #[test]
    fn functions_are_within_a_unit_in_the_last_place_of_the_true_values() {
        let values = [
            ("sin(0.6)", sin(0.6), 0x3fe2_118d_17a5_4159),
            ("sin(-1234.5)", sin(-1234.5), 0xbfc2_9c53_1dfd_031b),
            ("cos(2.5)", cos(2.5), 0xbfe9_a2f7_ef85_8b7d),
            ("tanh(0.15)", tanh(0.15), 0x3fc3_0eaa_2f23_5455),
            ("tanh(-3.0)", tanh(-3.0), 0xbfef_d77d_111a_0b00),
            ("exp(-2.3)", exp(-2.3), 0x3fb9_aa90_46ec_997c),
            ("ln(0.7)", ln(0.7), 0xbfd6_d3c3_24e1_3f50),
            ("log10(0.003)", log10(0.003), 0xc004_2edb_0d36_0540),
            ("powf(13.7, -0.5)", powf(13.7, -0.5), 0x3fd1_4a7d_e10c_d4ff),
            ("asin(0.9)", asin(0.9), 0x3ff1_ea93_705f_a172),
            ("acos(0.3)", acos(0.3), 0x3ff4_41f5_ecbe_ef59),
            ("atan2(-1.25, -0.5)", atan2(-1.25, -0.5), 0xbfff_3889_2f1e_0c88),
        ];
        for (call, got, bits) in values {
            let off = got.to_bits().abs_diff(bits);
            assert!(off <= 1, "{call}: {got:e} is {off} units from {:e}", f64::from_bits(bits));
        }
    }

    #[test]
    fn powers_are_those_of_repeated_products() {
        for (x, n, expected) in [
            (3.0, 0, 1.0),
            (3.0, 1, 3.0),
            (3.0, 7, 2187.0),
            (2.0, 32, 4_294_967_296.0),
            (2.0, -3, 0.125),
            (0.5, 5, 0.03125),
        ] {
            assert_eq!(powi(x, n).to_bits(), f64::to_bits(expected), "{x}^{n}");
        }
        assert_eq!(hypot(3.0, -4.0).to_bits(), 5.0_f64.to_bits());
    }
}
