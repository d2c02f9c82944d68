//! The words of plain settings.

use crate::gcode::{Number, TableCommand};
use crate::settings::plain::{MOST_WORDS, letters};

/// The words of a line that sets plain settings.
pub(in crate::machine) struct PlainWords {
    /// The number of the M-code.
    pub code: u16,
    /// A number for each letter that the line gave one, in the order of [`letters`].
    pub numbers: [Option<Number>; MOST_WORDS],
}

impl PlainWords {
    /// An older letter counts without the setting's own.
    pub fn read(command: &TableCommand<'_>) -> Self {
        let (code, mut numbers) = (command.code(), [None; MOST_WORDS]);
        for (place, letters) in numbers.iter_mut().zip(letters(code)) {
            *place = letters.bytes().find_map(|letter| command.number(letter));
        }
        Self { code, numbers }
    }

    /// The number of a letter.
    pub fn number(&self, letter: &str) -> Option<Number> {
        letters(self.code).zip(&self.numbers).find(|(own, _)| *own == letter).and_then(|(_, number)| *number)
    }
}
