//! The hosts: one to a serial line, each with lines of its own and answers of its own.
//!
//! Commands are carried out one at a time, in turn from the hosts that have one. What a command has to say goes to the
//! host that sent it.

use crate::gcode::{self, Command};
use crate::machine::hosts::schedule::{Report, Schedule};
use crate::port::{LINES, Lines, Received, Serial};
use crate::protocol::{Activity, Emergency, Incoming, NoRoom, Receiver, Replies, ResendReason};
use crate::units::Instant;
use core::fmt;
use heapless::Vec;

/// A command's text, copied out of the receiver so that lines can go on arriving while it is carried out.
pub(in crate::machine) type Text = Vec<u8, 320>;

/// A serial line and what is under way on it.
pub(in crate::machine) struct Host<S> {
    line: S,
    receiver: Receiver,
    pub replies: Replies,
    /// What it is told by itself.
    pub schedule: Schedule,
    /// When it was last told that there is somebody, or had nothing to wait for.
    assured: Instant,
    /// A quick stop was in what it has sent last.
    has_stopped: bool,
    /// It opened its line in what it has sent last.
    has_opened: bool,
    /// It is to be greeted.
    is_new: bool,
    /// The number of the line that it was last served, if that had one.
    number: Option<i32>,
    /// Lines up to this place of the receiver came before a quick stop, which forgets them.
    forgotten: Option<u32>,
}

/// All hosts, one of which is being served.
pub(in crate::machine) struct Hosts<S> {
    hosts: Lines<Host<S>>,
    serving: usize,
    /// The host being served waits for the answer to a line.
    owes_ok: bool,
    /// The host being served has gone, and another has opened its line: nobody waits for the answer.
    is_gone: bool,
}

/// What a line asks for; a command's text is elsewhere.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Asked {
    /// To carry out a command.
    Command,
    /// To be told `ok`.
    Nothing,
    /// M110, and what it wants to know.
    LineNumber(Option<i32>),
    /// Too much.
    TooLong,
    /// To be asked for again.
    Resend(ResendReason, i32),
    /// Nothing; it may be waiting for an answer to something that was lost.
    Probe(i32),
}

/// What arrived and cannot wait.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) struct Urgent {
    /// M112
    pub stop: bool,
    /// M410
    pub quick_stop: bool,
    /// M108
    pub go_on: bool,
    /// M24, M602, M876 S
    pub resume: bool,
    /// M999, and no M112 since
    pub restart: bool,
}

impl<S: Serial> Host<S> {
    /// Takes in what has arrived. A quick stop forgets the lines before it and not those behind.
    fn receive(&mut self, urgent: &mut Urgent) {
        self.has_stopped = false;
        self.has_opened = false;
        while self.receiver.has_room() {
            let Some(received) = self.line.recv() else {
                break;
            };
            if received == Received::Opened {
                self.replies = Replies::new();
                self.forgotten = None;
                self.schedule = Schedule::new();
                self.has_opened = true;
                self.is_new = true;
            }
            match self.receiver.feed(received) {
                Some(Emergency::Stop) => (urgent.stop, urgent.restart) = (true, false),
                Some(Emergency::Restart) => urgent.restart = true,
                Some(Emergency::QuickStop) => {
                    self.forgotten = Some(self.receiver.place());
                    self.has_stopped = true;
                    urgent.quick_stop = true;
                }
                Some(Emergency::Continue) => urgent.go_on = true,
                Some(Emergency::Resume) => urgent.resume = true,
                None => {}
            }
        }
    }

    fn next_line(&mut self, now: Instant, (patience_ms, activity): (u32, Activity), text: &mut Text) -> Option<Asked> {
        if !self.replies.pending().is_empty() {
            self.receiver.hold_silence();
        }
        let last = self.receiver.last_line();
        let mut incoming = self.receiver.next_line(now);
        if incoming.is_none() && patience_ms > 0 {
            incoming = self.receiver.break_silence(now, patience_ms, activity);
        }
        let asked = match incoming? {
            Incoming::Command(line) => {
                text.clear();
                let _ = text.extend_from_slice(line.get(..text.capacity()).unwrap_or(line));
                Asked::Command
            }
            Incoming::Acknowledge => Asked::Nothing,
            Incoming::LineNumber { report } => Asked::LineNumber(report),
            Incoming::TooLong => Asked::TooLong,
            Incoming::Resend { reason, last } => Asked::Resend(reason, last),
            Incoming::Silence { last } => Asked::Probe(last),
        };
        // Of what nothing is done with, nothing need be kept: the outline of an object, a message.
        let is_needed = || !matches!(gcode::parse(self.receiver.kept()), Command::Silent | Command::Message);
        let asked = if asked == Asked::TooLong && !is_needed() { Asked::Nothing } else { asked };
        let number = self.receiver.last_line();
        self.number = (number != last).then_some(number);
        self.assured = now;
        self.forgotten = self.forgotten.filter(|place| self.receiver.is_within(*place));
        let is_forgotten = asked == Asked::Command && self.forgotten.is_some();
        Some(if is_forgotten { Asked::Nothing } else { asked })
    }

    fn send(&mut self) {
        loop {
            let pending = self.replies.pending();
            if pending.is_empty() {
                return;
            }
            let sent = self.line.send(pending);
            if sent == 0 {
                return;
            }
            self.replies.sent(sent);
        }
    }
}

