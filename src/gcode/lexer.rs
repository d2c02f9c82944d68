//! Words: a letter, perhaps with a number, and everything that people write round it.
//!
//! Spaces are optional everywhere, also between a letter and its number. A word keeps the characters of
//! numbers that are glued to it (`U6.2.6+8948` is U6.2), other glued characters are skipped up to the next
//! blank. That something was skipped is noted, and most commands are then not carried out (`grammar.rs`).
//! Comments are `;` to the end and `( )`.

use super::number::Number;
use crate::text;

/// One word of a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Word<'a> {
    /// The letter in upper case.
    pub letter: u8,
    /// The number, if the word is more than a flag.
    pub number: Option<Number>,
    /// The text in quotes that stands where a number might.
    pub quoted: Option<&'a [u8]>,
}

/// The words of a text, in order.
#[derive(Clone, Debug)]
pub(super) struct Words<'a> {
    remaining: &'a [u8],
    has_skipped: bool,
}

impl<'a> Words<'a> {
    /// The words of `text`, which begins after the command's code.
    pub(super) const fn new(text: &'a [u8]) -> Self {
        Self { remaining: text, has_skipped: false }
    }

    /// Whether something among the words so far was neither a word nor a comment.
    pub(super) const fn has_skipped(&self) -> bool {
        self.has_skipped
    }

    /// The text after the words so far.
    pub(super) const fn remaining(&self) -> &'a [u8] {
        self.remaining
    }
}

/// Space, tab, or a byte of a no-break space (U+00A0), which people copy from web pages.
pub(super) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0xC2 | 0xA0)
}

/// Whether a byte at the end of a line does not belong to it: a blank or a line end.
pub(super) const fn is_outside(byte: u8) -> bool {
    is_blank(byte) || matches!(byte, b'\r' | b'\n')
}

/// `text` without the blanks it begins with.
pub(super) fn skip_blanks(text: &[u8]) -> &[u8] {
    text::trim_start(text, is_blank)
}

/// `text` from the first byte on that `is_end` likes; empty if there is none.
fn skip_until(text: &[u8], is_end: impl Fn(u8) -> bool) -> &[u8] {
    let end = text.iter().position(|&byte| is_end(byte));
    end.and_then(|end| text.get(end..)).unwrap_or_default()
}

/// The text after the next `end`; empty if there is none.
pub(super) fn skip_past(text: &[u8], end: u8) -> &[u8] {
    let after = skip_until(text, |byte| byte == end);
    after.get(1..).unwrap_or_default()
}

/// Whether a byte may stand directly after a number: a blank, or what begins something else.
const fn may_follow(byte: u8) -> bool {
    is_blank(byte) || byte.is_ascii_alphabetic() || matches!(byte, b';' | b'(' | b'"')
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        let letter = loop {
            let (&byte, tail) = self.remaining.split_first()?;
            // Small letters differ from capitals by this bit.
            let capital = byte & !0x20;
            if capital.is_ascii_uppercase() {
                self.remaining = tail;
                break capital;
            }
            self.remaining = match byte {
                byte if is_blank(byte) => tail,
                b';' => &[],
                b'(' => skip_past(tail, b')'),
                b'"' => self.skip_quoted(tail).1,
                _ => {
                    self.has_skipped = true;
                    skip_until(tail, |byte| is_blank(byte) || matches!(byte, b';' | b'(' | b'"'))
                }
            };
        };
        let value = skip_blanks(self.remaining);
        if let Some((number, after)) = Number::read(value) {
            self.has_skipped |= after.first().is_some_and(|byte| !may_follow(*byte));
            self.remaining = skip_number(after);
            return Some(Word { letter, number: Some(number), quoted: None });
        }
        if let [b'"', tail @ ..] = value {
            let (quoted, after) = self.skip_quoted(tail);
            self.remaining = after;
            return Some(Word { letter, number: None, quoted: Some(quoted) });
        }
        let after = skip_number(self.remaining);
        self.has_skipped |= after.len() < self.remaining.len() || after.first().is_some_and(|byte| !may_follow(*byte));
        self.remaining = after;
        Some(Word { letter, number: None, quoted: None })
    }
}

