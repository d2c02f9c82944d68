//! Numbering: is this the line we wait for, and did it come through whole?
//!
//! The order of the questions is Marlin's (queue.cpp): first the number, then the checksum. Three things
//! are better than there: M110 is recognised as the command and not as a piece of text; an unnumbered line
//! with a checksum is a numbered line that lost its head, and is asked for again; a numbered line with
//! nothing in it is acknowledged.
//!
//! A host that sends several lines ahead goes on with lines that are stale once one was refused. They are
//! acknowledged in silence, because every request makes such a host send everything again.

use super::framing::{Checksum, Frame};
use super::words::{ends_in_checksum, find_line_number, line_number, m_code, skip_blanks, trim_end};
use crate::units::Instant;

/// A request is repeated after this time, should it have been lost itself.
const ASK_AGAIN_MS: u32 = 1000;

/// Stale lines that are passed over in silence. OctoPrint can repeat its last 50 lines only (comm.py,
/// lastLineBufferSize), so the request must be repeated well before that.
const STALE_LINES: u8 = 20;

/// Why a line is asked for again; [`Replies::resend`](super::Replies::resend) has the words.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResendReason {
    /// Its number is not the next one.
    LineNumber,
    /// Its checksum is wrong, or part of the line was lost.
    ChecksumMismatch,
    /// It is numbered but has no checksum.
    NoChecksum,
}

/// What to make of a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Verdict {
    /// A command, which lies in the frame's text.
    Command {
        /// Where the command ends in the frame's text.
        end: usize,
        /// Its length.
        length: usize,
    },
    /// Nothing to do but `ok`.
    Acknowledge,
    /// M110 was carried out.
    LineNumber {
        /// The number to report, if M110 asked for it.
        report: Option<i32>,
    },
    /// The line is in order, but too long to be kept.
    TooLong,
    /// The line after `last` must be sent again.
    Resend {
        /// What was wrong.
        reason: ResendReason,
        /// The last line that was in order.
        last: i32,
    },
}

/// A line that was asked for and has not come yet.
#[derive(Clone, Copy)]
struct Request {
    at: Instant,
    /// The number of the line that was refused most recently. Stale lines of one burst rise.
    refused: i32,
    /// Lines passed over since.
    stale: u8,
}

/// The line numbers of a connection.
pub(super) struct Numbering {
    last: i32,
    request: Option<Request>,
}

impl Numbering {
    /// As after a reset: line 1 comes next.
    pub(super) const fn new() -> Self {
        Self { last: 0, request: None }
    }

    /// The last line that was in order.
    pub(super) const fn last(&self) -> i32 {
        self.last
    }

    /// Judges a complete line; `None` if there is nothing in it that asks for an answer.
    pub(super) fn judge(&mut self, frame: &Frame, now: Instant) -> Option<Verdict> {
        if frame.is_damaged() {
            return Some(self.damaged(now));
        }
        match line_number(frame.text()) {
            Some((number, _)) => Some(self.judge_numbered(number, frame, now)),
            None => self.judge_bare(frame, now),
        }
    }

    /// A line of which a part was lost.
    pub(super) fn damaged(&mut self, now: Instant) -> Verdict {
        self.ask(ResendReason::ChecksumMismatch, self.last, now)
    }

    /// A line with a number in front.
    fn judge_numbered(&mut self, number: i32, frame: &Frame, now: Instant) -> Verdict {
        let before = trim_end(frame.before_checksum());
        let payload = skip_blanks(line_number(before).map_or(&[], |(_, rest)| rest));
        let new_number = match m_code(payload) {
            Some((110, words)) => Some(find_line_number(words).unwrap_or(number)),
            _ => None,
        };
        if new_number.is_none() && Some(number) != self.last.checked_add(1) {
            return self.refuse_number(number, now);
        }
        match frame.checksum() {
            Checksum::Missing => return self.ask(ResendReason::NoChecksum, number, now),
            Checksum::Bad => return self.ask(ResendReason::ChecksumMismatch, number, now),
            Checksum::Good => self.accept(new_number.unwrap_or(number)),
        }
        if new_number.is_some() {
            Verdict::LineNumber { report: None }
        } else if frame.is_too_long_before_checksum() {
            Verdict::TooLong
        } else if payload.is_empty() {
            Verdict::Acknowledge
        } else {
            Verdict::Command { end: before.len(), length: payload.len() }
        }
    }

    /// A line without a number in front.
    fn judge_bare(&mut self, frame: &Frame, now: Instant) -> Option<Verdict> {
        let text = trim_end(frame.text());
        if text.is_empty() {
            // Hosts take comments out before they add checksums, so one with a checksum was a line whose N
            // came through as a semicolon. Unanswered, its host would wait for ever.
            let was_line = frame.ends_in_number();
            return was_line.then(|| self.damaged(now));
        }
        let code = m_code(text);
        let is_headless = if frame.is_too_long() { frame.ends_in_number() } else { ends_in_checksum(text) };
        if let Some((110, words)) = code
            && (!is_headless || frame.checksum() == Checksum::Good)
        {
            let number = find_line_number(words);
            let report = if number.is_none() { Some(self.last) } else { None };
            self.accept(number.unwrap_or(self.last));
            return Some(Verdict::LineNumber { report });
        }
        // A message may end in "50*2". Even if it did lose its head, showing it twice does no harm.
        let is_message = matches!(code, Some((117 | 118, _)));
        Some(if is_headless && !is_message {
            self.ask(ResendReason::ChecksumMismatch, self.last, now)
        } else if frame.is_too_long() {
            Verdict::TooLong
        } else {
            Verdict::Command { end: text.len(), length: text.len() }
        })
    }

