//! Rows: one row has all that this room knows of a code, or of a few codes with the same words.
//!
//! | part | for |
//! |---|---|
//! | the codes or names | finding the row |
//! | a function | reading the words |
//! | a [`Grammar`] | refusing lines that are not in order; without one the command takes any text |
//! | a [`Text`] | docs/reference/gcode.md; not in an image, because nothing there refers to it |

use super::Command;
use super::grammar::{Grammar, Letters};
use crate::gcode::code::Code;
use crate::text::is_word;

/// Reads the words after a code with that number (0 for a name). `None` if the whole line is unknown.
pub(super) type Read = for<'a> fn(u16, &'a [u8]) -> Option<Command<'a>>;

/// How a line begins.
#[derive(Clone, Copy, Debug)]
pub(in crate::gcode) enum Begin {
    /// With a letter and one of these numbers.
    Code(u8, &'static [u16]),
    /// With one of these names.
    Name(&'static [&'static str]),
}

impl Begin {
    /// Whether a code begins a line of it.
    pub(super) fn is_code(&self, code: Code, letters: Letters) -> bool {
        match *self {
            Self::Code(b'T', _) => code.letter == b'T' && code.subcode == 0,
            Self::Code(letter, numbers) => {
                letter == code.letter
                    && numbers.contains(&code.number)
                    && (code.subcode == 0 || letters.takes_subcodes())
            }
            Self::Name(_) => false,
        }
    }

    /// Whether it is one of its names.
    pub(super) fn is_name(&self, name: &[u8]) -> bool {
        match self {
            Self::Name(names) => names.iter().any(|known| is_word(name, known.as_bytes())),
            Self::Code(..) => false,
        }
    }

    /// The letter and the numbers of its codes, and its names.
    pub(super) const fn parts(&self) -> ((char, &'static [u16]), &'static [&'static str]) {
        match *self {
            Self::Code(letter, numbers) => ((letter as char, numbers), &[]),
            Self::Name(names) => (('M', &[]), names),
        }
    }
}

/// The part of a row that the firmware needs.
#[derive(Clone, Copy)]
pub(in crate::gcode) struct Row {
    pub begin: Begin,
    pub read: Read,
    pub grammar: Option<&'static Grammar>,
    /// The letters of its text; other letters are ignored in every form. And whether a subcode (`M862.3`) makes no
    /// difference; elsewhere it makes another command.
    pub letters: Letters,
}

/// What the firmware does with a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Treatment {
    /// It is carried out.
    CarriedOut,
    /// It is answered `ok`, and nothing is done.
    Silent,
    /// It is answered with the reason why nothing is done.
    Refused,
}

/// The part of a row for people.
#[derive(Clone, Copy, Debug)]
pub struct Text {
    /// Its treatment.
    pub treatment: Treatment,
    /// Its words.
    pub words: &'static str,
    /// Its effect, or the reason why there is none.
    pub does: &'static str,
}

/// A whole row. The firmware's table is made of these before it runs, and has no texts.
#[derive(Clone, Copy)]
pub(in crate::gcode) struct Described {
    pub row: Row,
    pub text: Text,
}

impl Described {
    const fn new(begin: Begin, read: Read) -> Self {
        let text = Text { treatment: Treatment::CarriedOut, words: "", does: "" };
        Self { row: Row { begin, read, grammar: None, letters: Letters::NONE }, text }
    }

    /// G-codes.
    pub(super) const fn g(numbers: &'static [u16], read: Read) -> Self {
        Self::new(Begin::Code(b'G', numbers), read)
    }

    /// M-codes.
    pub(super) const fn m(numbers: &'static [u16], read: Read) -> Self {
        Self::new(Begin::Code(b'M', numbers), read)
    }

    /// A tool: any number that may be one.
    pub(super) const fn t(read: Read) -> Self {
        Self::new(Begin::Code(b'T', &[0]), read)
    }

    /// Names.
    pub(super) const fn name(names: &'static [&'static str], read: Read) -> Self {
        Self::new(Begin::Name(names), read)
    }

    /// It takes words alone, and refuses lines that are not in order.
    pub(super) const fn grammar(mut self, grammar: &'static Grammar) -> Self {
        self.row.grammar = Some(grammar);
        self
    }

    /// Its words, and what it does.
    pub(super) const fn does(mut self, words: &'static str, does: &'static str) -> Self {
        self.row.letters = self.row.letters.with(words.as_bytes());
        self.text.words = words;
        self.text.does = does;
        self
    }

    /// It is accepted and nothing is done, for this reason.
    pub(super) const fn silent(numbers: &'static [u16], why: &'static str) -> Self {
        Self::m(numbers, |_, _| Some(Command::Silent)).silently(why)
    }

    /// The same for a row that reads its words.
    pub(super) const fn silently(self, why: &'static str) -> Self {
        self.treated(Treatment::Silent).does("", why)
    }

    /// It is refused with this answer.
    pub(super) const fn refused(self, answer: &'static str) -> Self {
        self.treated(Treatment::Refused).does("", answer)
    }

    const fn treated(mut self, treatment: Treatment) -> Self {
        self.text.treatment = treatment;
        self
    }

    pub(super) const fn with_subcodes(mut self) -> Self {
        self.row.letters = self.row.letters.with_subcodes();
        self
    }
}
