//! Small words: just enough G-code to know a line number and the few M-codes that this room acts on.

/// Space or tab.
pub(super) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// `text` without the blanks it begins with.
pub(super) fn skip_blanks(mut text: &[u8]) -> &[u8] {
    while let [byte, rest @ ..] = text
        && is_blank(*byte)
    {
        text = rest;
    }
    text
}

/// `text` without the blanks it ends with.
pub(super) fn trim_end(mut text: &[u8]) -> &[u8] {
    while let [rest @ .., byte] = text
        && is_blank(*byte)
    {
        text = rest;
    }
    text
}

/// The line number that `text` begins with (`N12`, `n -1`), and the text behind it.
/// A number that 32 bits cannot hold saturates.
pub(super) fn line_number(text: &[u8]) -> Option<(i32, &[u8])> {
    let [b'N' | b'n', rest @ ..] = text else {
        return None;
    };
    let rest = skip_blanks(rest);
    let (is_negative, digits) = match rest {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        _ => (false, rest),
    };
    let mut number = 0i32;
    let mut rest = digits;
    while let [digit @ b'0'..=b'9', tail @ ..] = rest {
        let digit = i32::from(digit - b'0');
        number = number.saturating_mul(10);
        number = if is_negative { number.saturating_sub(digit) } else { number.saturating_add(digit) };
        rest = tail;
    }
    if rest.len() == digits.len() { None } else { Some((number, rest)) }
}

/// The number of the M-code that `text` begins with, and the text behind it.
///
/// `None` for M110.1 and M110_X, which are other commands.
pub(super) fn m_code(text: &[u8]) -> Option<(u16, &[u8])> {
    let [b'M' | b'm', rest @ ..] = skip_blanks(text) else {
        return None;
    };
    let digits = skip_blanks(rest);
    let mut number = 0u16;
    let mut rest = digits;
    while let [digit @ b'0'..=b'9', tail @ ..] = rest {
        number = number.saturating_mul(10).saturating_add(u16::from(digit - b'0'));
        rest = tail;
    }
    if rest.len() == digits.len() || matches!(rest, [b'.' | b'_', ..]) {
        return None;
    }
    Some((number, rest))
}

/// The first N word of M110's parameters.
pub(super) fn find_line_number(mut text: &[u8]) -> Option<i32> {
    while let [_, rest @ ..] = text {
        if let Some((number, _)) = line_number(text) {
            return Some(number);
        }
        text = rest;
    }
    None
}

/// Whether `text` ends as a checksummed line does: a `*`, digits, blanks.
pub(super) fn ends_in_checksum(text: &[u8]) -> bool {
    let mut rest = trim_end(text);
    let length = rest.len();
    while let [head @ .., b'0'..=b'9'] = rest {
        rest = head;
    }
    rest.len() < length && matches!(trim_end(rest), [.., b'*'])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_numbers_are_signed_and_never_overflow() {
        assert_eq!(line_number(b"N12 G1"), Some((12, &b" G1"[..])));
        assert_eq!(line_number(b"n -1 M110"), Some((-1, &b" M110"[..])));
        assert_eq!(line_number(b"N1000001G1"), Some((1_000_001, &b"G1"[..])));
        assert_eq!(line_number(b"N99999999999"), Some((i32::MAX, &b""[..])));
        assert_eq!(line_number(b"N-99999999999"), Some((i32::MIN, &b""[..])));
        for text in ["N", "N-", "NOZZLE", "12", ""] {
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
    fn a_checksum_is_recognised_from_behind() {
        for text in ["G1*5", "X5 *  34  ", "*1"] {
            assert!(ends_in_checksum(text.as_bytes()), "{text}");
        }
        for text in ["G1", "G1*", "5", "", "*5x", "**"] {
            assert!(!ends_in_checksum(text.as_bytes()), "{text}");
        }
    }
}
