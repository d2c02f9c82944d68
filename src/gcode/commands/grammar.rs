//! Grammar: the lines that are valid. An invalid line does nothing, instead of half of its intent.
//!
//! Letters that a command does not know are ignored, as slicers rely on (`G28 Q`, `M400 U1`), in every form (`Q0:1`).
//! Known are the letters of docs/reference/gcode.md. Four things make the line invalid: text that is no word, a letter
//! without its number, the letter of another axis, and a second command.

use super::Command;
use crate::gcode::code::Code;
use crate::gcode::index::{Absent, Named, Part, absent};
use crate::gcode::lexer::{Word, Words, is_blank, skip_blanks, skip_past};
use crate::gcode::number::Number;
use crate::gcode::parts::Flaw;
use crate::settings::plain::has_letter;

/// The rules for the words of a command.
#[derive(Clone, Copy, Debug)]
pub struct Grammar {
    /// Letters that need a number.
    numbers: Letters,
    /// The letters of plain settings need one too.
    is_plain: bool,
    /// Letters of axes that the machine does not have: where it would move them, or forget their place.
    no_axes: Letters,
    /// Letters with a number that must not be negative.
    not_negative: Letters,
    /// Letters that select a part.
    parts: &'static [(u8, Part)],
}

/// Marlin's names of axes beyond x, y and z.
pub const NO_AXES: &[u8] = b"ABCUVW";

impl Grammar {
    /// Words, and nothing else; these letters need a number.
    #[must_use]
    pub const fn numbers(numbers: &[u8]) -> Self {
        let numbers = Letters::NONE.with(numbers);
        Self { numbers, is_plain: false, no_axes: Letters::NONE, not_negative: Letters::NONE, parts: &[] }
    }

    /// The letters of the code's plain settings need a number.
    #[must_use]
    pub const fn plain() -> Self {
        Self { is_plain: true, ..Self::numbers(b"") }
    }

    /// Whether the command knows a letter, whose form matters then.
    fn knows(&self, known: Letters, code: Code, letter: u8) -> bool {
        known.has(letter) || self.no_axes.has(letter) || self.selects(letter) || self.needs_number(code, letter)
    }

    /// Whether a letter takes a list: of parts, of which one may be there, or of the values of all extruders
    /// (RepRapFirmware's `M92 E420:420`), of which the first is meant.
    fn takes_list(&self, known: Letters, code: Code, letter: u8, list: &[u8]) -> bool {
        let is_of_extruders = letter == b'E' && code.letter == b'M' && self.knows(known, code, b'X');
        (is_of_extruders || self.selects(letter))
            && list.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b'-' | b'.' | b':'))
    }

    /// Whether a word names the first part, in quotes (RepRapFirmware's `M572 D"0"`).
    fn names_first(&self, word: Word<'_>) -> bool {
        word.quoted == Some(b"0") && self.selects(word.letter)
    }

    /// Whether a letter selects a part. Only lines for the one that is there are obeyed.
    pub(super) fn selects(&self, letter: u8) -> bool {
        self.parts.iter().any(|(its, _)| *its == letter)
    }

    /// Whether a letter needs a number.
    fn needs_number(&self, code: Code, letter: u8) -> bool {
        self.numbers.has(letter) || (self.is_plain && has_letter(code.number, letter))
    }

    /// The same, and these letters are axes that there are not.
    #[must_use]
    pub const fn no_axes(self, no_axes: &[u8]) -> Self {
        Self { no_axes: Letters::NONE.with(no_axes), ..self }
    }

    /// The same, and the numbers of these letters are not negative.
    #[must_use]
    pub const fn not_negative(self, not_negative: &[u8]) -> Self {
        Self { not_negative: Letters::NONE.with(not_negative), ..self }
    }

    /// The same, and these letters select a part.
    #[must_use]
    pub const fn parts(self, parts: &'static [(u8, Part)]) -> Self {
        Self { parts, ..self }
    }
}

/// A set of letters, as the bits of a number. The last bit says whether subcodes make no difference.
#[derive(Clone, Copy, Debug)]
pub(in crate::gcode) struct Letters(u32);

const SUBCODES: u32 = 1 << 31;

impl Letters {
    /// None.
    pub(super) const NONE: Self = Self(0);

    /// The same, and any subcode.
    pub(super) const fn with_subcodes(self) -> Self {
        Self(self.0 | SUBCODES)
    }

    pub(super) const fn takes_subcodes(self) -> bool {
        self.0 & SUBCODES != 0
    }

    /// The same, and the capital letters in a text.
    pub(super) const fn with(self, text: &[u8]) -> Self {
        let (mut set, mut bytes) = (self.0, text);
        while let [byte, others @ ..] = bytes {
            if byte.is_ascii_uppercase() {
                set |= 1 << (*byte - b'A');
            }
            bytes = others;
        }
        Self(set)
    }

    pub(super) const fn has(self, letter: u8) -> bool {
        letter.is_ascii_uppercase() && self.0 & 1 << (letter - b'A') != 0
    }
}

/// The text behind the letter of the first word.
fn behind_letter(text: &[u8]) -> &[u8] {
    shown(text).get(1..).map_or(&[], skip_blanks)
}

/// The error in the words of a command; a part that is no word comes first.
#[cold]
#[inline(never)]
fn flaw_of<'a>(grammar: &Grammar, known: Letters, code: Code, text: &'a [u8]) -> Option<Flaw<'a>> {
    let mut words = Words::new(text);
    let mut begin = text;
    loop {
        // All words are read once for this: text that is none counts first, wherever it is.
        let word = words.next();
        let written = begin.get(..begin.len() - words.remaining().len()).unwrap_or_default();
        let is_flaw = word.is_some_and(|word| {
            word.is_odd
                && grammar.knows(known, code, word.letter)
                && !grammar.takes_list(known, code, word.letter, behind_letter(written))
        });
        if is_flaw || words.has_loose() {
            return Some(Flaw::NoWord(shown(begin)));
        }
        if word.is_none() {
            break;
        }
        begin = words.remaining();
    }
    let mut words = Words::new(text);
    let mut begin = text;
    while let Some(word) = words.next() {
        let written = begin.get(..begin.len() - words.remaining().len()).unwrap_or_default();
        let is_negative = word.number.is_some_and(|number| number < Number::ZERO);
        if grammar.no_axes.has(word.letter) {
            return Some(Flaw::NoAxis(word.letter));
        } else if word.number.is_none() && !grammar.names_first(word) && grammar.needs_number(code, word.letter) {
            return Some(Flaw::NoNumber(word.letter));
        } else if let Some(part) = absent(grammar.parts, word.letter, word.number)
            // The first one of a list may be there.
            && !(part.is_there(Number::ZERO) && behind_letter(written).split(|byte| *byte == b':').any(|one| one == b"0"))
        {
            // Only its number is shown, and not what follows without a blank.
            let which = behind_letter(begin);
            let which = which.get(..number_length(which)).unwrap_or(which);
            return Some(Flaw::Absent(Absent { command: Named::Code(code.letter, code.number), part, which }));
        } else if is_negative && grammar.not_negative.has(word.letter) {
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
    known: Letters,
    code: Code,
    text: &'a [u8],
) -> Command<'a> {
    flaw_of(grammar, known, code, text).map_or(command, Command::Malformed)
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
