//! The receiver: received bytes become lines in order, and emergencies at once.

use super::emergency::{Emergency, Scanner};
use super::framing::Frame;
use super::numbering::{Numbering, ResendReason, Verdict};
use super::ring::{Ring, SHORT};
use super::silence::{Activity, Prompt, Silence};
use super::sorting::{LineKind, Owed, kind_of};
use super::syntax::{line_number, skip_blanks};
use crate::port::Received;
use crate::units::Instant;

/// A damaged line without an end for this time has lost its end too. A pause within a line is no longer than the
/// latency of the host's USB adapter (FTDI latency timer: 16 ms).
const QUIET_MS: u32 = 100;

/// Lines with a number stay in this part of the ring when room is short: more than a windowed host has under way.
const NUMBERED: usize = 512;

/// A line, or its replacement. Each gets exactly one `ok`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Incoming<'a> {
    /// A command to carry out: verified, or sent without number and checksum. It is not empty, and has no blanks around
    /// it and no `;` comment. It has any bytes but NUL, CR and LF.
    Command(&'a [u8]),
    /// Nothing to carry out: an empty numbered line, or a stale one while a request is open. Or nothing arrived, and
    /// the host may wait because a line or its `ok` was lost.
    Acknowledge,
    /// M110 was carried out.
    LineNumber {
        /// The line number, if a bare M110 asked for it.
        report: Option<i32>,
    },
    /// The line is valid, but too long to be carried out.
    TooLong,
    /// The host must send again from the line after `last`.
    Resend {
        /// The reason.
        reason: ResendReason,
        /// The last accepted line.
        last: i32,
    },
    /// The host has been silent for too long, and is asked for the line after `last` (see `silence`).
    Question {
        /// The last accepted line.
        last: i32,
    },
}

