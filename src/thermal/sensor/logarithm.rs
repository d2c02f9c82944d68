//! The binary logarithm in fixed point: a table gives it for a number near by, and two terms of the series add the
//! distance from that.

/// Fractional bits of a logarithm.
pub(super) const FRACTION: u32 = 26;

/// Bits of a number that select a row of the table. The third term of the series is then less than 2 millionths, which
/// is less than a thousandth of a degree.
const ROW: u32 = 5;

/// Reciprocals of the middles of the rows, with 32 fractional bits, and their negated logarithms.
const TABLE: [(u32, i32); 1 << ROW] = {
    let mut table = [(0, 0); 1 << ROW];
    let mut row = 0;
    while row < 1 << ROW {
        let middle = (1 << ROW) + row as u64;
        let reciprocal = ((1u64 << (33 + ROW)) / (2 * middle + 1)) as u32;
        table[row] = (reciprocal, ((32 << FRACTION) - by_squaring(reciprocal)) as i32);
        row += 1;
    }
    table
};

/// 1/ln 2, with 30 fractional bits.
const PER_LN_2: i64 = 1_549_082_005;

/// Logarithm to base 2 of a number above 0, with [`FRACTION`] fractional bits; right to 2 millionths.
pub(super) const fn log2(number: u32) -> i64 {
    let zeros = number.leading_zeros();
    // Between 1 and 2, with 31 fractional bits.
    let mantissa = number << zeros;
    let (reciprocal, log) = TABLE[(mantissa >> (31 - ROW)) as usize & ((1 << ROW) - 1)];
    // Distance from the middle of its row, as a fraction of it, with 31 fractional bits: 1/64 at most.
    let beyond = (((mantissa as u64 * reciprocal as u64) >> 32) as u32).wrapping_sub(1 << 31) as i32;
    let square = ((beyond as i64 * beyond as i64) >> 32) as i32;
    let rest = ((beyond - square) as i64 * PER_LN_2) >> (61 - FRACTION);
    (((31 - zeros) as i64) << FRACTION) + log as i64 + rest
}

/// The same bit by bit, by repeated squaring (D. E. Knuth, The Art of Computer Programming, 1.2.2, exercise 25).
const fn by_squaring(number: u32) -> i64 {
    let whole = number.ilog2();
    let mut rest = (number << (31 - whole)) as u64;
    let mut log = whole as i64;
    let mut bit = 0;
    while bit < FRACTION {
        rest = (rest * rest) >> 31;
        let is_two = rest >> 32;
        rest >>= is_two;
        log = log << 1 | is_two as i64;
        bit += 1;
    }
    log
}

/// The natural logarithm of 2, with 32 fractional bits.
const LN_2: i64 = 2_977_044_472;

/// Natural logarithm from the logarithm to base 2; both with [`FRACTION`] fractional bits.
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
        let rows = (0..=u16::MAX).map(|upper| 1 << 31 | u32::from(upper) << 15);
        let edges = rows.clone().map(|number| number - 1);
        for number in rows.chain(edges).chain([1, 2, 3, 1000, 4700, 65_535, 1 << 30, 3_000_000_000, u32::MAX]) {
            let wanted = f64::from(number).log2();
            assert!((log2(number) as f64 / one - wanted).abs() < 2e-6, "{number}");
            let wanted = f64::from(number).ln();
            assert!((natural(log2(number)) as f64 / one - wanted).abs() < 2e-6, "{number}");
        }
    }
}
