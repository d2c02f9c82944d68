//! Codes: the letter and the number that a command begins with.

use super::lexer::{is_blank, skip_blanks};
use crate::text::read_digits;

/// A command's name, such as G1 or M862.3.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Code {
    /// G, M or T.
    pub letter: u8,
    /// The number after the letter.
    pub number: u16,
    /// The number after the point; 0 if there is none.
    pub subcode: u16,
}

impl Code {
    /// Reads the code that `text` begins with, and returns it with the text after it.
    ///
    /// `None` for anything else, above all for the named commands of Klipper. They may begin with the same letters,
    /// even with the same digits (`T0_PARK`), so a blank, a word or a comment must follow a code.
    pub(super) fn read(text: &[u8]) -> Option<(Self, &[u8])> {
        let (letter, after) = skip_blanks(text).split_first()?;
        let letter = letter.to_ascii_uppercase();
        if !matches!(letter, b'G' | b'M' | b'T') {
            return None;
        }
        let digits = skip_blanks(after);
        let (number, mut after) = read_digits(digits);
        if after.len() == digits.len() {
            return None;
        }
        let mut subcode = 0;
        if let [b'.', tail @ ..] = after {
            (subcode, after) = read_digits(tail);
        }
        let ends = |byte: u8| is_blank(byte) || byte.is_ascii_alphabetic() || matches!(byte, b';' | b'(' | b'"');
        after.first().is_none_or(|byte| ends(*byte)).then_some((Self { letter, number, subcode }, after))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(text: &str) -> Option<(char, u16, u16)> {
        Code::read(text.as_bytes()).map(|(code, _)| (code.letter as char, code.number, code.subcode))
    }

    #[test]
    fn a_code_is_a_letter_and_a_number() {
        assert_eq!(code("G1"), Some(('G', 1, 0)));
        assert_eq!(code(" g 01X5"), Some(('G', 1, 0)));
        assert_eq!(code("M862.3 P\"MK4S\""), Some(('M', 862, 3)));
        assert_eq!(code("T0;x"), Some(('T', 0, 0)));
        assert_eq!(code("G99999999"), Some(('G', u16::MAX, 0)));
    }

    #[test]
    fn names_are_not_codes() {
        for text in ["", "T", "Tx", "print_end", "T0_PARK", "M=5", "G-1", "X5", "%", "/G1", "G1*34", "M.5"] {
            assert_eq!(code(text), None, "{text}");
        }
    }
}
