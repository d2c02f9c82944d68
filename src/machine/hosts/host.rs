//! One host: its serial line, the received bytes, and the pending replies.

use super::request::{Parse, Request};
use super::schedule::Schedule;
use super::upload::{Upload, is_mark};
use crate::gcode::{Command, Mark};
use crate::port::{Lines, Received, Serial};
use crate::protocol::{Activity, Emergency, Incoming, LONGEST_LINE, Receiver, Replies};
use crate::units::Instant;
use heapless::Vec;

/// M117: a message for a display that is not there.
const MESSAGE: u16 = 117;

/// Lines that wait for longer are sorted: their host does not stop sending. Emergencies behind them then act within
/// twice this time.
const WAITS_MS: u32 = 50;

/// A command's text, copied out of the receiver so that more lines can arrive while it is carried out.
pub(in crate::machine) type Text = Vec<u8, LONGEST_LINE>;

/// Received bytes and pending replies of one host, 2.5 KiB.
struct Buffers {
    receiver: Receiver,
    replies: Replies,
}

impl Buffers {
    const fn new() -> Self {
        Self { receiver: Receiver::new(), replies: Replies::new() }
    }
}

/// The buffers of all hosts. They stay in their place: the constructor of the Console has all that it holds on the
/// stack. They begin empty, as a static whose first bytes are not zeros takes as many bytes of flash.
pub struct HostMemory {
    pub(super) hosts: HostBuffers,
    /// What a command has said on its way, as far as its host's replies have no room.
    pub(super) told: Replies,
}

impl HostMemory {
    /// No buffers yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { hosts: HostBuffers(Lines::new()), told: Replies::new() }
    }
}

/// The buffers of each host.
pub(super) struct HostBuffers(Lines<Buffers>);

impl HostBuffers {
    /// Empty ones, of one host after the other.
    pub fn make(&mut self) -> impl Iterator<Item = (&mut Receiver, &mut Replies)> {
        while !self.0.is_full() {
            self.add();
        }
        self.0.iter_mut().map(|Buffers { receiver, replies }| (receiver, replies))
    }

    #[inline(never)]
    fn add(&mut self) {
        let _ = self.0.push(Buffers::new());
    }
}

impl Default for HostMemory {
    fn default() -> Self {
        Self::new()
    }
}

/// A serial line and its state.
pub(super) struct Host<'m, S> {
    line: S,
    pub(super) receiver: &'m mut Receiver,
    pub(super) replies: &'m mut Replies,
    /// Its periodic reports.
    pub(super) schedule: Schedule,
    /// Its upload to a card.
    pub(super) upload: Upload,
    /// When it last got a sign of life, or had nothing to wait for.
    pub(super) assured: Instant,
    /// Its last input held a quick stop or a cancel.
    pub(super) has_stopped: bool,
    /// It opened its line in its last input.
    pub(super) has_opened: bool,
    /// It needs a greeting.
    pub(super) is_new: bool,
    /// The number of the line that it was last served, if that had one.
    pub(super) number: Option<i32>,
    /// When the Console looked last for a line of it.
    looked: Instant,
    /// Whether its lines waited for long when it was last received, and then whether the command rested.
    wait: Option<bool>,
    /// Bytes that were overheard and not received.
    ahead: u32,
}

/// Urgent commands that arrived.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Urgent {
    /// M112
    pub stop: bool,
    /// M410
    pub quick_stop: bool,
    /// M108
    pub go_on: bool,
    /// M24, M602, M876 S
    pub resume: bool,
    /// M524
    pub cancel: bool,
    /// M999, and no M112 since
    pub restart: bool,
}

impl Urgent {
    pub(super) const NONE: Self =
        Self { stop: false, quick_stop: false, go_on: false, resume: false, cancel: false, restart: false };
}

impl<'m, S: Serial> Host<'m, S> {
    /// A host without input, with empty buffers.
    pub(super) const fn new(line: S, (receiver, replies): (&'m mut Receiver, &'m mut Replies), now: Instant) -> Self {
        Self {
            line,
            receiver,
            replies,
            schedule: Schedule::new(),
            upload: Upload::new(),
            assured: now,
            has_stopped: false,
            has_opened: false,
            is_new: false,
            number: None,
            looked: now,
            wait: None,
            ahead: 0,
        }
    }

    /// Takes in the received bytes; true if the host may be owed something for lines out of their turn. A quick stop or
    /// a cancel forgets earlier lines and no later ones.
    ///
    /// While a command keeps lines waiting, the line is read on. The command `rests` if it changes no position.
    pub(super) fn receive(&mut self, (now, rests): (Instant, bool), urgent: &mut Urgent) -> bool {
        self.has_stopped = false;
        self.has_opened = false;
        if self.receiver.is_empty() && self.ahead == 0 {
            // As in most turns: no line waits, and there is room for all that has come.
            self.wait = None;
            while self.receiver.has_spare() {
                let Some(received) = self.line.recv() else { return false };
                self.take_in(received, urgent);
            }
        }
        self.receive_on((now, rests), urgent)
    }

