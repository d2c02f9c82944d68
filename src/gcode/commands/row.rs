//! Parts of a row: how its lines begin, and its texts, which stand in docs/reference/gcode.md and in no image.

use super::grammar::Letters;
use crate::gcode::code::Code;
use crate::text::is_word;

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
