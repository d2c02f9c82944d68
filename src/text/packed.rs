//! Packed texts: words of a dictionary are one character each in the image, which halves the texts.
//!
//! [`text!`] is a text with places for values, [`put!`] writes one in a `Display`, and [`packed!`] is a fixed text. A
//! text is packed when it is compiled (`text-macro`) and unpacked when it is displayed. The codes are control
//! characters and U+0700 to U+07FF (Syriac, Thaana, N'Ko). A value in a `text!` must not have them, because it passes
//! the same unpacking: what hosts send is made harmless by `Echo` first. Docs: explanation/texts.md.

use core::fmt::{self, Write};

/// Lengths of the words, and all words, which contain codes of others.
const DICTIONARY: (&[u8], &str) = corehbot_text_macro::dictionary!();

/// Words that contain each other: a test holds it.
const DEPTH: usize = 8;

/// Words with codes of one byte, the control characters; the others begin here.
const SHORT: usize = 0x20;

/// A text with places for values. The arguments are those of `format_args!`. Its code counts as its caller's, also in
/// the sizes of rooms.
#[collapse_debuginfo(yes)]
macro_rules! text {
    ($($args:tt)*) => { $crate::text::Text(::corehbot_text_macro::packed_args!($($args)*)) };
}

/// Writes a text to a `Formatter`. The other arguments are those of `format_args!`.
#[collapse_debuginfo(yes)]
macro_rules! put {
    ($f:expr, $($args:tt)*) => { $crate::text::put($f, ::corehbot_text_macro::packed_args!($($args)*)) };
}

/// A fixed text, from a literal.
#[collapse_debuginfo(yes)]
macro_rules! packed {
    ($text:literal) => {
        $crate::text::Packed(::corehbot_text_macro::packed_str!($text))
    };
}

/// A packed text with values; displayed, it is unpacked.
#[derive(Clone, Copy)]
pub struct Text<'a>(pub fmt::Arguments<'a>);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        put(f, self.0)
    }
}

/// Writes a packed text, unpacked.
#[inline(never)]
pub fn put(f: &mut fmt::Formatter<'_>, packed: fmt::Arguments<'_>) -> fmt::Result {
    Unpacking(f).write_fmt(packed)
}

/// A packed text without values; displayed, it is unpacked.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Packed(pub &'static str);

impl fmt::Display for Packed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Unpacking(f).write_str(self.0)
    }
}

impl fmt::Debug for Packed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Unpacks what is written to it.
struct Unpacking<'f, 'b>(&'f mut fmt::Formatter<'b>);

impl Write for Unpacking<'_, '_> {
    fn write_str(&mut self, packed: &str) -> fmt::Result {
        // What is left of the text, and of words in it.
        let mut left: heapless::Vec<&str, DEPTH> = heapless::Vec::new();
        let mut packed = Some(packed);
        while let Some(text) = packed {
            let plain = text.bytes().position(is_code).unwrap_or(text.len());
            let (plain, coded) = text.split_at_checked(plain).unwrap_or((text, ""));
            self.0.write_str(plain)?;
            let mut coded = coded.chars();
            packed = match coded.next() {
                Some(code) => {
                    let _ = left.push(coded.as_str());
                    Some(word(code))
                }
                None => left.pop(),
            };
        }
        Ok(())
    }
}

/// Whether a code begins with this byte. Tabs and line ends stand for themselves.
const fn is_code(byte: u8) -> bool {
    matches!(byte, 0..b'\t' | 0x0B..0x20 | 0xDC..=0xDF)
}

/// The word of a code, packed.
fn word(code: char) -> &'static str {
    let code = code as usize;
    let number = if code < SHORT { code } else { code - 0x700 + SHORT };
    let (lengths, words) = DICTIONARY;
    let begin = lengths.iter().take(number).map(|length| usize::from(*length)).sum();
    let length = lengths.get(number).map_or(0, |length| usize::from(*length));
    words.get(begin..).and_then(|words| words.get(..length)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;
    use std::string::ToString;

    #[test]
    fn each_code_is_unpacked_to_its_word() {
        for (code, word) in corehbot_text_macro::words!() {
            if !word.is_empty() {
                assert_eq!(Text(format_args!("{code}|{code}{code}.")).to_string(), format!("{word}|{word}{word}."));
            }
        }
    }

    #[test]
    fn a_text_is_what_format_args_makes_of_it() {
        let name = "E";
        assert_eq!(text!("echo:no {name}, {:>4.1} {{the}}\tmm\n", 1.25).to_string(), "echo:no E,  1.2 {the}\tmm\n");
        assert_eq!(packed!("echo: the motor is \"off\"").to_string(), "echo: the motor is \"off\"");
        assert_eq!(text!("{}", text!("the {}", packed!(" ignored: the"))).to_string(), "the  ignored: the");
    }
}