    #[inline(never)]
    fn receive_on(&mut self, (now, rests): (Instant, bool), urgent: &mut Urgent) -> bool {
        let is_waiting = now >= self.looked.after_ms(WAITS_MS);
        let wait = is_waiting.then_some(rests);
        let mut has_news = self.wait != wait;
        self.wait = wait;
        let mut is_drained = false;
        while self.receiver.has_spare() || (is_waiting && self.receiver.makes_room()) {
            let was_overheard = self.ahead > 0 && self.line.was_overheard();
            self.ahead = if was_overheard { self.ahead - 1 } else { 0 };
            let Some(received) = self.line.recv() else {
                is_drained = true;
                break;
            };
            has_news = true;
            if was_overheard {
                self.note_opened(received);
                self.receiver.put(received);
            } else {
                self.take_in(received, urgent);
            }
        }
        if !is_drained {
            while let Some(received) = self.line.overhear() {
                self.ahead += 1;
                if let Some(emergency) = self.receiver.scan(received) {
                    self.act(emergency, urgent);
                }
            }
        }
        let Some(rests) = wait else { return false };
        // Lines are looked at once, not in every turn.
        if has_news || !self.receiver.owed().is_empty() {
            self.receiver.answer_reports(rests);
        }
        true
    }

    /// Takes in what was not overheard.
    fn take_in(&mut self, received: Received, urgent: &mut Urgent) {
        self.note_opened(received);
        if let Some(emergency) = self.receiver.feed(received) {
            self.act(emergency, urgent);
        }
    }

    /// Whoever opens the line begins anew.
    fn note_opened(&mut self, received: Received) {
        if received == Received::Opened {
            self.replies.clear();
            self.schedule = Schedule::new();
            self.upload = Upload::new();
            self.has_opened = true;
            self.is_new = true;
        }
    }

    /// Notes an urgent command. Inlined, it would be there twice.
    #[inline(never)]
    const fn act(&mut self, emergency: Emergency, urgent: &mut Urgent) {
        match emergency {
            Emergency::Stop => (urgent.stop, urgent.restart) = (true, false),
            Emergency::Restart => urgent.restart = true,
            Emergency::QuickStop => {
                self.forget();
                urgent.quick_stop = true;
            }
            Emergency::Continue => urgent.go_on = true,
            Emergency::Resume => urgent.resume = true,
            Emergency::Cancel => {
                self.forget();
                urgent.cancel = true;
            }
        }
    }

    /// The lines so far are not carried out any more.
    pub(super) const fn forget(&mut self) {
        self.receiver.overtake(self.ahead);
        self.has_stopped = true;
    }

    pub(super) fn next_line(
        &mut self,
        now: Instant,
        (patience_ms, activity): (u32, &dyn Fn() -> Activity),
        parse: Parse,
        text: &mut Text,
    ) -> Option<Request> {
        if !self.replies.are_sent() {
            self.receiver.hold_silence();
        }
        self.looked = now;
        let last = self.receiver.last_line();
        let mut incoming = self.receiver.next_line(now);
        if incoming.is_none() && patience_ms > 0 {
            incoming = self.receiver.break_silence(now, patience_ms, activity);
        }
        let asked = match incoming? {
            Incoming::Command(line) => {
                text.clear();
                let _ = text.extend_from_slice(line.get(..text.capacity()).unwrap_or(line));
                Request::Command
            }
            Incoming::Acknowledge => Request::Nothing,
            Incoming::LineNumber { report } => Request::LineNumber(report),
            Incoming::TooLong => Request::TooLong,
            Incoming::Resend { reason, last } => Request::Resend(reason, last),
            Incoming::Question { last } => Request::Question(last),
        };
        let asked = if asked == Request::TooLong { self.asked_at_length(parse, text) } else { asked };
        let number = self.receiver.last_line();
        self.number = (number != last).then_some(number);
        self.assured = now;
        let is_forgotten = self.receiver.is_overtaken() && asked == Request::Command && !outlives_stop(parse, text);
        let asked = if is_forgotten { Request::Nothing } else { asked };
        Some(if self.upload.takes(asked, text, parse, now) { Request::Nothing } else { asked })
    }

    /// The request of a line that is too long: it may be one without an effect, a message, or the outline of an
    /// object, which may be cut.
    fn asked_at_length(&self, parse: Parse, text: &mut Text) -> Request {
        let kept = self.receiver.kept();
        match parse(kept) {
            Command::Silent => Request::Nothing,
            Command::Table(command) if command.is('M', MESSAGE) => Request::Nothing,
            Command::Table(command) if command.has_mark(Mark::MayBeCut) => {
                text.clear();
                let _ = text.extend_from_slice(kept.get(..text.capacity()).unwrap_or(kept));
                Request::Command
            }
            _ => Request::TooLong,
        }
    }

    pub(super) fn send(&mut self) {
        send(&mut self.line, self.replies);
    }

    /// Sends what follows the replies, which are held until then.
    pub(super) fn send_told(&mut self, told: &mut Replies) {
        if !self.replies.has_pending() {
            send(&mut self.line, told);
            self.replies.hold(!told.are_sent());
        }
    }
}

/// Whether a line is carried out though a quick stop or a cancel came with it or behind it: a mark of an upload, and the
/// cancel that the owner may have a text for.
fn outlives_stop(parse: Parse, text: &[u8]) -> bool {
    is_mark(parse, text) || matches!(parse(text), Command::Table(command) if command.is_named("CANCEL_PRINT"))
}

/// Sends as many bytes as fit.
fn send(line: &mut impl Serial, replies: &mut Replies) {
    while replies.has_pending() {
        let sent = line.send(replies.pending());
        if sent == 0 {
            return;
        }
        replies.sent(sent);
    }
}
