//! Framing: bytes become one line, with its comment taken out and its checksum worked out on the way.
//!
//! The checksum is the XOR of everything before the last `*`, so the sum is noted at every `*` and the
//! digits after it are read as they come. A line of any length is therefore verified, although only its
//! first [`CAPACITY`] bytes are kept: a slicer's object outline may be 9 kB long, and a host that reads
//! `checksum mismatch` would send it again for ever.
//!
//! A `;` begins a comment, but not within `( )`, which is a comment of its own that stays in the text: `(a;b)` is one
//! (printcore's regular expression takes it so). Whether a parenthesis is closed is known at its end, so the `;` in it is
//! noted until then.
//!
//! People who type may erase characters. Nothing is erased where a line begins with N, or in the middle of numbered lines:
//! that is a host's line, and damaged.

use super::checksum::{Checksum, ChecksumReader};
use super::syntax::{is_blank, line_number};

/// Bytes of a line that are kept: 256 of payload and room for the line number.
pub(super) const CAPACITY: usize = 288;

/// What terminals send for the key that erases a character: backspace, or delete.
pub(super) const fn is_erasing(byte: u8) -> bool {
    matches!(byte, 0x08 | 0x7F)
}

/// Where in the text of a line the next byte stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Context {
    Plain,
    Quoted,
    Comment,
}

/// A line in the making.
pub(super) struct Frame {
    text: [u8; CAPACITY],
    /// Length without comment, counted on where `text` is full.
    length: usize,
    sum: u8,
    checksum: Option<ChecksumReader>,
    context: Context,
    /// Bytes of the comment.
    comment: usize,
    /// Whether a parenthesis is open.
    is_aside: bool,
    /// Where the first `;` stands in it: a comment begins there if it is never closed.
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

    /// Whether nothing of a line has come yet.
    pub(super) fn is_empty(&self) -> bool {
        self.length == 0 && self.context == Context::Plain
    }

    /// Takes as many of `bytes` as mean nothing by themselves, and says how many: most of a line, so this is the loop
    /// in which its time is spent.
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

    /// The same of a line that may have been typed, in which characters are erased.
    pub(super) fn push_typed(&mut self, byte: u8) {
        if is_erasing(byte) && !matches!(self.text().first(), Some(b'N' | b'n')) {
            self.erase();
        } else {
            self.push(byte);
        }
    }

    /// Forgets the byte that came last.
    fn erase(&mut self) {
        if self.context == Context::Comment {
            self.comment = self.comment.saturating_sub(1);
            if self.comment == 0 {
                self.context = Context::Plain;
            }
        } else if self.length > CAPACITY {
            self.length -= 1;
        } else {
            let (text, length, is_damaged) = (self.text, self.length.saturating_sub(1), self.is_damaged);
            self.clear();
            text.iter().take(length).for_each(|byte| self.push(*byte));
            self.is_damaged = is_damaged;
        }
    }

