//! Grammar: the lines that are valid. An invalid line does nothing, instead of half of its intent.
//!
//! Letters that a command does not know are ignored, as slicers rely on (`G28 Q`, `M400 U1`). Four things make the line
//! invalid: text that is no word, a letter without its number, the letter of another axis, and a second command.

use super::Command;
use crate::gcode::code::Code;
use crate::gcode::index::{Absent, Named, Part, absent};
use crate::gcode::lexer::{Words, is_blank, skip_blanks, skip_past};
use crate::gcode::number::Number;
use crate::gcode::parts::Flaw;
use crate::settings::plain::letters;

/// The rules for the words of a command.
#[derive(Clone, Copy)]
pub(in crate::gcode) struct Grammar {
    /// Letters that need a number.
    numbers: &'static [u8],
    /// The letters of plain settings need one too.
    is_plain: bool,
    /// Letters of axes that the machine does not have.
    no_axes: &'static [u8],
    /// Letters with a number that must not be negative.
    not_negative: &'static [u8],
    /// Letters that select a part.
    parts: &'static [(u8, Part)],
}

/// Marlin's names of axes beyond x, y and z.
pub(super) const NO_AXES: &[u8] = b"ABCUVW";

/// Words that need no number.
pub(super) const WORDS: &Grammar = &Grammar::numbers(b"");

impl Grammar {
    /// Words, and nothing else; these letters need a number.
    pub(super) const fn numbers(numbers: &'static [u8]) -> Self {
        Self { numbers, is_plain: false, no_axes: &[], not_negative: &[], parts: &[] }
    }

    /// The letters of the code's plain settings need a number.
    pub(super) const fn plain() -> Self {
        Self { is_plain: true, ..Self::numbers(b"") }
    }

    /// Whether a letter needs a number.
    fn needs_number(&self, code: Code, letter: u8) -> bool {
        self.numbers.contains(&letter)
            || (self.is_plain && letters(code.number).any(|letters| letters.as_bytes().contains(&letter)))
    }

    /// The same, and these letters are axes that there are not.
    pub(super) const fn no_axes(self, no_axes: &'static [u8]) -> Self {
        Self { no_axes, ..self }
    }

    /// The same, and the numbers of these letters are not negative.
    pub(super) const fn not_negative(self, not_negative: &'static [u8]) -> Self {
        Self { not_negative, ..self }
    }

    /// The same, and these letters select a part.
    pub(super) const fn parts(self, parts: &'static [(u8, Part)]) -> Self {
        Self { parts, ..self }
    }
}

/// The error in the words of a command; a part that is no word comes first.
#[cold]
#[inline(never)]
fn flaw_of<'a>(grammar: &Grammar, code: Code, text: &'a [u8]) -> Option<Flaw<'a>> {
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
        } else if word.number.is_none() && grammar.needs_number(code, word.letter) {
            return Some(Flaw::NoNumber(word.letter));
        } else if let Some(part) = absent(grammar.parts, word.letter, word.number) {
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
pub(in crate::gcode) fn in_order<'a>(
    command: Command<'a>,
    grammar: &Grammar,
    code: Code,
    text: &'a [u8],
) -> Command<'a> {
    flaw_of(grammar, code, text).map_or(command, Command::Malformed)
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
