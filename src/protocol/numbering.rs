//! Numbering: is this the expected line, and is it undamaged?
//!
//! The order of the checks is Marlin's (queue.cpp): first the number, then the checksum. Three things are better than
//! there:
//!
//! - M110 is recognised as the command and not as a piece of text.
//! - An unnumbered line with a checksum is a numbered line without its head, and is asked for again.
//! - A numbered line without content is acknowledged.
//!
//! And three things are in no other firmware:
//!
//! - A repeated line is acknowledged. A request for the next line would make the host send that one twice too, and so
//!   on to the end of the print.
//! - A line without a number right after damage is not trusted: it may be a piece of the damaged line.
//! - The very first line may be N0, because printcore cannot repeat the M110 before it.

use super::checksum::Checksum;
use super::framing::Frame;
use super::request::Request;
use super::syntax::{ends_in_checksum, find_line_number, line_number, m_code, skip_blanks, trim_end};
use crate::units::Instant;

/// Numbered lines in a row that make a stream. One line does not: OctoPrint numbers M110 and M115 when it connects, and
/// nothing else until it prints.
const STREAM: u8 = 2;

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

/// Remembered lines: more than a host that sends its next line twice has under way.
const KNOWN: usize = 8;

/// The verdict on a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Verdict {
    /// A command in the frame's text.
    Command {
        /// End of the command in the frame's text.
        end: usize,
        /// Its length.
        length: usize,
    },
    /// Only `ok`.
    Acknowledge,
    /// M110 was carried out.
    LineNumber {
        /// The number to report, if M110 asked for it.
        report: Option<i32>,
    },
    /// The line is valid, but too long to be kept.
    TooLong,
    /// The line after `last` must be sent again.
    Resend {
        /// The reason.
        reason: ResendReason,
        /// The last accepted line.
        last: i32,
    },
}

/// The line numbers of a connection.
pub(super) struct Numbering {
    last: i32,
    /// The checksums of the last lines, by their numbers, and their count since M110.
    sums: [u8; KNOWN],
    known: u8,
    /// Numbered lines in a row, up to [`STREAM`]. In a stream, lines without a number may come between them: printcore
    /// sends M105 there.
    taken: u8,
    /// The last accepted line with a number had a checksum: the host uses checksums.
    is_vouched: bool,
    /// Something was damaged or lost since M110.
    is_bad: bool,
    /// The host is printcore, which waits for an answer for ever.
    waits_for_ever: bool,
    /// No line number has come since the connection was made.
    is_fresh: bool,
    request: Option<Request>,
    /// The request is for lines that arrived whole, for which there was no room: no pieces follow.
    is_trusted: bool,
}

impl Numbering {
    /// As after a reset: line 1 comes next.
    pub(super) const fn new() -> Self {
        Self {
            last: 0,
            sums: [0; KNOWN],
            known: 0,
            taken: 0,
            is_vouched: false,
            is_bad: false,
            waits_for_ever: false,
            is_fresh: true,
            request: None,
            is_trusted: false,
        }
    }

    /// The last accepted line.
    pub(super) const fn last(&self) -> i32 {
        self.last
    }

    /// Whether the host is in the middle of numbered lines.
    pub(super) const fn is_stream(&self) -> bool {
        self.taken >= STREAM
    }

    /// Whether something was damaged or lost since M110.
    pub(super) const fn is_bad(&self) -> bool {
        self.is_bad
    }

    /// Whether the host would wait for an answer for ever.
    pub(super) const fn waits_for_ever(&self) -> bool {
        self.waits_for_ever
    }

    /// The stream ends or pauses; one numbered line is then enough to continue it.
    pub(super) const fn end_stream(&mut self) {
        self.taken = STREAM - 1;
        self.is_vouched = false;
    }

    /// Judges a complete line; `None` if it needs no reply.
    pub(super) fn judge(&mut self, frame: &Frame, now: Instant) -> Option<Verdict> {
        if frame.is_damaged() {
            return Some(self.damaged(now));
        }
        match line_number(frame.text()) {
            Some((number, _)) => Some(self.judge_numbered(number, frame, now)),
            None => self.judge_bare(frame, now),
        }
    }

    /// Judges a line without its line end, which is asked for again. Only a complete M110 is accepted, because hosts do
    /// not repeat it.
    pub(super) fn judge_cut(&mut self, frame: &Frame, now: Instant) -> Verdict {
        match line_number(frame.text()) {
            Some((number, after)) if matches!(m_code(skip_blanks(after)), Some((110, _))) => {
                self.judge_numbered(number, frame, now)
            }
            _ => self.damaged(now),
        }
    }

    /// A line with lost bytes.
    pub(super) fn damaged(&mut self, now: Instant) -> Verdict {
        self.ask(ResendReason::ChecksumMismatch, self.last, now)
    }

    /// Lines were passed over, because there was no room for them.
    pub(super) const fn missed(&mut self, now: Instant) -> Verdict {
        self.ask(ResendReason::LineNumber, self.last, now)
    }

    /// The request is for lines that were passed over.
    pub(super) const fn trust(&mut self) {
        self.is_trusted = true;
    }

