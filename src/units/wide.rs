//! Integer arithmetic with all the bits in between: products before quotients, and roots.

/// Multiplies before it divides, with all the bits in between; saturates instead of wrapping and
/// treats a division by zero as infinite.
#[must_use]
pub const fn mul_div(a: u64, b: u64, divisor: u64) -> u64 {
    if divisor == 0 {
        return u64::MAX;
    }
    // The narrow path is the common one, and a 128-bit division costs a Cortex-M4 some thousand cycles.
    match a.checked_mul(b) {
        Some(product) => product / divisor,
        None => wide_mul_div(a, b, divisor),
    }
}

/// The wide path of [`mul_div`]: a product of 128 bits divided in two digits of 32 bits (D. E. Knuth, The Art of
/// Computer Programming, 4.3.1, algorithm D). Compilers for 32 bits expand such a division bit by bit at each use, 800
/// bytes of it.
#[cold]
#[inline(never)]
const fn wide_mul_div(a: u64, b: u64, divisor: u64) -> u64 {
    let product = a as u128 * b as u128;
    if (product >> 64) as u64 >= divisor {
        return u64::MAX;
    }
    // With its highest bit set, the divisor's upper half alone gives a digit to within two.
    let shift = divisor.leading_zeros();
    let (product, divisor) = (product << shift, divisor << shift);
    let (first, rest) = digit((product >> 64) as u64, (product >> 32) as u32, divisor);
    let (second, _) = digit(rest, product as u32, divisor);
    first << 32 | second
}

/// The number of times that `divisor` is contained in `rest` followed by `next`, and the remainder. `rest` is less than
/// `divisor`, and the highest bit of `divisor` is set.
const fn digit(rest: u64, next: u32, divisor: u64) -> (u64, u64) {
    let (upper, lower) = (divisor >> 32, divisor & 0xFFFF_FFFF);
    let (mut digit, mut left) = (rest / upper, rest % upper);
    // At most twice: the estimate is too great by two at most.
    while digit >> 32 != 0 || (left >> 32 == 0 && digit * lower > (left << 32 | next as u64)) {
        digit -= 1;
        left += upper;
    }
    (digit, (rest << 32 | next as u64).wrapping_sub(digit.wrapping_mul(divisor)))
}

/// The part `part / whole` of a value with a sign, cut off towards zero; saturates as [`mul_div`] does.
#[must_use]
#[inline(never)]
pub const fn part_of(value: i64, part: u64, whole: u64) -> i64 {
    let magnitude = mul_div(value.unsigned_abs(), part, whole);
    if value < 0 { 0i64.saturating_sub_unsigned(magnitude) } else { 0i64.saturating_add_unsigned(magnitude) }
}

/// The integer nearest to the square root. A root that is always cut short would make every speed a little
/// too small, and the error would add up over a print.
#[must_use]
pub const fn root(square: u64) -> u64 {
    let root = whole_root(square);
    if square - root * root > root { root + 1 } else { root }
}

/// The square root, cut off. Bit by bit from its highest on, because the standard library's takes 500 bytes.
#[must_use]
#[inline(never)]
pub const fn whole_root(square: u64) -> u64 {
    let (mut root, mut bit) = (0_u32, 1_u32 << ((square | 1).ilog2() / 2));
    while bit != 0 {
        let tried = root | bit;
        if tried as u64 * tried as u64 <= square {
            root = tried;
        }
        bit >>= 1;
    }
    root as u64
}

/// The square root of a square of 128 bits, cut off. Bit by bit, because the standard library's takes 1,400 bytes.
#[must_use]
#[inline(never)]
pub const fn wide_root(square: u128) -> u64 {
    let (mut rest, mut root, mut bit) = (square, 0, 1u128 << 126);
    while bit != 0 {
        let tried = root + bit;
        root >>= 1;
        if rest >= tried {
            rest -= tried;
            root += bit;
        }
        bit >>= 2;
    }
    root as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_the_nearest() {
        for (square, expected) in [(0, 0), (2, 1), (3, 2), (6, 2), (7, 3), (u64::MAX, 1 << 32)] {
            assert_eq!(root(square), expected);
        }
    }

    #[test]
    fn whole_roots_are_cut_off() {
        for shift in 0..64 {
            for near in -3..=3_i64 {
                let number = (1_u64 << shift).wrapping_add_signed(near);
                let number_sq = number.wrapping_mul(number);
                for square in [number, number_sq, number_sq.wrapping_sub(1), u64::MAX - number] {
                    assert_eq!(whole_root(square), square.isqrt(), "{square}");
                }
            }
        }
    }

    #[test]
    fn wide_roots_are_cut_off() {
        let edges = [0, 1, 2, 3, 4, 99, u64::MAX / 3, 1 << 32, (1 << 32) - 1, 1 << 63, u64::MAX - 1, u64::MAX];
        for root in edges.map(u128::from) {
            for square in [root * root, (root * root).saturating_sub(1), (root * root).saturating_add(2 * root)] {
                assert_eq!(u128::from(wide_root(square)), square.isqrt(), "{square}");
            }
        }
        assert_eq!(wide_root(u128::MAX), u64::MAX);
    }

    #[test]
    fn mul_div_keeps_every_bit_and_saturates() {
        assert_eq!(mul_div(u64::MAX, 6, 3), u64::MAX);
        assert_eq!(mul_div(u64::MAX / 2, 4, 8), u64::MAX / 4);
        assert_eq!(mul_div(7, 3, 2), 10);
        assert_eq!(mul_div(7, 3, 0), u64::MAX);
        // Digits that are estimated one and two too great at first, and a divisor of few bits.
        let edges = [1, 3, 0xFFFF_FFFF, 1 << 32, 0x8000_0000_0000_0001, 0x8000_0000_FFFF_FFFF, u64::MAX - 1, u64::MAX];
        for (a, b, divisor) in edges.iter().flat_map(|a| edges.iter().flat_map(|b| edges.map(|d| (*a, *b, d)))) {
            let exact = u128::from(a) * u128::from(b) / u128::from(divisor);
            assert_eq!(mul_div(a, b, divisor), u64::try_from(exact).unwrap_or(u64::MAX), "{a} {b} {divisor}");
        }
    }

    #[test]
    fn a_part_keeps_the_sign_and_is_cut_off_towards_zero() {
        for (value, part) in [(7, 4), (-7, -4), (i64::MAX, 5_534_023_222_112_865_484), (0, 0)] {
            assert_eq!(part_of(value, 3, 5), part);
        }
        assert_eq!(part_of(i64::MAX, 5, 3), i64::MAX);
        assert_eq!(part_of(i64::MIN, 5, 3), i64::MIN);
        assert_eq!(part_of(i64::MIN, 1, 1), i64::MIN);
    }
}