impl<'a> Words<'a> {
    /// The text up to the quotes that end it, and the text after them.
    fn skip_quoted(&mut self, text: &'a [u8]) -> (&'a [u8], &'a [u8]) {
        let quoted = text.split(|byte| *byte == b'"').next().unwrap_or_default();
        self.has_skipped |= quoted.len() == text.len();
        (quoted, text.get(quoted.len() + 1..).unwrap_or_default())
    }
}

/// `text` without the characters of numbers that it begins with.
fn skip_number(mut text: &[u8]) -> &[u8] {
    while let [b'0'..=b'9' | b'+' | b'-' | b'.', after @ ..] = text {
        text = after;
    }
    text
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::{String, ToString};
    use std::vec::Vec;

    /// The words, printed the shortest way.
    fn words(text: &str) -> Vec<String> {
        let print = |word: Word| {
            let mut text = (word.letter as char).to_string();
            if let Some(number) = word.number {
                text += &number.to_string();
            }
            text
        };
        Words::new(text.as_bytes()).map(print).collect()
    }

    #[test]
    fn spaces_are_where_people_put_them() {
        for text in ["X10Y20E-.04", " X 10 Y 20 E -.04 ", "x10\ty20\te-0.04", "X10  Y20 E-.04 ; Z9"] {
            assert_eq!(words(text), ["X10", "Y20", "E-0.04"], "{text}");
        }
    }

    #[test]
    fn an_exponent_is_another_word() {
        assert_eq!(words("X1E5"), ["X1", "E5"]);
        assert_eq!(words("X1e-3"), ["X1", "E-0.003"].map(|w| w.replace("0.003", "3")));
        assert_eq!(words("K1e-05"), ["K1", "E-5"]);
    }

    #[test]
    fn flags_have_no_number() {
        assert_eq!(words(" X Y"), ["X", "Y"]);
        assert_eq!(words("X- Y. Z-.E"), ["X", "Y", "Z", "E"]);
        assert_eq!(words("XYZ"), ["X", "Y", "Z"]);
    }

    #[test]
    fn glued_rubbish_is_skipped() {
        assert_eq!(words(" U6.2.6+8948 S1"), ["U6.2", "S1"]);
        assert_eq!(words("X1*Y2 Z3"), ["X1", "Z3"]);
        assert_eq!(words("X=5 Y6"), ["X", "Y6"]);
        assert_eq!(words("%*# \u{fc}X5 Y6"), ["Y6"]);
        assert_eq!(words("X - 5 Y6"), ["X", "Y6"]);
    }

    #[test]
    fn what_is_skipped_is_noted() {
        let has_skipped = |text: &str| {
            let mut words = Words::new(text.as_bytes());
            words.by_ref().for_each(drop);
            words.has_skipped()
        };
        for text in
            ["X1,5", "X1.2.3", "X--5", "X-", "X.", "X1\x01", "\x07X1", "X1*Y2", "X=5", "% X5", "A\"open", "X1\u{e4}"]
        {
            assert!(has_skipped(text), "{text:?}");
        }
        for text in ["", "X1Y2", "X 1\tY-.5", "X1\u{a0}Y2\u{a0}", "X1 (,) Y2;,", "P\"a,b\" S1", "X1E5", "XY", "X+5 Y5."]
        {
            assert!(!has_skipped(text), "{text:?}");
        }
        assert_eq!(words("X\u{a0}1\u{a0}Y2"), ["X1", "Y2"]);
        assert_eq!(Words::new(b"P \"mzv\" F60").next().and_then(|word| word.quoted), Some(&b"mzv"[..]));
    }

    #[test]
    fn comments_and_strings_hide_their_letters() {
        assert_eq!(words("X1 (Y2) Z3;E4"), ["X1", "Z3"]);
        assert_eq!(words("X1(Y2)Z3 (E4"), ["X1", "Z3"]);
        assert_eq!(words("P\"Input shaper; X5\" S1"), ["P", "S1"]);
        assert_eq!(words("P \"MK4S\"S1"), ["P", "S1"]);
        assert_eq!(words("\"X5\" S1 A\"never ends X5"), ["S1", "A"]);
    }
}
