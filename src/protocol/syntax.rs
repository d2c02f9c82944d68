//! Syntax: the part of a line that this room reads. It is the line number, the few M-codes of this room, and the
//! presence of a checksum.

use crate::text;

/// Space or tab.
pub(super) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// `text` without leading blanks.
pub(super) fn skip_blanks(text: &[u8]) -> &[u8] {
    text::trim_start(text, is_blank)
}

/// `text` without trailing blanks.
pub(super) fn trim_end(text: &[u8]) -> &[u8] {
    text::trim_end(text, is_blank)
}

/// The line number at the beginning of `text` (`N12`, `n -1`), and the text after it. A number beyond 32 bits
/// saturates.
pub(super) fn line_number(text: &[u8]) -> Option<(i32, &[u8])> {
    let [b'N' | b'n', after @ ..] = text else {
        return None;
    };
    let after = skip_blanks(after);
    let (is_negative, digits) = match after {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        _ => (false, after),
    };
    let mut number = 0i32;
    let mut after = digits;
    while let [digit @ b'0'..=b'9', tail @ ..] = after {
        let digit = i32::from(digit - b'0');
        number = number.saturating_mul(10);
        number = if is_negative { number.saturating_sub(digit) } else { number.saturating_add(digit) };
        after = tail;
    }
    if after.len() == digits.len() { None } else { Some((number, after)) }
}

/// The number of the M-code at the beginning of `text`, and the text after it.
///
/// `None` for M110.1 and M110_X, which are other commands.
pub(super) fn m_code(text: &[u8]) -> Option<(u16, &[u8])> {
    let [b'M' | b'm', after @ ..] = skip_blanks(text) else {
        return None;
    };
    let digits = skip_blanks(after);
    let (number, after) = text::read_digits(digits);
    if after.len() == digits.len() || matches!(after, [b'.' | b'_', ..]) {
        return None;
    }
    Some((number, after))
}

/// The first N word of M110's parameters.
pub(super) fn find_line_number(mut text: &[u8]) -> Option<i32> {
    while let [_, after @ ..] = text {
        if let Some((number, _)) = line_number(text) {
            return Some(number);
        }
        text = after;
    }
    None
}

/// Whether `text` ends like a line with a checksum: a `*`, digits, blanks.
pub(super) fn ends_in_checksum(text: &[u8]) -> bool {
    let mut after = trim_end(text);
    let length = after.len();
    while let [head @ .., b'0'..=b'9'] = after {
        after = head;
    }
    after.len() < length && matches!(trim_end(after), [.., b'*'])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_numbers_are_signed_and_never_overflow() {
        assert_eq!(line_number(b"N12 G1"), Some((12, &b" G1"[..])));
        assert_eq!(line_number(b"n -1 M110"), Some((-1, &b" M110"[..])));
        assert_eq!(line_number(b"N+5 G1"), Some((5, &b" G1"[..])));
        assert_eq!(line_number(b"N1000001G1"), Some((1_000_001, &b"G1"[..])));
        assert_eq!(line_number(b"N99999999999"), Some((i32::MAX, &b""[..])));
        assert_eq!(line_number(b"N-99999999999"), Some((i32::MIN, &b""[..])));
        for text in ["N", "N-", "N+", "N+-1", "NOZZLE", "12", ""] {
            assert_eq!(line_number(text.as_bytes()), None);
        }
    }

    #[test]
    fn m_codes_end_where_their_digits_end() {
        assert_eq!(m_code(b"M110 N5"), Some((110, &b" N5"[..])));
        assert_eq!(m_code(b" m 110N5"), Some((110, &b"N5"[..])));
        assert_eq!(m_code(b"M1105"), Some((1105, &b""[..])));
        for text in ["M", "M.1", "M110.1", "M110_X", "G110", ""] {
            assert_eq!(m_code(text.as_bytes()), None);
        }
    }

    #[test]
    fn a_checksum_is_recognised_from_its_end() {
        for text in ["G1*5", "X5 *  34  ", "*1"] {
            assert!(ends_in_checksum(text.as_bytes()), "{text}");
        }
        for text in ["G1", "G1*", "5", "", "*5x", "**"] {
            assert!(!ends_in_checksum(text.as_bytes()), "{text}");
        }
    }
}
