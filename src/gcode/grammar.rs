//! Grammar: the lines that are valid. An invalid line does nothing, instead of half of its intent.
//!
//! Letters that a command does not know are ignored, as slicers rely on (`G28 W`, `M400 U1`). Four things make the line
//! invalid: text that is no word, a letter without its number, the letter of another axis, and a second command.

use super::code::Code;
use super::command::Command;
use super::index::{Absent, Named, absent, index_words};
use super::lexer::{Words, is_blank, skip_blanks, skip_past};
use super::number::Number;
use super::parts::Flaw;

/// The words of a command.
struct Grammar {
    /// Letters that need a number.
    numbers: &'static [u8],
    /// Letters of axes that the machine does not have.
    no_axes: &'static [u8],
    /// Letters with a number that must not be negative.
    not_negative: &'static [u8],
}

/// Marlin's names of axes beyond x, y and z.
const NO_AXES: &[u8] = b"ABCUVW";

impl Grammar {
    const fn numbers(numbers: &'static [u8]) -> Self {
        Self { numbers, no_axes: &[], not_negative: &[] }
    }

    const fn of_axes(numbers: &'static [u8], no_axes: &'static [u8]) -> Self {
        Self { numbers, no_axes, not_negative: &[] }
    }

    /// The grammar of a code; `None` for a code that takes any text, or must act in any case.
    fn of(code: Code) -> Option<Self> {
        Some(match (code.letter, code.number) {
            // C is the belt's circulation, which not every machine has.
            (b'G', 0 | 1) => Self::of_axes(b"XYZECF", b"ABUVW"),
            (b'G', 2 | 3) => Self { not_negative: b"P", ..Self::of_axes(b"XYZEFIJKRP", NO_AXES) },
            (b'G', 4) => Self { numbers: b"PS", no_axes: &[], not_negative: b"PS" },
            // With W, Prusa's G28 does not probe the bed.
            (b'G', 28) => Self::of_axes(b"", b"ABCUV"),
            (b'G', 92) => Self::of_axes(b"", NO_AXES),
            (b'G', 29 | 30 | 80) => return None,
            (b'G', _) => Self::numbers(b""),
            (b'M', 17) => Self::of_axes(b"", NO_AXES),
            (b'M', 18 | 84) => Self { not_negative: b"S", ..Self::of_axes(b"S", NO_AXES) },
            (b'M', 92 | 201 | 203 | 906 | 913 | 914) => Self::of_axes(b"XYZE", NO_AXES),
            (b'M', 915) => Self::numbers(b""),
            (b'M', 569) => Self::of_axes(b"", NO_AXES),
            (b'M', 73) => Self::numbers(b"PR"),
            (b'M', 111 | 113 | 154 | 155 | 220) => Self::numbers(b"S"),
            (b'M', 221) => Self::numbers(b"STD"),
            (b'M', 204) => Self::numbers(b"PRTS"),
            (b'M', 205) => Self::numbers(b"XYZEJSTB"),
            (b'M', 207) => Self::numbers(b"SFZ"),
            (b'M', 208) => Self::numbers(b"SF"),
            (b'M', 104 | 109) => Self::numbers(b"SRT"),
            (b'M', 140 | 141 | 190 | 191) => Self::numbers(b"SR"),
            (b'M', 106 | 302) => Self::numbers(b"SP"),
            (b'M', 107) => Self::numbers(b"P"),
            (b'M', 301 | 304) => Self::numbers(b"PID"),
            (b'M', 303) => Self::numbers(b"ECS"),
            (b'M', 306) => Self::numbers(b"EPCAFRLH"),
            (b'M', 710) => Self::numbers(b"SD"),
            (b'M', 572) => Self::numbers(b"SWD"),
            (b'M', 593) => Self { not_negative: b"F", ..Self::numbers(b"FDTS") },
            (b'M', 900) => Self::numbers(b"KT"),
            (b'M', 82 | 83 | 116 | 200 | 211 | 400 | 413) => Self::numbers(b""),
            _ => return None,
        })
    }
}

/// The error in the words of a command; a part that is no word comes first.
#[cold]
#[inline(never)]
pub(super) fn flaw_of(code: Code, text: &[u8]) -> Option<Flaw<'_>> {
    let grammar = Grammar::of(code)?;
    let parts = index_words(code);
    let mut words = Words::new(text);
    let mut begin = text;
    while words.next().is_some() || words.has_skipped() {
        if words.has_skipped() {
            return Some(Flaw::NoWord(shown(begin)));
        }
        begin = words.remaining();
    }
    let mut words = Words::new(text);
    let mut begin = text;
    while let Some(word) = words.next() {
        let is_negative = word.number.is_some_and(|number| number < Number::ZERO);
        if grammar.no_axes.contains(&word.letter) {
            return Some(Flaw::NoAxis(word.letter));
        } else if word.number.is_none() && grammar.numbers.contains(&word.letter) {
            return Some(Flaw::NoNumber(word.letter));
        } else if let Some(part) = absent(parts, word.letter, word.number) {
            let which = shown(begin).get(1..).map_or(&[][..], skip_blanks);
            let which = which.get(..number_length(which)).unwrap_or(which);
            return Some(Flaw::Absent(Absent { command: Named::Code(code.letter, code.number), part, which }));
        } else if is_negative && grammar.not_negative.contains(&word.letter) {
            return Some(Flaw::OutOfRange(shown(begin)));
        } else if matches!(word.letter, b'G' | b'M') && word.number.is_some() {
            return Some(Flaw::SecondCommand(shown(begin)));
        }
        begin = words.remaining();
    }
    None
}

/// `command`, unless the words that it was made of are not in order.
pub(super) fn in_order<'a>(command: Command<'a>, code: Code, text: &'a [u8]) -> Command<'a> {
    flaw_of(code, text).map_or(command, Command::Malformed)
}

/// The length of the number that `text` begins with.
fn number_length(text: &[u8]) -> usize {
    Number::read(text).map_or(0, |(_, after)| text.len() - after.len())
}

/// The begin of `text`, up to the next blank or comment. Comments and texts in quotes before it are left out.
fn shown(mut text: &[u8]) -> &[u8] {
    loop {
        text = skip_blanks(text);
        text = match text {
            [b'(', inside @ ..] => skip_past(inside, b')'),
            [b'"', inside @ ..] if inside.contains(&b'"') => skip_past(inside, b'"'),
            _ => break,
        };
    }
    // A blank between a letter and its number belongs to the word.
    let number = text.get(1..).map_or(text, skip_blanks);
    let number = if text.first().is_some_and(u8::is_ascii_alphabetic) { number } else { text };
    let length = number.iter().position(|byte| is_blank(*byte) || matches!(byte, b';' | b'(')).unwrap_or(number.len());
    text.get(..text.len() - number.len() + length).unwrap_or(text)
}

#[cfg(test)]
mod tests;
