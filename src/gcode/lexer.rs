//! Words: a letter, perhaps with a number, and the characters allowed around it.
//!
//! Spaces are optional everywhere, also between a letter and its number. A word keeps the characters of
//! numbers and lists that are glued to it (`U6.2.6+8948` is U6.2, `D0:1` is D0), other glued characters are skipped up
//! to the next blank. Such a word is odd, which matters only to a command that knows its letter (`grammar.rs`). Text
//! that belongs to no word, and bytes that no person writes, make most commands do nothing.
//! Comments are `;` to the end and `( )`.

use super::number::Number;

/// One word of a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Word<'a> {
    /// The letter in upper case.
    pub letter: u8,
    /// The number, if the word is more than a flag.
    pub number: Option<Number>,
    /// The text in quotes that stands where a number might.
    pub quoted: Option<&'a [u8]>,
    /// Whether more is glued to it, such as the rest of a list.
    pub is_odd: bool,
}

/// The words of a text, in order.
#[derive(Clone, Debug)]
pub struct Words<'a> {
    remaining: &'a [u8],
    /// One of the words was odd.
    has_odd: bool,
    /// A part was no word.
    has_loose: bool,
}

impl<'a> Words<'a> {
    /// The words of `text`, which begins after the command's code.
    #[must_use]
    pub const fn new(text: &'a [u8]) -> Self {
        Self { remaining: text, has_odd: false, has_loose: false }
    }

    /// Whether the text so far held a part that was neither a word nor a comment.
    pub(super) const fn has_skipped(&self) -> bool {
        self.has_odd || self.has_loose
    }

    /// The same, but for parts that are glued to a word.
    pub(super) const fn has_loose(&self) -> bool {
        self.has_loose
    }

    /// The text after the words so far.
    pub(super) const fn remaining(&self) -> &'a [u8] {
        self.remaining
    }
}

/// Space, tab, or a byte of a no-break space (U+00A0), which people copy from web pages.
#[inline(always)]
pub(super) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0xC2 | 0xA0)
}

/// Whether a byte at the end of a line does not belong to it: a blank or a line end.
pub(super) const fn is_outside(byte: u8) -> bool {
    is_blank(byte) || matches!(byte, b'\r' | b'\n')
}

/// `text` without the blanks it begins with. Not by `trim_start`, which calls `is_blank` for each byte: every word of a
/// line passes here.
#[inline(always)]
#[must_use]
pub fn skip_blanks(mut text: &[u8]) -> &[u8] {
    while let [byte, after @ ..] = text
        && is_blank(*byte)
    {
        text = after;
    }
    text
}

/// The suffix of `text` from the first byte for which `is_end` is true; empty if there is none.
fn skip_until(text: &[u8], is_end: impl Fn(u8) -> bool) -> &[u8] {
    let end = text.iter().position(|&byte| is_end(byte));
    end.and_then(|end| text.get(end..)).unwrap_or_default()
}

/// The text after the next `end`; empty if there is none.
pub(super) fn skip_past(text: &[u8], end: u8) -> &[u8] {
    let after = skip_until(text, |byte| byte == end);
    after.get(1..).unwrap_or_default()
}

/// Whether a byte may stand directly after a number: a blank, or the begin of something else.
const fn may_follow(byte: u8) -> bool {
    is_blank(byte) || byte.is_ascii_alphabetic() || matches!(byte, b';' | b'(' | b'"')
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        let letter = loop {
            let (&byte, tail) = self.remaining.split_first()?;
            // Small letters differ from capitals by this bit.
            let capital = byte & !0x20;
            if capital.is_ascii_uppercase() {
                self.remaining = tail;
                break capital;
            }
            self.remaining = match byte {
                byte if is_blank(byte) => tail,
                b';' => &[],
                b'(' => skip_past(tail, b')'),
                b'"' => self.skip_quoted(tail).1,
                _ => {
                    self.has_loose = true;
                    skip_until(tail, ends_rubbish)
                }
            };
        };
        let value = skip_blanks(self.remaining);
        if let [b'"', tail @ ..] = value {
            let (quoted, after) = self.skip_quoted(tail);
            self.remaining = after;
            return Some(Word { letter, number: None, quoted: Some(quoted), is_odd: false });
        }
        let (number, glued) = match Number::read(value) {
            Some((number, after)) => (Some(number), after),
            None => (None, self.remaining),
        };
        self.remaining = glued;
        // Most words end here.
        let is_odd = glued.first().is_some_and(|byte| !may_follow(*byte));
        if is_odd {
            self.skip_glued();
        }
        Some(Word { letter, number, quoted: None, is_odd })
    }
}

impl<'a> Words<'a> {
    /// Skips what is glued to a word that ends here: characters of numbers and of lists, and anything else up to the
    /// next blank.
    #[cold]
    #[inline(never)]
    fn skip_glued(&mut self) {
        let is_of_list = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.' | b':' | b',');
        let mut after = skip_until(self.remaining, |byte| !is_of_list(byte));
        if after.first().is_some_and(|byte| !may_follow(*byte)) {
            after = skip_until(after, ends_rubbish);
        }
        let glued = self.remaining.get(..self.remaining.len() - after.len()).unwrap_or_default();
        self.has_odd = true;
        self.has_loose |= glued.iter().any(|byte| !byte.is_ascii_graphic());
        self.remaining = after;
    }

    /// The text up to the quotes that end it, and the text after them.
    fn skip_quoted(&mut self, text: &'a [u8]) -> (&'a [u8], &'a [u8]) {
        let quoted = text.split(|byte| *byte == b'"').next().unwrap_or_default();
        self.has_loose |= quoted.len() == text.len();
        (quoted, text.get(quoted.len() + 1..).unwrap_or_default())
    }
}

/// The last word with this `letter`.
pub(super) fn last(text: &[u8], letter: u8) -> Option<Word<'_>> {
    Words::new(text).filter(|word| word.letter == letter).last()
}

/// The number of the last word with this `letter`. Inlined, it would be there twice in each line's reader.
#[inline(never)]
pub(super) fn number(text: &[u8], letter: u8) -> Option<Number> {
    last(text, letter)?.number
}

/// The numbers of the last words with each of these letters.
#[must_use]
pub fn numbers<const N: usize>(text: &[u8], letters: &[u8; N]) -> [Option<Number>; N] {
    let mut numbers = [None; N];
    read_numbers(text, letters, &mut numbers);
    numbers
}

/// The same for any number of letters.
#[inline(never)]
fn read_numbers(text: &[u8], letters: &[u8], numbers: &mut [Option<Number>]) {
    for word in Words::new(text) {
        for (letter, number) in letters.iter().zip(&mut *numbers) {
            if *letter == word.letter {
                *number = word.number;
            }
        }
    }
}

/// Whether there is a word with this `letter`.
#[inline(never)]
pub(super) fn has(text: &[u8], letter: u8) -> bool {
    Words::new(text).any(|word| word.letter == letter)
}

/// Whether text that is no word ends before this byte.
const fn ends_rubbish(byte: u8) -> bool {
    is_blank(byte) || matches!(byte, b';' | b'(' | b'"')
}

/// The switch in S: S0 is off, any other S is on.
pub(super) fn switch(text: &[u8]) -> Option<bool> {
    last(text, b'S').map(|word| word.number != Some(Number::ZERO))
}

#[cfg(test)]
mod tests;
