//! Framing: bytes become one line, without its comment, and its checksum is computed on the way.
//!
//! The checksum is the XOR of everything before the last `*`. So the sum is stored at every `*`, and the digits after
//! it are read as they come. This verifies a line of any length, although only its first [`CAPACITY`] bytes are kept. A
//! slicer's object outline may be 9 kB long, and a host that reads `checksum mismatch` would send it again for ever.
//!
//! A `;` begins a comment, but not within `( )`, which is a comment that stays in the text: `(a;b)` is one comment, as
//! in printcore's regular expression. Only the end shows whether a parenthesis is closed, so the `;` in it is stored
//! until then.
//!
//! People who type may erase characters. Nothing is erased in a line that begins with N, or between numbered lines:
//! these come from a host, and the byte is damage.

use super::checksum::{Checksum, ChecksumReader};
use super::syntax::{is_blank, line_number};

/// Bytes of a line that are kept: 256 of payload and room for the line number.
pub const CAPACITY: usize = 288;

/// The bytes that a terminal sends to erase a character: backspace, or delete.
pub(super) const fn is_erasing(byte: u8) -> bool {
    matches!(byte, 0x08 | 0x7F)
}

/// Context of the next byte in the text of a line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Context {
    Plain,
    Quoted,
    Comment,
}

/// An incomplete line.
pub(super) struct Frame {
    text: [u8; CAPACITY],
    /// Length without comment; counted further when `text` is full.
    length: usize,
    sum: u8,
    checksum: Option<ChecksumReader>,
    context: Context,
    /// Bytes of the comment.
    comment: usize,
    /// Whether a parenthesis is open.
    is_aside: bool,
    /// Place of the first `;` in it: a comment begins there if it is never closed.
    semicolon: Option<usize>,
    is_escaped: bool,
    is_damaged: bool,
}

impl Frame {
    /// An empty line.
    pub(super) const fn new() -> Self {
        Self {
            text: [0; CAPACITY],
            length: 0,
            sum: 0,
            checksum: None,
            context: Context::Plain,
            comment: 0,
            is_aside: false,
            semicolon: None,
            is_escaped: false,
            is_damaged: false,
        }
    }

    /// Makes the line empty again.
    pub(super) const fn clear(&mut self) {
        self.length = 0;
        self.sum = 0;
        self.checksum = None;
        self.context = Context::Plain;
        self.comment = 0;
        self.is_aside = false;
        self.semicolon = None;
        self.is_escaped = false;
        self.is_damaged = false;
    }

    /// Notes that something of this line was lost.
    pub(super) const fn damage(&mut self) {
        self.is_damaged = true;
    }

    /// Whether no byte of a line has come yet.
    pub(super) fn is_empty(&self) -> bool {
        self.length == 0 && self.context == Context::Plain
    }

    /// Whether anything of a line has come, be it damage.
    pub(super) fn has_begun(&self) -> bool {
        self.is_damaged || !self.is_empty()
    }

    /// Takes the leading bytes of `bytes` without special meaning, and returns their count. Most bytes of a line are
    /// such, so this loop takes most of the time.
    pub(super) fn push_plain(&mut self, bytes: &[u8]) -> usize {
        let is_blank_first = self.length == 0 && bytes.first() == Some(&b' ');
        if self.context != Context::Plain || self.checksum.is_some() || is_blank_first {
            return 0;
        }
        let mut sum = self.sum;
        let mut count = 0;
        for (place, &byte) in self.text.iter_mut().skip(self.length).zip(bytes) {
            if byte < b' ' || matches!(byte, b'*' | b';' | b'"' | b'\\' | b'(' | b')' | 0x7F) {
                break;
            }
            *place = byte;
            sum ^= byte;
            count += 1;
        }
        if count > 0 {
            self.is_escaped = false;
            self.sum = sum;
            self.length += count;
        }
        count
    }

    /// As [`push`](Self::push), for a line that may be typed: the erasing keys erase.
    pub(super) fn push_typed(&mut self, byte: u8) {
        if is_erasing(byte) && !matches!(self.text().first(), Some(b'N' | b'n')) {
            self.erase();
        } else {
            self.push(byte);
        }
    }