    /// A line that begins with a number.
    fn judge_numbered(&mut self, number: i32, frame: &Frame, now: Instant) -> Verdict {
        let before = trim_end(frame.before_checksum());
        let payload = skip_blanks(line_number(before).map_or(&[], |(_, after)| after));
        let new_number = match m_code(payload) {
            Some((110, words)) => Some(find_line_number(words).unwrap_or(number)),
            _ => None,
        };
        if new_number.is_none() && !self.is_next(number) {
            return self.refuse_number(number, frame, now);
        }
        match (frame.checksum(), new_number) {
            (Checksum::Missing, _) => return self.ask(ResendReason::NoChecksum, number, now),
            (Checksum::Bad, _) => return self.ask(ResendReason::ChecksumMismatch, number, now),
            (Checksum::Good(_), Some(new_number)) => {
                // Below zero it is printcore's first line, and the print follows at once; after a stream it is
                // printcore's last.
                let taken = if new_number < 0 && !self.is_stream() { STREAM } else { 0 };
                self.count_from(new_number);
                (self.is_vouched, self.taken, self.waits_for_ever) = (true, taken, new_number < 0);
                return Verdict::LineNumber { report: None };
            }
            (Checksum::Good(sum), None) => self.accept(number, sum),
        }
        if frame.is_too_long_before_checksum() {
            Verdict::TooLong
        } else if payload.is_empty() {
            Verdict::Acknowledge
        } else {
            Verdict::Command { end: before.len(), length: payload.len() }
        }
    }

    /// Whether line `number` is the next one.
    fn is_next(&self, number: i32) -> bool {
        Some(number) == self.last.checked_add(1) || (self.is_fresh && number == 0)
    }

    /// A line that does not begin with a number.
    fn judge_bare(&mut self, frame: &Frame, now: Instant) -> Option<Verdict> {
        let text = trim_end(frame.text());
        if text.is_empty() {
            // Hosts remove comments before they add checksums, so a comment with a checksum was a line whose N arrived
            // as a semicolon. Without a reply, its host would wait for ever.
            let was_line = frame.ends_in_number();
            return was_line.then(|| self.damaged(now));
        }
        let code = m_code(text);
        let is_headless = if frame.is_too_long() { frame.ends_in_number() } else { ends_in_checksum(text) };
        // A message may end in "50*2". If it did lose its head, showing it twice does no harm.
        let is_message = matches!(code, Some((117 | 118, _)));
        let is_verified = matches!(frame.checksum(), Checksum::Good(_));
        let is_urgent = matches!(code, Some((108 | 112 | 410, _)));
        // The pieces of one line are asked for once: the host would count every extra `ok` to the end of the print.
        if !is_verified && (is_headless || !is_urgent) && self.is_doubtful(now) {
            return None;
        }
        Some(match code {
            Some((110, words)) if !is_headless || is_verified => match find_line_number(words) {
                Some(number) => {
                    self.count_from(number);
                    Verdict::LineNumber { report: None }
                }
                None => Verdict::LineNumber { report: Some(self.last) },
            },
            _ if is_headless && !is_message => self.damaged(now),
            _ if self.is_vouched && is_piece(text) => self.damaged(now),
            _ => {
                if !self.is_stream() {
                    self.taken = 0;
                }
                let all = Verdict::Command { end: text.len(), length: text.len() };
                if frame.is_too_long() { Verdict::TooLong } else { all }
            }
        })
    }

    /// Whether a line without a number is more likely a piece of the damaged line before it than a command.
    fn is_doubtful(&self, now: Instant) -> bool {
        self.is_vouched && !self.is_trusted && self.request.is_some_and(|request| request.is_recent(now))
    }

    /// Takes line `number`.
    fn accept(&mut self, number: i32, sum: u8) {
        let taken = if self.taken < STREAM { self.taken + 1 } else { STREAM };
        if let Some(place) = self.sums.get_mut(number as usize % KNOWN) {
            *place = sum;
        }
        let known = if self.known < KNOWN as u8 { self.known + 1 } else { self.known };
        (self.last, self.known, self.taken, self.request) = (number, known, taken, None);
        (self.is_vouched, self.is_fresh, self.is_trusted) = (true, false, false);
    }

    /// Sets the last number to `number`, for M110.
    const fn count_from(&mut self, number: i32) {
        *self = Self { last: number, is_fresh: false, ..Self::new() };
    }

    /// Replies to a line with an unexpected number.
    fn refuse_number(&mut self, number: i32, frame: &Frame, now: Instant) -> Verdict {
        if self.is_repetition(number, frame.checksum())
            || self.request.as_mut().is_some_and(|request| request.passes_over(number, now))
        {
            return Verdict::Acknowledge;
        }
        self.ask(ResendReason::LineNumber, number, now)
    }

    /// Whether it repeats one of the last lines.
    fn is_repetition(&self, number: i32, checksum: Checksum) -> bool {
        let is_known = (0..i64::from(self.known)).contains(&(i64::from(self.last) - i64::from(number)));
        is_known && self.sums.get(number as usize % KNOWN).is_some_and(|sum| checksum == Checksum::Good(*sum))
    }

    /// Asks for the next line; `refused` is the number of the line that came instead.
    const fn ask(&mut self, reason: ResendReason, refused: i32, now: Instant) -> Verdict {
        self.request = Some(Request::new(refused, now));
        self.is_bad = true;
        self.is_trusted = self.is_trusted && matches!(reason, ResendReason::LineNumber);
        Verdict::Resend { reason, last: self.last }
    }
}

/// Whether a line without a number begins like the rest of a numbered one, or with rubbish: no command does.
const fn is_piece(text: &[u8]) -> bool {
    matches!(text, [b'N' | b'n' | b'0'..=b'9' | b'-' | b'+' | ..b' ' | 127.., ..])
}

#[cfg(test)]
mod tests;
