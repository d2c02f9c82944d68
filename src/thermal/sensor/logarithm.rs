//! The binary logarithm in fixed point: squared again and again, a number tells its logarithm bit by bit (D. E. Knuth, The
//! Art of Computer Programming, 1.2.2, exercise 25).

/// Fractional bits of a logarithm.
pub(super) const FRACTION: u32 = 26;

/// Fractional bits that are found; the others are 0. Four millionths of a resistance are less than a thousandth of a degree.
const FOUND: u32 = 18;

/// Logarithm to base 2 of a number that is not 0, with [`FRACTION`] fractional bits; right to 4 millionths.
pub(super) const fn log2(number: u32) -> i64 {
    let whole = 31 - number.leading_zeros();
    // Between 1 and 2, with 31 fractional bits.
    let mut rest = number << (31 - whole);
    let mut log = whole;
    let mut bit = 0;
    while bit < FOUND {
        // Words by themselves: a shift of 64 bits by a number is a call.
        let square = rest as u64 * rest as u64;
        let (upper, lower) = ((square >> 32) as u32, square as u32);
        let is_two = upper >> 31;
        rest = if is_two == 1 { upper } else { upper << 1 | lower >> 31 };
        log = log << 1 | is_two;
        bit += 1;
    }
    (log << (FRACTION - FOUND)) as i64
}

/// The natural logarithm of 2, with 32 fractional bits.
const LN_2: i64 = 2_977_044_472;

/// Natural logarithm of what has this logarithm to base 2; both with [`FRACTION`] fractional bits.
pub(super) const fn natural(log2: i64) -> i64 {
    (log2 * LN_2) >> 32
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn logarithms_are_those_of_floating_point() {
        let one = f64::from(1u32 << FRACTION);
        for number in [1, 2, 3, 1000, 4700, 65_535, 1 << 30, 3_000_000_000, u32::MAX] {
            let wanted = f64::from(number).log2();
            assert!((log2(number) as f64 / one - wanted).abs() < 4e-6, "{number}");
            let wanted = f64::from(number).ln();
            assert!((natural(log2(number)) as f64 / one - wanted).abs() < 4e-6, "{number}");
        }
    }
}