    /// Erases the last byte.
    fn erase(&mut self) {
        if self.context == Context::Comment {
            self.comment = self.comment.saturating_sub(1);
            if self.comment == 0 {
                self.context = Context::Plain;
            }
        } else if self.length > CAPACITY {
            self.length -= 1;
        } else {
            // What a quote, a parenthesis or a `*` has begun cannot be undone byte by byte, so the line is read again.
            let (text, length, is_damaged) = (self.text, self.length.saturating_sub(1), self.is_damaged);
            self.clear();
            text.iter().take(length).for_each(|byte| self.push(*byte));
            self.is_damaged = is_damaged;
        }
    }

    /// Takes a byte of the line; not its line end.
    pub(super) fn push(&mut self, byte: u8) {
        // Blanks before the line are not part of it (Marlin queue.cpp), nor of its checksum.
        if self.length == 0 && self.context == Context::Plain && is_blank(byte) {
            return;
        }
        if byte == b'*' {
            self.checksum = Some(ChecksumReader::new(self.length, self.sum));
        } else if let Some(checksum) = &mut self.checksum {
            checksum.read(byte);
        }
        self.sum ^= byte;
        if self.is_comment(byte) {
            self.comment += 1;
        } else {
            self.keep(byte);
        }
    }

    /// Adds a byte to the text, or only counts it if there is no room.
    fn keep(&mut self, byte: u8) {
        if let Some(place) = self.text.get_mut(self.length) {
            *place = byte;
        }
        self.length = self.length.saturating_add(1);
    }

    /// Follows quotes and comments; says whether `byte` belongs to a comment.
    fn is_comment(&mut self, byte: u8) -> bool {
        let is_literal = core::mem::replace(&mut self.is_escaped, false);
        match (self.context, byte) {
            (Context::Comment, _) => return true,
            _ if is_literal => {}
            (_, b'\\') => self.is_escaped = true,
            (Context::Plain, b'(') => {
                // An inner parenthesis: the outer one is not a comment, so its `;` begins one.
                if let Some(semicolon) = self.semicolon.take() {
                    self.comment = self.length.saturating_sub(semicolon);
                    self.length = semicolon;
                    self.context = Context::Comment;
                    return true;
                }
                self.is_aside = true;
            }
            (Context::Plain, b')') => (self.is_aside, self.semicolon) = (false, None),
            (Context::Plain, b';') if self.is_aside => self.semicolon = self.semicolon.or(Some(self.length)),
            (Context::Plain, b'"') if !self.is_aside => self.context = Context::Quoted,
            (Context::Quoted, b'"') => self.context = Context::Plain,
            (Context::Plain, b';') => {
                self.context = Context::Comment;
                return true;
            }
            _ => {}
        }
        false
    }

    /// Whether something of the line was lost.
    pub(super) const fn is_damaged(&self) -> bool {
        self.is_damaged
    }

    /// Whether the line begins with a number.
    pub(super) fn is_numbered(&self) -> bool {
        line_number(self.text()).is_some()
    }

    /// Length of the line without comment.
    fn length(&self) -> usize {
        self.semicolon.unwrap_or(self.length)
    }

    /// The kept part of the line, without comment.
    pub(super) fn text(&self) -> &[u8] {
        self.text.get(..self.length()).unwrap_or(&self.text)
    }

    /// As [`text`](Self::text), up to the checksum.
    pub(super) fn before_checksum(&self) -> &[u8] {
        let text = self.text();
        self.checksum.and_then(|checksum| text.get(..checksum.length)).unwrap_or(text)
    }

    /// Whether the line was longer than its kept part.
    pub(super) fn is_too_long(&self) -> bool {
        self.length() > CAPACITY
    }

    /// Whether the part before the checksum was longer than its kept part.
    pub(super) fn is_too_long_before_checksum(&self) -> bool {
        self.checksum.map_or(self.length(), |checksum| checksum.length.min(self.length())) > CAPACITY
    }

    /// The result of the checksum.
    pub(super) fn checksum(&self) -> Checksum {
        self.checksum.map_or(Checksum::Missing, ChecksumReader::checksum)
    }

    /// Whether the line ends in something like a checksum, right or wrong, perhaps inside a comment.
    pub(super) fn ends_in_number(&self) -> bool {
        self.checksum.is_some_and(ChecksumReader::is_number)
    }
}

#[cfg(test)]
mod tests;
