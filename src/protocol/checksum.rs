//! Checksum: the number after a line's `*`, compared with the XOR of the bytes before.

use super::syntax::is_blank;

/// Result of the comparison.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Checksum {
    /// There is no `*`.
    Missing,
    /// It is right; its value.
    Good(u8),
    /// It is wrong, or no number at all.
    Bad,
}

/// State of the reader after a `*`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tail {
    /// Blanks at most.
    Nothing,
    /// Digits.
    Digits,
    /// Digits, then blanks.
    Blanks,
    /// Digits, then a comment.
    Comment,
    /// Something else.
    Rubbish,
}

/// Reads the number after a `*`, until another `*` follows.
#[derive(Clone, Copy)]
pub(super) struct ChecksumReader {
    /// Length of the line before the `*`.
    pub(super) length: usize,
    /// XOR of the bytes before the `*`.
    sum: u8,
    /// The number after the `*`.
    claim: u16,
    tail: Tail,
}

impl ChecksumReader {
    /// A `*` after `length` bytes with the XOR `sum`.
    pub(super) const fn new(length: usize, sum: u8) -> Self {
        Self { length, sum, claim: 0, tail: Tail::Nothing }
    }

    /// Whether the number after the `*` is the sum.
    pub(super) fn checksum(self) -> Checksum {
        if self.is_number() && self.claim == u16::from(self.sum) { Checksum::Good(self.sum) } else { Checksum::Bad }
    }

    /// Reads on after the `*`.
    pub(super) fn read(&mut self, byte: u8) {
        self.tail = match (self.tail, byte) {
            (Tail::Nothing | Tail::Digits, b'0'..=b'9') => {
                self.claim = self.claim.saturating_mul(10).saturating_add(u16::from(byte - b'0'));
                Tail::Digits
            }
            (Tail::Digits | Tail::Blanks, b';') => Tail::Comment,
            (Tail::Digits | Tail::Blanks, _) if is_blank(byte) => Tail::Blanks,
            (Tail::Nothing, _) if is_blank(byte) => Tail::Nothing,
            (Tail::Comment, _) => Tail::Comment,
            _ => Tail::Rubbish,
        };
    }

    /// Whether a number and nothing else follows the `*`.
    pub(super) fn is_number(self) -> bool {
        matches!(self.tail, Tail::Digits | Tail::Blanks | Tail::Comment)
    }
}
