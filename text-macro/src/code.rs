//! The code: a character that stands for a word of the dictionary.
//!
//! The first words have codes of one byte in UTF-8, the control characters. The others have two bytes, from U+0700 on.
//! No text of the firmware has these characters, so a packed text is a legal `str`, and one without codes is itself.
//! `corehbot::text` reads the code.

use std::collections::HashMap;

/// Words with a code of one byte: U+0000 to U+001F.
pub const SHORT: usize = 32;

/// Numbers without a word: a tab and a line end stand for themselves.
#[cfg(test)]
pub const RESERVED: [usize; 2] = [b'\t' as usize, b'\n' as usize];

/// Words at most: U+0700 to U+07FF have codes of two bytes, which no other characters begin as.
#[cfg(test)]
pub const MOST: usize = SHORT + 256;

/// The character of a word's number.
pub fn code(number: usize) -> char {
    let at = if number < SHORT { number } else { 0x700 + number - SHORT };
    u32::try_from(at).ok().and_then(char::from_u32).unwrap_or(char::REPLACEMENT_CHARACTER)
}

/// The word's number of a character.
#[cfg(test)]
pub fn number(code: char) -> Option<usize> {
    let at = code as usize;
    match at {
        0x700..0x800 => Some(at - 0x700 + SHORT),
        _ if at < SHORT && !RESERVED.contains(&at) => Some(at),
        _ => None,
    }
}

/// A part of a packed text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Part {
    /// A character that stands for itself.
    Plain(char),
    /// The word of this number.
    Word(usize),
}

impl Part {
    /// Its length in bytes.
    pub const fn len(self) -> usize {
        match self {
            Self::Plain(character) => character.len_utf8(),
            Self::Word(number) => 1 + (number >= SHORT) as usize,
        }
    }
}

/// Packs texts by words.
pub struct Packer<'w> {
    numbers: HashMap<&'w str, usize>,
    longest: usize,
}

impl<'w> Packer<'w> {
    /// Packs by these words; empty ones have no code.
    pub fn new(words: impl IntoIterator<Item = &'w str>) -> Self {
        let numbered = words.into_iter().enumerate().filter(|(_, word)| !word.is_empty());
        let numbers: HashMap<&str, usize> = numbered.map(|(number, word)| (word, number)).collect();
        let longest = numbers.keys().map(|word| word.len()).max().unwrap_or(0);
        Self { numbers, longest }
    }

    /// `text` in the fewest bytes.
    pub fn pack(&self, text: &str) -> String {
        self.parts(text).into_iter().map(character).collect()
    }

    /// A word in the fewest bytes, which are not its own code.
    pub fn pack_word(&self, word: &str) -> String {
        self.parts_of_word(word).into_iter().map(character).collect()
    }

    /// The parts of `text` in the fewest bytes.
    pub fn parts(&self, text: &str) -> Vec<Part> {
        self.fewest(text, self.longest)
    }

    /// The parts of a word in the fewest bytes, other than the word itself.
    pub fn parts_of_word(&self, word: &str) -> Vec<Part> {
        self.fewest(word, word.len().saturating_sub(1))
    }

    /// The parts of `text`, by words up to a length.
    fn fewest(&self, text: &str, longest: usize) -> Vec<Part> {
        // For each place: bytes of the shortest code up to it, the last part of that, and where this part begins.
        let mut best = vec![(0, Part::Plain(' '), 0)];
        for end in 1..=text.len() {
            let mut fewest = (usize::MAX, Part::Plain(' '), 0);
            for (start, (before, _, _)) in best.iter().enumerate().skip(end.saturating_sub(self.longest.max(4))) {
                let Some(part) = text.get(start..end) else { continue };
                let word = self.numbers.get(part).filter(|_| part.len() <= longest).map(|number| Part::Word(*number));
                let mut characters = part.chars();
                let plain = characters.next().filter(|_| characters.as_str().is_empty()).map(Part::Plain);
                for part in [plain, word].into_iter().flatten() {
                    let bytes = before + part.len();
                    if bytes < fewest.0 {
                        fewest = (bytes, part, start);
                    }
                }
            }
            best.push(fewest);
        }
        let (mut parts, mut end) = (Vec::new(), text.len());
        while end > 0 {
            let (_, part, start) = best[end];
            parts.push(part);
            end = start;
        }
        parts.reverse();
        parts
    }
}

/// The character of a part.
fn character(part: Part) -> char {
    match part {
        Part::Plain(character) => character,
        Part::Word(number) => code(number),
    }
}

/// A packed text without its codes.
#[cfg(test)]
pub fn unpack(packed: &str, words: &[&str]) -> String {
    packed.chars().map(|by| number(by).map_or_else(|| by.to_string(), |number| words[number].to_owned())).collect()
}
