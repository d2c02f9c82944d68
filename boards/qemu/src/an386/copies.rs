//! Checks copies, fills and comparisons of memory (`copies` of chips/cortex-m4) at each length and alignment. The bytes
//! that they should give are found one by one.

use core::hint::black_box;
use semihosting::process;

use super::fault::give_up;

/// The word on the command line that asks for the check in place of a run.
pub const ASKED: &str = "check-copies";

/// Longer than three turns of the longest loop, of 16 bytes.
const LONGEST: usize = 60;
/// Room around the bytes, in which nothing may change.
const ROOM: usize = LONGEST + 24;

type Bytes = [u8; ROOM];

/// Checks all of them, and ends the run.
pub fn check() -> ! {
    for length in 0..=LONGEST {
        for to in 0..4 {
            for from in 0..4 {
                check_copy(length, to, from);
                check_comparison(length, to, from);
            }
            check_fill(length, to);
            (0..=20).for_each(|from| check_move(length, to + 8, from));
        }
    }
    process::exit(0)
}

fn numbered(first: u8) -> Bytes {
    let mut bytes = [0; ROOM];
    for (n, byte) in bytes.iter_mut().enumerate() {
        *byte = black_box(n as u8).wrapping_add(first);
    }
    bytes
}

fn expect(is_right: bool, what: &str, numbers: [usize; 3]) {
    if !is_right {
        give_up(format_args!("{what} is wrong with {numbers:?}"));
    }
}

/// Whether each byte is as it should be, without a comparison of memory.
fn is_equal(bytes: &Bytes, should_be: impl Fn(usize) -> u8) -> bool {
    (0..ROOM).all(|n| black_box(bytes[n]) == should_be(n))
}

fn check_copy(length: usize, to: usize, from: usize) {
    let (source, old) = (numbered(0), numbered(100));
    let mut bytes = old;
    black_box(&mut bytes)[to..to + length].copy_from_slice(&black_box(&source)[from..from + length]);
    let should_be = |n: usize| if (to..to + length).contains(&n) { source[n - to + from] } else { old[n] };
    expect(is_equal(&bytes, should_be), "a copy", [length, to, from]);
}

fn check_move(length: usize, to: usize, from: usize) {
    let old = numbered(0);
    let mut bytes = old;
    black_box(&mut bytes).copy_within(from..black_box(from + length), to);
    let should_be = |n: usize| if (to..to + length).contains(&n) { old[n - to + from] } else { old[n] };
    expect(is_equal(&bytes, should_be), "a move", [length, to, from]);
}

fn check_fill(length: usize, to: usize) {
    for value in [0, 0xA5] {
        let old = numbered(100);
        let mut bytes = old;
        black_box(&mut bytes)[to..to + length].fill(black_box(value));
        let should_be = |n: usize| if (to..to + length).contains(&n) { value } else { old[n] };
        expect(is_equal(&bytes, should_be), "a fill", [length, to, usize::from(value)]);
    }
}

fn check_comparison(length: usize, left: usize, right: usize) {
    let source = numbered(0);
    let (mut one, mut other) = ([0; ROOM], [0; ROOM]);
    for n in 0..length {
        one[left + n] = black_box(source[n]);
        other[right + n] = black_box(source[n]);
    }
    // What follows the bytes differs, and does not count.
    one[left + length] = 1;
    let is_ordered = |one: &Bytes, other: &Bytes, order| {
        let (one, other) = (&black_box(one)[left..left + length], &black_box(other)[right..right + length]);
        one.cmp(other) == order && (one == other) == order.is_eq()
    };
    expect(is_ordered(&one, &other, core::cmp::Ordering::Equal), "a comparison", [length, left, right]);
    for n in 0..length {
        let before = other[right + n];
        other[right + n] = 200;
        // A later byte that differs the other way does not count.
        one[left + length - 1] = one[left + length - 1].max(if n + 1 < length { 255 } else { 0 });
        expect(is_ordered(&one, &other, core::cmp::Ordering::Less), "a comparison", [length, left, n]);
        one[left + length - 1] = source[length - 1];
        other[right + n] = before;
    }
}