    /// Counts on from `number`.
    const fn accept(&mut self, number: i32) {
        self.last = number;
        self.request = None;
    }

    /// Answers a line whose turn it is not.
    fn refuse_number(&mut self, number: i32, now: Instant) -> Verdict {
        if let Some(request) = &mut self.request
            && number > request.refused
            && request.stale < STALE_LINES
            && now < request.at.after_ms(ASK_AGAIN_MS)
        {
            request.refused = number;
            request.stale += 1;
            return Verdict::Acknowledge;
        }
        self.ask(ResendReason::LineNumber, number, now)
    }

    /// Asks for the next line; `refused` is the number of the line that came instead.
    const fn ask(&mut self, reason: ResendReason, refused: i32, now: Instant) -> Verdict {
        self.request = Some(Request { at: now, refused, stale: 0 });
        Verdict::Resend { reason, last: self.last }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;

    /// A numbering at `last`, and the verdict on one line after the other.
    struct Story(Numbering);

    const OK: Verdict = Verdict::Acknowledge;

    fn resend(reason: ResendReason, last: i32) -> Verdict {
        Verdict::Resend { reason, last }
    }

    impl Story {
        fn at(last: i32) -> Self {
            Self(Numbering { last, request: None })
        }

        fn raw(&mut self, line: &str, ms: u32) -> Option<Verdict> {
            let mut frame = Frame::new();
            line.bytes().for_each(|byte| frame.push(byte));
            self.0.judge(&frame, Instant(0).after_ms(ms))
        }

        /// An empty line of that number, so that it is acknowledged whether it is taken or passed over.
        fn line(&mut self, number: i64, ms: u32) -> Verdict {
            let body = format!("N{number} ");
            let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
            self.raw(&format!("{body}*{sum}"), ms).unwrap()
        }
    }

    #[test]
    fn a_burst_of_stale_lines_is_asked_for_once() {
        let mut story = Story::at(18);
        assert_eq!(story.line(20, 0), resend(ResendReason::LineNumber, 18));
        for number in 21..=26 {
            assert_eq!(story.line(number, 10), OK);
        }
        assert_eq!(story.0.last(), 18);
        assert_eq!(story.line(19, 20), OK);
        assert_eq!(story.0.last(), 19);
        assert_eq!(story.line(21, 30), resend(ResendReason::LineNumber, 19));
    }

    #[test]
    fn a_host_that_starts_over_at_the_wrong_line_is_told_again() {
        let mut story = Story::at(18);
        assert_eq!(story.line(20, 0), resend(ResendReason::LineNumber, 18));
        assert_eq!(story.line(21, 1), OK);
        assert_eq!(story.line(20, 2), resend(ResendReason::LineNumber, 18));
        assert_eq!(story.line(20, 3), resend(ResendReason::LineNumber, 18));
    }

    #[test]
    fn a_request_that_was_itself_lost_is_repeated() {
        let mut story = Story::at(18);
        assert_eq!(story.line(20, 0), resend(ResendReason::LineNumber, 18));
        assert_eq!(story.line(21, 999), OK);
        assert_eq!(story.line(22, 1000), resend(ResendReason::LineNumber, 18));
        let asked_again = (23..).find(|&number| story.line(number, 1001) != OK);
        assert_eq!(asked_again, Some(23 + i64::from(STALE_LINES)));
    }

    #[test]
    fn an_old_line_is_refused_and_those_behind_it_are_passed_over() {
        let mut story = Story::at(18);
        assert_eq!(story.line(16, 0), resend(ResendReason::LineNumber, 18));
        assert_eq!(story.line(17, 0), OK);
        assert_eq!(story.line(18, 0), OK);
        assert_eq!(story.line(19, 0), OK);
        assert_eq!(story.0.last(), 19);
    }

    #[test]
    fn a_damaged_line_is_always_asked_for_again() {
        let mut story = Story::at(4);
        for _ in 0..3 {
            let verdict = story.raw("N5 G1*1", 0);
            assert_eq!(verdict, Some(resend(ResendReason::ChecksumMismatch, 4)));
        }
        assert_eq!(story.raw("N5 G1", 0), Some(resend(ResendReason::NoChecksum, 4)));
    }

    #[test]
    fn the_number_is_questioned_before_the_checksum() {
        let wrong_number = Some(resend(ResendReason::LineNumber, 4));
        assert_eq!(Story::at(4).raw("N7 G1*1", 0), wrong_number);
        assert_eq!(Story::at(4).raw("N7 G1", 0), wrong_number);
    }

    #[test]
    fn numbers_reach_the_ends_of_32_bits() {
        let mut story = Story::at(i32::MAX - 1);
        assert_eq!(story.line(i64::from(i32::MAX), 0), OK);
        assert_eq!(story.0.last(), i32::MAX);
        assert_eq!(story.line(i64::from(i32::MAX) + 1, 0), resend(ResendReason::LineNumber, i32::MAX));
        let mut story = Story::at(i32::MIN);
        assert_eq!(story.line(i64::from(i32::MIN) + 1, 0), OK);
        assert_eq!(Story::at(999_999).line(1_000_000, 0), OK);
        assert_eq!(Story::at(-2).line(-1, 0), OK);
    }
}