    /// Takes a byte of the line; its end is not one of them.
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
                // Within another one it says that the other is none.
                if let Some(semicolon) = self.semicolon.take() {
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

    /// Whether the line has a number in front.
    pub(super) fn is_numbered(&self) -> bool {
        line_number(self.text()).is_some()
    }

    /// Length of the line without comment.
    fn length(&self) -> usize {
        self.semicolon.unwrap_or(self.length)
    }

    /// The line without comment, as far as it was kept.
    pub(super) fn text(&self) -> &[u8] {
        self.text.get(..self.length()).unwrap_or(&self.text)
    }

    /// As [`text`](Self::text), up to the checksum.
    pub(super) fn before_checksum(&self) -> &[u8] {
        let text = self.text();
        self.checksum.and_then(|checksum| text.get(..checksum.length)).unwrap_or(text)
    }

    /// Whether the line was longer than what is kept of it.
    pub(super) fn is_too_long(&self) -> bool {
        self.length() > CAPACITY
    }

    /// Whether the part before the checksum was longer than what is kept of it.
    pub(super) fn is_too_long_before_checksum(&self) -> bool {
        self.checksum.map_or(self.length(), |checksum| checksum.length.min(self.length())) > CAPACITY
    }

    /// What the checksum says.
    pub(super) fn checksum(&self) -> Checksum {
        self.checksum.map_or(Checksum::Missing, ChecksumReader::checksum)
    }

    /// Whether the line ends in something like a checksum, right or wrong, perhaps inside a comment.
    pub(super) fn ends_in_number(&self) -> bool {
        self.checksum.is_some_and(ChecksumReader::is_number)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    fn frame(line: &str) -> Frame {
        let mut bytewise = Frame::new();
        line.bytes().for_each(|byte| bytewise.push_typed(byte));
        // The same in runs.
        let mut frame = Frame::new();
        let mut after = line.as_bytes();
        while let Some((first, tail)) = after.split_first() {
            let count = frame.push_plain(after);
            after = if count > 0 { &after[count..] } else { tail };
            if count == 0 {
                frame.push_typed(*first);
            }
        }
        assert_eq!(
            (frame.text(), frame.checksum(), frame.length),
            (bytewise.text(), bytewise.checksum(), bytewise.length)
        );
        frame
    }

    fn is_good(frame: &Frame) -> bool {
        matches!(frame.checksum(), Checksum::Good(_))
    }

    #[test]
    fn the_sum_of_a_real_line() {
        // As printcore opens a print.
        assert!(is_good(&frame("N-1 M110 N-1*125")));
        assert!(is_good(&frame("N0 M110 N0*125")));
        assert!(is_good(&frame("N1 M115*39")));
        assert_eq!(frame("N1 M115*39").before_checksum(), b"N1 M115");
        assert_eq!(frame("N1 M115*38").checksum(), Checksum::Bad);
        assert_eq!(frame("N1 M115").checksum(), Checksum::Missing);
    }

    #[test]
    fn what_may_follow_a_checksum() {
        for line in ["N1 M115*39  ", "N1 M115*39 ;x", "N1 M115* 39", "  N1 M115*39", "N1 M115*039"] {
            assert!(is_good(&frame(line)), "{line}");
        }
        for line in ["N1 M115*39x", "N1 M115*", "N1 M115*295", "N1 M115*3 9", "N1 M115*65575", "N1 M115*-39"] {
            assert_eq!(frame(line).checksum(), Checksum::Bad, "{line}");
        }
    }

    #[test]
    fn the_last_asterisk_counts_wherever_it_stands() {
        for body in ["N5 M117 2*3*4", "N5 G1 X1 ;a*b", "N5 M117 \"*\"", "N5 M117 a\\*b"] {
            let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
            assert!(is_good(&frame(&std::format!("{body}*{sum}"))), "{body}");
        }
    }

    #[test]
    fn comments_are_taken_out_but_not_of_strings() {
        assert_eq!(frame("G1 X5 ;Y6").text(), b"G1 X5 ");
        assert_eq!(frame("; all of it").text(), b"");
        assert_eq!(frame("M862.3 P\"a;b\" ;c").text(), b"M862.3 P\"a;b\" ");
        assert_eq!(frame("M117 a\\;b;c").text(), b"M117 a\\;b");
        // A backslash concerns the next byte alone.
        assert_eq!(frame("M117 a\\b;c").text(), b"M117 a\\b");
        assert_eq!(frame("M117 5\" pipe ;b").text(), b"M117 5\" pipe ;b");
    }

    #[test]
    fn a_semicolon_in_parentheses_begins_no_comment() {
        for (line, text) in [
            ("G1 X5 (a;b) Y6 ;c", "G1 X5 (a;b) Y6 "),
            ("G1 (a) X5 ;b (c) d", "G1 (a) X5 "),
            ("G1 X5 (a ; b", "G1 X5 (a "),
            ("G1 X5 (a;(b) c", "G1 X5 (a"),
            ("G1 X5 (a(b;c) Y6", "G1 X5 (a(b;c) Y6"),
            ("G1 X5 (5\";b) Y6;c", "G1 X5 (5\";b) Y6"),
            ("G1 X5 ) Y6;c", "G1 X5 ) Y6"),
            ("M117 \"(\" ;c", "M117 \"(\" "),
        ] {
            assert_eq!(frame(line).text(), text.as_bytes(), "{line}");
        }
        let line = "N5 G1 X5 (a;b) Y6";
        let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
        let whole = frame(&std::format!("{line}*{sum}"));
        assert!(is_good(&whole) && whole.before_checksum() == line.as_bytes());
        assert!(!frame(&std::format!("G1 X5 (a;{}", "x".repeat(9000))).is_too_long());
    }

    #[test]
    fn what_is_typed_can_be_erased_and_what_a_host_sends_cannot() {
        for (line, text) in [
            ("G1 X10\x08\x085", "G1 X5"),
            ("\x08\x7FG28\x08\x7F1\x7F0", "G0"),
            ("G1 X5 ;ab\x08\x08\x08Y6", "G1 X5 Y6"),
            ("P\"a;\x08\x08b\";c", "P\"b\""),
            ("G1 (;\x08\x08X5;c", "G1 X5"),
            ("G1*34\x08\x08\x08 X5", "G1 X5"),
            ("G28\x08\x08\x08\x08", ""),
        ] {
            assert_eq!(frame(line).text(), text.as_bytes(), "{line:?}");
        }
        assert_eq!(frame("G1*34\x08\x08\x08").checksum(), Checksum::Missing);
        // A damaged line of a host keeps what was damaged, or it might pass: HH became H and a backspace.
        let sum = "N5 M117 HH".bytes().fold(0, |sum, byte| sum ^ byte);
        assert_eq!(frame(&std::format!("N5 M117 H\x08*{sum}")).checksum(), Checksum::Bad);
        let long = std::format!("M117 {}{}", "x".repeat(9000), "\x08".repeat(9000));
        assert_eq!(frame(&long).text(), b"M117 ");
    }

    #[test]
    fn a_long_line_is_verified_to_its_end() {
        let body = std::format!("N7 M117 {}", "x".repeat(9000));
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        let long = frame(&std::format!("{body}*{sum}"));
        assert!(is_good(&long));
        assert!(long.is_too_long_before_checksum());
        assert_eq!(long.text(), &body.as_bytes()[..CAPACITY]);
        assert!(!frame(&std::format!("G1 X5;{}", "x".repeat(9000))).is_too_long());
    }

    #[test]
    fn a_full_line_may_still_have_a_checksum() {
        let body = std::format!("N7 M117 {}", "x".repeat(CAPACITY - 8));
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        let full = frame(&std::format!("{body}*{sum}"));
        assert!(is_good(&full));
        assert!(!full.is_too_long_before_checksum());
        assert_eq!(full.before_checksum(), body.as_bytes());
    }
}
