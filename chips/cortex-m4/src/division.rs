//! Division of 64 bits, as the compiler calls it.
//!
//! It stands in for the division of `compiler_builtins`, a weak symbol of 0.9 KB. That one is made for processors
//! without a division. This one divides 32 bits in at most 12 cycles (ARM DDI 0439D, table of instructions).

use core::num::NonZero;

/// The quotient and the remainder of 64 bits. Nothing is divided by 0: callers look first.
const fn divide(n: u64, d: u64) -> (u64, u64) {
    let (high, low) = (upper(n), n as u32);
    if upper(d) == 0 {
        let Some(d) = NonZero::new(d as u32) else { return (0, n) };
        let top = high / d.get();
        let (bottom, rest) = divide_long(high - top * d.get(), low, d);
        return ((top as u64) << 32 | bottom as u64, rest as u64);
    }
    // Warren, Hacker's Delight, 2nd edition, figure 9-5: the quotient by the top 32 bits of the divisor is the true one
    // or one more. One less is thus the true one or one less.
    let shift = upper(d).leading_zeros();
    let Some(top) = NonZero::new(shifted(upper(d), d as u32, shift)) else { return (0, n) };
    let (estimate, _) = divide_long(high >> 1, high << 31 | low >> 1, top);
    let quotient = (estimate >> (31 - shift)).saturating_sub(1) as u64;
    let rest = n.wrapping_sub(quotient.wrapping_mul(d));
    if rest >= d { (quotient + 1, rest - d) } else { (quotient, rest) }
}

/// The quotient and the remainder of `high` and `low` together by `d`, which is above `high`: two digits of 16 bits in
/// long division (Knuth, The Art of Computer Programming, volume 2, 4.3.1, algorithm D).
#[inline(never)]
const fn divide_long(high: u32, low: u32, d: NonZero<u32>) -> (u32, u32) {
    if high == 0 {
        return (low / d.get(), low % d.get());
    }
    let shift = d.leading_zeros();
    let (d, high, low) = (d.get() << shift, shifted(high, low, shift), low << shift);
    let (digit, rest) = next_digit(high, low >> 16, d);
    let (last, rest) = next_digit(rest, low & 0xFFFF, d);
    (digit << 16 | last, rest >> shift)
}

/// The next digit of a quotient and the rest, after `rest` before it and the digit `next` of the dividend. The highest
/// bit of `d` is set, so a quotient by the upper half of `d` is at most two too large.
#[inline(always)]
const fn next_digit(rest: u32, next: u32, d: u32) -> (u32, u32) {
    // With its highest bit named the compiler sees that it is not 0.
    let mut digit = rest / (d >> 16 | 0x8000);
    let mut product = digit as u64 * d as u64;
    let whole = (rest as u64) << 16 | next as u64;
    while product > whole {
        digit -= 1;
        product -= d as u64;
    }
    (digit, (whole - product) as u32)
}

/// The upper half of `high` and `low` together after a shift to the left by less than 32, in registers of 32 bits.
const fn shifted(high: u32, low: u32, shift: u32) -> u32 {
    high << shift | low >> 1 >> (31 - shift)
}

const fn upper(n: u64) -> u32 {
    (n >> 32) as u32
}

/// Gives the quotient of absolute values and the rest their signs: the quotient is rounded towards zero, the rest has
/// the sign of the dividend.
const fn with_signs(n: i64, d: i64, (quotient, rest): (u64, u64)) -> (i64, i64) {
    let (quotient, rest) = (quotient.cast_signed(), rest.cast_signed());
    (if n ^ d < 0 { quotient.wrapping_neg() } else { quotient }, if n < 0 { rest.wrapping_neg() } else { rest })
}

/// What the functions of the ARM run-time ABI for division call (IHI 0043, 5.3.1): the quotient.
#[cfg(target_os = "none")]
mod called {
    use super::{divide, with_signs};

    // SAFETY: the name, the arguments and the results are those of `compiler_builtins`.
    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "C" fn __udivmoddi4(n: u64, d: u64, remainder: &mut u64) -> u64 {
        let (quotient, rest) = divide(n, d);
        *remainder = rest;
        quotient
    }

    // SAFETY: as above.
    #[unsafe(no_mangle)]
    extern "C" fn __divmoddi4(n: i64, d: i64, remainder: &mut i64) -> i64 {
        let mut rest = 0;
        let quotient = __udivmoddi4(n.unsigned_abs(), d.unsigned_abs(), &mut rest);
        let (quotient, rest) = with_signs(n, d, (quotient, rest));
        *remainder = rest;
        quotient
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Numbers of any length: those with few bits, with many, and those around a power of two.
    fn number() -> impl Strategy<Value = u64> {
        (any::<u64>(), 0..64_u32, 0..64_u32, any::<bool>()).prop_map(|(bits, right, near, is_near)| {
            if is_near { (1_u64 << near).wrapping_add(bits % 5).wrapping_sub(2) } else { bits >> right }
        })
    }

    fn check(n: u64, d: u64) {
        assert_eq!(divide(n, d), (n / d, n % d), "{n:#x} / {d:#x}");
        let (n, d) = (n.cast_signed(), d.cast_signed());
        let unsigned = divide(n.unsigned_abs(), d.unsigned_abs());
        assert_eq!(with_signs(n, d, unsigned), (n.wrapping_div(d), n.wrapping_rem(d)), "{n} / {d}");
    }

    #[test]
    fn extremes_are_divided_as_the_processor_of_this_computer_does() {
        let edges = [1, 2, 3, 0xFFFF, 0x1_0000, 0x1_0001, 0x7FFF_FFFF, 0x8000_0000, 0x8000_FFFF, 0xFFFF_FFFF];
        let low = edges.into_iter().chain([0]);
        let all = || low.clone().flat_map(|high| low.clone().map(move |low| high << 32 | low));
        for n in all() {
            all().filter(|d| *d != 0).for_each(|d| check(n, d));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn any_numbers_are_divided_as_the_processor_of_this_computer_does(n in number(), d in number()) {
            prop_assume!(d != 0);
            check(n, d);
        }
    }
}
