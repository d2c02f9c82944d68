//! Axes of a line: X, Y, Z and E, with their values or only named.

use super::lexer::{Word, Words, numbers};
use super::parts::{AxisFlags, AxisWords};

/// The axes of a text with their values.
pub(super) fn axis_words(text: &[u8]) -> AxisWords {
    let [x, y, z, e] = numbers(text, b"XYZE");
    AxisWords { x, y, z, e }
}

/// Puts `word` where it belongs if it names an axis.
pub(super) fn take_axis(words: &mut AxisWords, word: Word<'_>) {
    match word.letter {
        b'X' => words.x = word.number,
        b'Y' => words.y = word.number,
        b'Z' => words.z = word.number,
        b'E' => words.e = word.number,
        _ => {}
    }
}

/// The axes that a text names, with or without a value.
pub(super) fn axis_flags(text: &[u8]) -> AxisFlags {
    let mut flags = AxisFlags::default();
    for word in Words::new(text) {
        match word.letter {
            b'X' => flags.x = true,
            b'Y' => flags.y = true,
            b'Z' => flags.z = true,
            b'E' => flags.e = true,
            _ => {}
        }
    }
    flags
}
