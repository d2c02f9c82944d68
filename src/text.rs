//! Text: what `protocol` and `gcode` both do with bytes, taking blanks off and reading digits; and the short names of
//! motors and connectors (`short_name.rs`). And the texts of all rooms, packed (`packed.rs`).
//!
//! The caller says which characters are blanks. To `gcode` the no-break space that people copy from web pages is one.
//! To `protocol`, which trusts the text below a checksum, only space and tab are.

#[macro_use]
mod packed;
mod short_name;

pub use packed::{Packed, Text, put};
pub use short_name::{NameKind, ShortName};

/// `text` without the bytes at its beginning that `is_blank` likes.
#[inline(always)]
pub fn trim_start(mut text: &[u8], is_blank: impl Fn(u8) -> bool) -> &[u8] {
    while let [byte, after @ ..] = text
        && is_blank(*byte)
    {
        text = after;
    }
    text
}

/// `text` without the bytes at its end that `is_blank` likes.
#[inline(always)]
pub fn trim_end(mut text: &[u8], is_blank: impl Fn(u8) -> bool) -> &[u8] {
    while let [head @ .., byte] = text
        && is_blank(*byte)
    {
        text = head;
    }
    text
}

/// Whether `text` is this word, in large or small letters. Inlined, it would be repeated for every name of a value.
#[must_use]
#[inline(never)]
pub fn is_word(text: &[u8], word: &[u8]) -> bool {
    text.eq_ignore_ascii_case(word)
}

/// The number of the digits that `text` begins with, and the text after them. It saturates, and is 0 without a digit.
#[must_use]
#[inline]
pub fn read_digits(mut text: &[u8]) -> (u16, &[u8]) {
    let mut number = 0u16;
    while let [digit @ b'0'..=b'9', after @ ..] = text {
        number = number.saturating_mul(10).saturating_add(u16::from(digit - b'0'));
        text = after;
    }
    (number, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_are_what_the_caller_says() {
        let is_dot = |byte| byte == b'.';
        assert_eq!(trim_start(b"..a.b", is_dot), b"a.b");
        assert_eq!(trim_end(b"a.b..", is_dot), b"a.b");
        assert_eq!((trim_start(b"..", is_dot), trim_end(b"..", is_dot)), (&b""[..], &b""[..]));
    }

    #[test]
    fn digits_saturate_and_leave_what_follows() {
        assert_eq!(read_digits(b"0110N5"), (110, &b"N5"[..]));
        assert_eq!(read_digits(b"99999999"), (u16::MAX, &b""[..]));
        assert_eq!(read_digits(b"x1"), (0, &b"x1"[..]));
    }
}