impl<S: Serial> Hosts<S> {
    pub(in crate::machine) fn new(lines: Lines<S>, now: Instant) -> Self {
        let host = |line| Host {
            line,
            receiver: Receiver::new(),
            replies: Replies::new(),
            schedule: Schedule::new(),
            assured: now,
            has_stopped: false,
            has_opened: false,
            is_new: false,
            number: None,
            forgotten: None,
        };
        Self { hosts: lines.into_iter().map(host).collect(), serving: 0, owes_ok: false, is_gone: false }
    }

    /// How many there are.
    pub(in crate::machine) fn len(&self) -> usize {
        self.hosts.len()
    }

    /// Has `host` hear what is said from now on.
    pub(in crate::machine) fn turn_to(&mut self, host: usize) {
        self.serving = host;
        self.is_gone = false;
    }

    /// Whether the host being served waits for the answer to a line.
    pub(in crate::machine) const fn owes_ok(&self) -> bool {
        self.owes_ok
    }

    /// The line is answered.
    pub(in crate::machine) const fn settle(&mut self) {
        self.owes_ok = false;
    }

    /// The next line of a host, beginning with the one after the host served last. A command is put into `text`.
    /// A host that has been silent in the middle of its lines for so many ms, 0 being never, is prompted if it may be
    /// waiting, while the machine is about that activity.
    pub(in crate::machine) fn next_line(
        &mut self,
        now: Instant,
        patience: (u32, Activity),
        text: &mut Text,
    ) -> Option<Asked> {
        let count = self.hosts.len();
        for place in (1..=count).map(|step| (self.serving + step) % count) {
            let Some(asked) = self.hosts.get_mut(place).and_then(|host| host.next_line(now, patience, text)) else {
                continue;
            };
            self.turn_to(place);
            self.owes_ok = true;
            return Some(asked);
        }
        None
    }

    /// The host being served.
    pub(in crate::machine) const fn serving(&self) -> usize {
        self.serving
    }

    /// Marks those that have opened their lines in what arrived last.
    pub(in crate::machine) fn note_opened(&self, are_new: &mut [bool; LINES]) {
        for (is_new, host) in are_new.iter_mut().zip(&self.hosts) {
            *is_new |= host.has_opened;
        }
    }

    /// All of them.
    pub(in crate::machine) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Host<S>> {
        self.hosts.iter_mut()
    }

    /// Has the host being served told a report every `seconds`, unless it has gone.
    pub(in crate::machine) fn schedule(&mut self, report: Report, seconds: u8, now: Instant) {
        if let Some(host) = self.hosts.get_mut(self.serving).filter(|_| !self.is_gone) {
            host.schedule.set(report, seconds, now);
        }
    }

    /// What the host being served is told. `None` if it has gone.
    pub(in crate::machine) fn replies(&mut self) -> Option<&mut Replies> {
        if self.is_gone {
            return None;
        }
        self.hosts.get_mut(self.serving).map(|host| &mut host.replies)
    }

    /// The number of the line being served, if it has one, and the bytes that its host may send ahead.
    pub(in crate::machine) fn progress(&self) -> (Option<i32>, usize) {
        self.hosts.get(self.serving).map_or((None, 0), |host| (host.number, host.receiver.room()))
    }

    /// Takes in what has arrived from all. Lines that a quick stop has overtaken, be it another host's, will be
    /// answered, but not carried out.
    pub(in crate::machine) fn receive(&mut self) -> Urgent {
        let mut all = Urgent::default();
        for (place, host) in self.hosts.iter_mut().enumerate() {
            host.receive(&mut all);
            self.is_gone |= host.has_opened && self.owes_ok && place == self.serving;
        }
        if all.quick_stop {
            for host in self.hosts.iter_mut().filter(|host| !host.has_stopped) {
                host.forgotten = Some(host.receiver.place());
            }
        }
        all
    }

    /// Sends what fits.
    pub(in crate::machine) fn send(&mut self) {
        self.hosts.iter_mut().for_each(Host::send);
    }

    /// Tells hosts that have waited for `every` ms for the answer to a line that there is somebody. 0 is never.
    pub(in crate::machine) fn keep_alive(&mut self, now: Instant, every: u32, is_paused: bool) {
        let say = |replies: &mut Replies| if is_paused { replies.paused() } else { replies.busy() };
        for (place, host) in self.hosts.iter_mut().enumerate() {
            let is_served = self.owes_ok && !self.is_gone && place == self.serving;
            let is_waiting = is_served || !host.receiver.is_empty();
            if !is_waiting || (every > 0 && now >= host.assured.after_ms(every) && say(&mut host.replies).is_ok()) {
                host.assured = now;
            }
        }
    }

    /// Says the same line to all; one that has no room for it misses it.
    pub(in crate::machine) fn tell_all(&mut self, line: fmt::Arguments<'_>) {
        for host in &mut self.hosts {
            let _ = host.replies.line(line);
        }
    }

    /// Says the same line to all but the host being served; one that has no room for it misses it.
    pub(in crate::machine) fn tell_others(&mut self, line: fmt::Arguments<'_>) {
        let serving = self.serving;
        for (_, host) in self.hosts.iter_mut().enumerate().filter(|(place, _)| *place != serving) {
            let _ = host.replies.line(line);
        }
    }

    /// Says `what` to those that have opened their lines since the last time, as soon as it fits.
    pub(in crate::machine) fn greet(&mut self, what: impl Fn(&mut Replies) -> Result<(), NoRoom>) {
        for host in &mut self.hosts {
            host.is_new = host.is_new && what(&mut host.replies).is_err();
        }
    }

    /// Has all of them greeted.
    pub(in crate::machine) fn count_as_new(&mut self) {
        self.hosts.iter_mut().for_each(|host| host.is_new = true);
    }
}
