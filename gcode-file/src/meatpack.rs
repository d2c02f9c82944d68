//! MeatPack: G-code with two frequent characters in a byte, as binary G-code uses it.
//!
//! Half a byte is one of 15 characters, the first one in the lower half; 15 says that the character follows as a byte.
//! Two bytes of 255 and a further one switch packing, or blanks: without them `E` takes the place of the blank, and
//! commands `G` have lost theirs (github.com/prusa3d/libbgcode, `meatpack.cpp`). The one crate of it has one release
//! and needs its input in lines.

/// The characters of half a byte.
const CHARACTERS: [u8; 15] = *b"0123456789. \nGX";

/// Where `E` stands in place of a blank.
const BLANK: u8 = 11;

/// Half a byte of which the character follows.
const FOLLOWS: u8 = 15;

/// Announces a switch if it comes twice.
const SIGNAL: u8 = 255;

const PACKING_ON: u8 = 251;
const PACKING_OFF: u8 = 250;
const RESET: u8 = 249;
const BLANKS_OFF: u8 = 247;
const BLANKS_ON: u8 = 246;

/// The text that a block of bytes stands for; `None` if it ends within a character.
pub(crate) fn unpack(packed: &[u8]) -> Option<Vec<u8>> {
    let (mut text, mut bytes) = (Spaced::default(), packed.iter().copied().peekable());
    let (mut is_packing, mut has_blanks) = (false, true);
    while let Some(byte) = bytes.next() {
        if byte == SIGNAL && bytes.next_if_eq(&SIGNAL).is_some() {
            // Two characters that follow are 255 as well, and no switch is below 246.
            match bytes.peek() {
                Some(&switch) if switch >= BLANKS_ON && switch != SIGNAL => {
                    bytes.next();
                    match switch {
                        PACKING_ON => is_packing = true,
                        PACKING_OFF | RESET => is_packing = false,
                        BLANKS_OFF => has_blanks = false,
                        BLANKS_ON => has_blanks = true,
                        _ => {}
                    }
                    continue;
                }
                _ => return None,
            }
        }
        if !is_packing {
            text.push(byte);
            continue;
        }
        let character = |half: u8| match half {
            BLANK if !has_blanks => b'E',
            half => CHARACTERS[usize::from(half)],
        };
        let (low, high) = (byte & 15, byte >> 4);
        match (low, high) {
            (FOLLOWS, FOLLOWS) => {
                text.push(bytes.next()?);
                text.push(bytes.next()?);
            }
            (FOLLOWS, _) => {
                text.push(bytes.next()?);
                text.push(character(high));
            }
            (_, FOLLOWS) => {
                text.push(character(low));
                // Behind a line's end the half is only filled.
                if character(low) != b'\n' {
                    text.push(bytes.next()?);
                }
            }
            _ => {
                text.push(character(low));
                if character(low) != b'\n' {
                    text.push(character(high));
                }
            }
        }
    }
    Some(text.found)
}

/// Text in which commands `G` get the blanks back that packing took.
#[derive(Default)]
struct Spaced {
    found: Vec<u8>,
    /// Bytes of the line so far.
    line: usize,
    /// The line is a letter `G` and a digit.
    is_command: bool,
}

impl Spaced {
    fn push(&mut self, byte: u8) {
        let is_word = byte.is_ascii_uppercase() && self.line > 0 && self.found.last() != Some(&b' ');
        if self.is_command && is_word {
            self.found.push(b' ');
        }
        match self.line {
            1 => self.is_command = self.found.last() == Some(&b'G') && byte.is_ascii_digit(),
            0 => self.is_command = false,
            _ => {}
        }
        self.found.push(byte);
        self.line = if byte == b'\n' { 0 } else { self.line + 1 };
    }
}