/// Turns received bytes into lines. Put bytes in with [`feed`](Self::feed) as they arrive, take lines out
/// with [`next_line`](Self::next_line) when there is time for one.
pub struct Receiver {
    ring: Ring,
    scanner: Scanner,
    frame: Frame,
    /// Whether `frame` holds a line that `next_line` has returned.
    is_frame_done: bool,
    numbering: Numbering,
    silence: Silence,
    /// The place in the stream up to which lines are sorted, if that is not behind.
    sorted: u32,
    /// The line that arrives is passed over: there is no room for it, and it has a number.
    is_skipping: bool,
    /// Lines that were passed over, and have to be asked for again.
    missing: u32,
    /// Lines up to this place are overtaken by a stop.
    overtaken: Option<u32>,
    owed: Owed,
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

impl Receiver {
    /// A receiver as after a reset: line 1 comes next.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ring: Ring::new(),
            scanner: Scanner::new(),
            frame: Frame::new(),
            is_frame_done: false,
            numbering: Numbering::new(),
            silence: Silence::new(),
            sorted: 0,
            is_skipping: false,
            missing: 0,
            overtaken: None,
            owed: Owed::new(),
        }
    }

    /// Whether another byte can be fed without loss. More bytes are still searched for emergencies, but damage the
    /// line.
    #[must_use]
    pub const fn has_room(&self) -> bool {
        self.ring.has_room()
    }

    /// Bytes that can be fed without loss.
    #[must_use]
    pub const fn room(&self) -> usize {
        self.ring.room()
    }

    /// Whether another byte can be fed, and there is room to see what the line behind it is.
    #[must_use]
    pub const fn has_spare(&self) -> bool {
        self.ring.length() < SHORT || self.is_skipping
    }

    /// Whether another byte can be fed, and nothing is lost that its host would not repeat. Call it when room is short
    /// and lines have to wait: some are taken out of their turn ([`owed`](Self::owed)), or asked for again later.
    pub fn makes_room(&mut self) -> bool {
        self.sort_out();
        let tail = self.ring.line(self.ring.entries_up_to(self.sorted));
        self.has_spare() || (kind_of(&tail) == LineKind::Unknown && self.ring.has_room())
    }

    /// Takes out the lines that need not stay.
    fn sort_out(&mut self) {
        let Self { ring, sorted, is_skipping, missing, overtaken, owed, .. } = self;
        let (_, oldest) = ring.places();
        let mut from = ring.entries_up_to(*sorted);
        if from == 0 && !self.is_frame_done && self.frame.has_begun() {
            // The rest of a line that has begun before.
            let rest = ring.line(0);
            if !rest.is_whole {
                return;
            }
            from = rest.length;
        }
        *sorted = oldest.wrapping_add(from as u32);
        ring.retain(from, overtaken, |place, line| {
            let kind = kind_of(line);
            let is_passed_over = kind == LineKind::Numbered && place + line.length > NUMBERED;
            *is_skipping |= is_passed_over && !line.is_whole;
            *missing += u32::from(is_passed_over && line.is_whole);
            let stays = !(is_passed_over || line.is_whole && owed.takes(kind));
            if stays && line.is_whole {
                *sorted = oldest.wrapping_add((place + line.length) as u32);
            }
            stays
        });
    }

    /// Answers the reports that wait before any other line; for the position only while the program `rests` at it. An
    /// emergency has its turn behind the line that it ends.
    pub fn answer_reports(&mut self, rests: bool) {
        if !self.is_frame_done && self.frame.has_begun() {
            return;
        }
        loop {
            let line = self.ring.line(0);
            let kind = kind_of(&line);
            let waits = match kind {
                LineKind::Acted => true,
                LineKind::Position { .. } => !rests,
                _ => false,
            };
            if !line.is_whole || waits || !self.owed.takes(kind) {
                return;
            }
            self.ring.skip(line.length);
        }
    }

    /// What the host is owed for lines that were taken out of their turn. Whoever answers takes it off.
    pub const fn owed(&mut self) -> &mut Owed {
        &mut self.owed
    }

    /// Takes received bytes; returns an emergency command at the end of its line. [`next_line`](Self::next_line) also
    /// returns that line, which gets its reply there.
    #[inline]
    pub fn feed(&mut self, received: Received) -> Option<Emergency> {
        match received {
            // Nearly all.
            Received::Byte(byte) if !self.is_skipping => {
                self.ring.push_byte(byte);
                self.scanner.read(byte)
            }
            received => {
                self.put(received);
                self.scan(received)
            }
        }
    }

    /// Searches for emergencies in what has arrived and is [`put`](Self::put) in later.
    pub const fn scan(&mut self, received: Received) -> Option<Emergency> {
        match received {
            Received::Byte(byte) => return self.scanner.read(byte),
            Received::Lost => self.scanner.spoil(),
            Received::Opened => {}
        }
        None
    }

    /// The same as [`feed`](Self::feed) of what was searched before.
    pub fn put(&mut self, received: Received) {
        if received == Received::Opened {
            *self = Self::new();
        } else if !self.is_skipping {
            self.ring.push(received);
        } else if matches!(received, Received::Byte(b'\n' | b'\r')) {
            self.is_skipping = false;
            self.missing += 1;
        }
    }

    /// Whether all received bytes have been read.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.ring.is_empty()
    }

    /// The place in the stream up to which bytes have been fed.
    #[must_use]
    pub const fn place(&self) -> u32 {
        self.ring.places().0
    }

    /// Whether the last returned line ended at or before a [`place`](Self::place).
    #[must_use]
    pub const fn is_within(&self, place: u32) -> bool {
        place.wrapping_sub(self.ring.places().1) as i32 >= 0
    }

    /// A stop overtakes all lines so far, and as many more bytes.
    pub const fn overtake(&mut self, ahead: u32) {
        self.overtaken = Some(self.place().wrapping_add(ahead));
    }

    /// Whether a stop has overtaken the last returned line.
    pub fn is_overtaken(&mut self) -> bool {
        self.overtaken = self.overtaken.filter(|place| self.is_within(*place));
        self.overtaken.is_some()
    }

    /// The kept part of the last returned line, after its line number. A line that is too long is cut at its end.
    #[must_use]
    pub fn kept(&self) -> &[u8] {
        let text = self.frame.text();
        line_number(text).map_or(text, |(_, after)| skip_blanks(after))
    }

    /// The number of the last accepted line.
    #[must_use]
    pub const fn last_line(&self) -> i32 {
        self.numbering.last()
    }

    /// The next line that needs a reply, if a whole one has arrived. Reads at most the bytes fed so far. Call it also
    /// while nothing arrives, so that a damaged line without an end is noticed.
    pub fn next_line(&mut self, now: Instant) -> Option<Incoming<'_>> {
        let verdict = match self.next_verdict(now) {
            // Whichever line shows the gap, or says that the numbers begin again: all that were passed over get `ok`.
            Some(verdict @ (Verdict::Resend { .. } | Verdict::LineNumber { .. })) => {
                self.forget_missing(0);
                verdict
            }
            Some(verdict) => verdict,
            None if self.missing > 0 && !self.is_skipping && (self.is_frame_done || !self.frame.has_begun()) => {
                let verdict = self.numbering.missed(now);
                // It has an `ok` itself.
                self.forget_missing(1);
                verdict
            }
            None => return None,
        };
        Some(self.incoming(verdict))
    }

    /// The lines that were passed over get their `ok`s but for so many.
    const fn forget_missing(&mut self, but: u32) {
        if self.missing > 0 {
            self.numbering.trust();
            self.owed.oks = self.owed.oks.saturating_add(self.missing - but);
            self.missing = 0;
        }
    }

    /// The prompt for a host that has been silent for `patience_ms` or more during `activity`, which is asked for only
    /// where it matters. Call it when there is no [`next_line`](Self::next_line) and every line has its reply.
    pub fn break_silence(
        &mut self,
        now: Instant,
        patience_ms: u32,
        activity: impl FnOnce() -> Activity,
    ) -> Option<Incoming<'_>> {
        let is_begun = !self.is_frame_done && !self.frame.is_empty();
        if is_begun {
            // Someone who types may take any time. A program sends a line in one go, so its end is lost.
            let is_cut = self.frame.is_numbered() || self.numbering.is_stream();
            if !is_cut || !self.silence.has_lasted(patience_ms, now) {
                return None;
            }
            self.end_line();
            let verdict = self.numbering.judge_cut(&self.frame, now);
            return Some(self.incoming(verdict));
        }
        if !self.numbering.is_stream() {
            return None;
        }
        let (last, is_bad) = (self.numbering.last(), self.numbering.is_bad());
        let prompt = activity().prompt(is_bad, self.numbering.waits_for_ever())?;
        match self.silence.is_over(last, patience_ms, now) {
            Some(is_time) => is_time.then_some(match prompt {
                Prompt::Question if self.silence.may_ask() => Incoming::Question { last },
                Prompt::Question | Prompt::Ok => Incoming::Acknowledge,
            }),
            None => {
                self.numbering.end_stream();
                None
            }
        }
    }

    /// Restarts the silence, because the host has been receiving replies until now.
    pub const fn hold_silence(&mut self) {
        self.silence.end();
    }

    fn incoming(&self, verdict: Verdict) -> Incoming<'_> {
        match verdict {
            Verdict::Command { end, length } => {
                let command = self.frame.text().get(end.saturating_sub(length)..end);
                Incoming::Command(command.unwrap_or_default())
            }
            Verdict::Acknowledge => Incoming::Acknowledge,
            Verdict::LineNumber { report } => Incoming::LineNumber { report },
            Verdict::TooLong => Incoming::TooLong,
            Verdict::Resend { reason, last } => Incoming::Resend { reason, last },
        }
    }

    fn next_verdict(&mut self, now: Instant) -> Option<Verdict> {
        while !self.ring.is_empty() {
            self.silence.end();
            if core::mem::replace(&mut self.is_frame_done, false) {
                self.frame.clear();
            }
            // All bytes without a meaning of their own at once, as far as they lie together.
            let plain = self.frame.push_plain(self.ring.together());
            self.ring.skip(plain);
            if self.ring.is_empty() {
                break;
            }
            let Some(received) = self.ring.pop() else {
                break;
            };
            match received {
                Received::Byte(b'\n' | b'\r') => {
                    self.is_frame_done = true;
                    if let Some(verdict) = self.numbering.judge(&self.frame, now) {
                        return Some(verdict);
                    }
                }
                Received::Byte(byte) if self.numbering.is_stream() => self.frame.push(byte),
                Received::Byte(byte) => self.frame.push_typed(byte),
                Received::Lost | Received::Opened => self.frame.damage(),
            }
        }
        self.give_up_damaged(now)
    }

    /// Asks again for a damaged line that never ends. Otherwise the host would wait for ever (printcore) or for half a
    /// minute (OctoPrint).
    fn give_up_damaged(&mut self, now: Instant) -> Option<Verdict> {
        if self.is_frame_done || !self.frame.is_damaged() || !self.silence.has_lasted(QUIET_MS, now) {
            return None;
        }
        self.end_line();
        Some(self.numbering.damaged(now))
    }

    /// Treats the line as if its end had come.
    const fn end_line(&mut self) {
        self.silence.end();
        self.is_frame_done = true;
        self.scanner = Scanner::new();
    }
}
