//! The hosts, with the one being served.
//!
//! Commands are carried out one at a time, in turn from the hosts that have one. The replies to a command go to the
//! host that sent it.
//!
//! A host that waits gets `busy` (`keep_alive`): its text is in `protocol::reply`, its interval `Settings::keepalive_s`
//! (M113). Waits for heat also report temperatures, every second (`LINE_MS` in `heat::heating`).

use super::host::{Host, HostBuffers, HostMemory, Text, Urgent};
use super::request::{Parse, Request};
use super::schedule::Report;
use super::told::Told;
use crate::port::{LINES, Lines, Serial};
use crate::protocol::{Activity, NoRoom, Owed, Replies};
use crate::units::Instant;
use core::fmt;

/// All hosts, with the one being served.
pub(in crate::machine) struct Hosts<'m, S> {
    hosts: Lines<Host<'m, S>>,
    /// Lines that are not open yet, and the buffers for them.
    closed: Lines<S>,
    memory: Option<&'m mut HostBuffers>,
    serving: usize,
    told: Told<'m>,
    /// The host being served waits for the answer to a line.
    owes_ok: bool,
    /// The host being served has gone, and another has opened its line: the answer is discarded.
    is_gone: bool,
    /// The host that waits for a line which is kept, while others are served.
    aside: Option<usize>,
    /// A host may be owed something for lines out of their turn.
    may_owe: bool,
    /// A host may need a greeting.
    may_be_new: bool,
    /// A host may have periodic reports.
    may_schedule: bool,
    /// When signs of life were last looked after.
    tended: Instant,
}

impl<'m, S: Serial> Hosts<'m, S> {
    /// No line is open before [`open`](Self::open).
    pub(in crate::machine) const fn new(lines: Lines<S>, memory: &'m mut HostMemory) -> Self {
        let HostMemory { hosts: memory, told } = memory;
        Self {
            hosts: Lines::new(),
            closed: lines,
            memory: Some(memory),
            serving: 0,
            told: Told::new(told),
            owes_ok: false,
            is_gone: false,
            aside: None,
            may_owe: false,
            may_be_new: false,
            may_schedule: false,
            tended: Instant(0),
        }
    }

    /// Listens to all lines from now on.
    pub(in crate::machine) fn open(&mut self, now: Instant) {
        let Some(memory) = self.memory.take() else { return };
        for (line, buffers) in core::mem::take(&mut self.closed).into_iter().zip(memory.make()) {
            // There is as much room as there were lines.
            let _ = self.hosts.push(Host::new(line, buffers, now));
        }
    }

    /// The number of hosts.
    pub(in crate::machine) fn len(&self) -> usize {
        self.hosts.len()
    }

    /// Sends the following replies to `host`.
    pub(in crate::machine) fn switch_to(&mut self, host: usize) {
        self.serving = host;
        self.is_gone = false;
    }

    /// Whether the host being served waits for the answer to a line.
    pub(in crate::machine) const fn owes_ok(&self) -> bool {
        self.owes_ok
    }

    /// The line is answered.
    pub(in crate::machine) const fn note_answered(&mut self) {
        self.owes_ok = false;
    }

    /// The next line of a host, beginning with the one after the host served last. A command is put into `text`.
    /// Prompts a host that has been silent in the middle of its lines for the given time in ms (0: never), if it may be
    /// waiting during the given activity.
    pub(in crate::machine) fn next_line(
        &mut self,
        now: Instant,
        patience: (u32, &dyn Fn() -> Activity),
        parse: Parse,
        text: &mut Text,
    ) -> Option<Request> {
        let (count, mut place) = (self.hosts.len(), self.serving);
        for _ in 0..count {
            place = if place + 1 < count { place + 1 } else { 0 };
            if self.aside == Some(place) {
                continue;
            }
            let Some(asked) = self.hosts.get_mut(place).and_then(|host| host.next_line(now, patience, parse, text))
            else {
                continue;
            };
            self.switch_to(place);
            self.owes_ok = true;
            self.may_owe = true;
            return Some(asked);
        }
        None
    }

    /// Treats the following lines of the host being served as an upload to a card.
    pub(in crate::machine) fn begin_upload(&mut self, now: Instant) {
        if let Some(host) = self.hosts.get_mut(self.serving).filter(|_| !self.is_gone) {
            host.upload.begin(now);
        }
    }

    /// That is over. `None` if it had not begun.
    pub(in crate::machine) fn end_upload(&mut self) -> Option<u32> {
        self.hosts.get_mut(self.serving)?.upload.end()
    }

    /// Lines of an upload that the present line has ended without M29.
    pub(in crate::machine) fn upload_given_up(&mut self) -> Option<u32> {
        self.hosts.get_mut(self.serving)?.upload.take_given_up()
    }

    /// The host being served keeps waiting for its `ok`, while others are served. One that has gone does not wait.
    pub(in crate::machine) const fn set_aside(&mut self) {
        self.aside = if self.is_gone { None } else { Some(self.serving) };
        self.owes_ok = false;
    }

    /// Whether a host waits so.
    pub(in crate::machine) const fn has_set_aside(&self) -> bool {
        self.aside.is_some()
    }

    /// The host that waits so is served again, if it is still there.
    pub(in crate::machine) fn take_up(&mut self) {
        if let Some(place) = self.aside.take() {
            self.switch_to(place);
            self.owes_ok = true;
        }
    }

    /// The host being served.
    pub(in crate::machine) const fn serving(&self) -> usize {
        self.serving
    }

    /// Marks the hosts that opened their lines in their last input.
    pub(in crate::machine) fn note_opened(&self, are_new: &mut [bool; LINES]) {
        for (is_new, host) in are_new.iter_mut().zip(&self.hosts) {
            *is_new |= host.has_opened;
        }
    }

    fn iter_mut(&mut self) -> impl Iterator<Item = &mut Host<'m, S>> {
        self.hosts.iter_mut()
    }

    /// Sends the host being served a report every `period_s`, unless it has gone.
    pub(in crate::machine) fn schedule(&mut self, report: Report, period_s: u8, now: Instant) {
        if let Some(host) = self.hosts.get_mut(self.serving).filter(|_| !self.is_gone) {
            host.schedule.set(report, period_s, now);
            self.may_schedule = self.hosts.iter().any(|host| !host.schedule.is_empty());
        }
    }

    /// Where lines go: those that go ahead, and the host being served, with its place; `None` if it has gone.
    pub(in crate::machine) fn output(&mut self) -> (&mut Told<'m>, Option<(usize, &mut Replies)>) {
        let (place, is_there) = (self.serving, !self.is_gone);
        let host = self.hosts.get_mut(place).filter(|_| is_there);
        (&mut self.told, host.map(|host| (place, &mut *host.replies)))
    }

    /// The number of the line being served, if it has one, and the bytes that its host may send ahead.
    pub(in crate::machine) fn window(&self) -> (Option<i32>, usize) {
        self.hosts.get(self.serving).map_or((None, 0), |host| (host.number, host.receiver.room()))
    }

    /// Takes in the received bytes of all hosts. Lines that a quick stop or a cancel has overtaken, even one of
    /// another host, will be answered, but not carried out.
    pub(in crate::machine) fn receive(&mut self, now: Instant, rests: bool) -> Urgent {
        let mut all = Urgent::NONE;
        for (place, host) in self.hosts.iter_mut().enumerate() {
            self.may_owe |= host.receive((now, rests || self.aside == Some(place)), &mut all);
            if host.has_opened {
                self.may_be_new = true;
                self.is_gone |= self.owes_ok && place == self.serving;
                self.aside = self.aside.filter(|aside| place != *aside);
                self.told.forget(place);
            }
        }
        if all.quick_stop || all.cancel {
            for host in self.hosts.iter_mut().filter(|host| !host.has_stopped) {
                host.forget();
            }
        }
        all
    }

    /// Whether one of the hosts may be owed something for lines out of their turn, and whether one may have periodic
    /// reports. It is asked for once a turn.
    pub(in crate::machine) fn may_get_unasked(&mut self) -> (bool, bool) {
        let may_owe = self.may_owe;
        self.may_owe = may_owe && self.hosts.iter_mut().any(|host| !host.receiver.owed().is_empty());
        (may_owe, self.may_schedule)
    }

    /// What a host is owed for lines out of their turn, if anything, and where it goes; not while other output waits.
    pub(in crate::machine) fn owed(&mut self, place: usize) -> Option<(&mut Owed, &mut Replies)> {
        let Host { receiver, replies, .. } = self.hosts.get_mut(place)?;
        let owed = receiver.owed();
        (!owed.is_empty() && replies.are_sent()).then_some((owed, replies))
    }

    /// Sends as many bytes as fit.
    pub(in crate::machine) fn send(&mut self) {
        self.hosts.iter_mut().for_each(Host::send);
        self.told.send(&mut self.hosts);
    }

    /// Sends a sign of life to hosts that have waited for `every_ms` for the answer to a line. 0 is never. It looks
    /// once a millisecond: there may be a turn for each byte.
    pub(in crate::machine) fn keep_alive(&mut self, now: Instant, every_ms: u32) {
        if now < self.tended.after_ms(1) {
            return;
        }
        self.tended = now;
        let say = |replies: &mut Replies, is_aside: bool| if is_aside { replies.paused() } else { replies.busy() };
        for (place, host) in self.hosts.iter_mut().enumerate() {
            let is_served = self.owes_ok && !self.is_gone && place == self.serving;
            let is_aside = self.aside == Some(place);
            let is_waiting = is_served || is_aside || !host.receiver.is_empty();
            let is_due = every_ms > 0 && now >= host.assured.after_ms(every_ms);
            if !is_waiting || (is_due && say(host.replies, is_aside).is_ok()) {
                host.assured = now;
            }
        }
    }

    /// Says the same line to all; one that has no room for it misses it.
    pub(in crate::machine) fn notify_all(&mut self, line: crate::text::Text<'_>) {
        for host in &mut self.hosts {
            let _ = host.replies.line(format_args!("{line}"));
        }
    }

    /// Says the same line to all but the host being served; one that has no room for it misses it.
    pub(in crate::machine) fn notify_others(&mut self, line: fmt::Arguments<'_>) {
        let serving = self.serving;
        for (_, host) in self.hosts.iter_mut().enumerate().filter(|(place, _)| *place != serving) {
            let _ = host.replies.line(line);
        }
    }

    /// Sends a line to the host in that place, unless it is the one being served; false if it is, or if there is none.
    /// One that has no room for it misses it.
    pub(in crate::machine) fn notify_other(&mut self, place: usize, line: fmt::Arguments<'_>) -> bool {
        let other = self.hosts.get_mut(place).filter(|_| place != self.serving);
        other.map(|host| host.replies.line(line)).is_some()
    }

    /// Sends `what` to hosts that have opened their lines since the last time, as soon as it fits.
    pub(in crate::machine) fn greet(&mut self, what: impl Fn(&mut Replies) -> Result<(), NoRoom>) {
        if !core::mem::take(&mut self.may_be_new) {
            return;
        }
        for host in &mut self.hosts {
            host.is_new = host.is_new && what(host.replies).is_err();
            self.may_be_new |= host.is_new;
        }
    }

    /// Has all of them greeted.
    pub(in crate::machine) fn count_as_new(&mut self) {
        self.hosts.iter_mut().for_each(|host| host.is_new = true);
        self.may_be_new = true;
    }

    /// Whether a report is due for a host with no other output waiting.
    pub(in crate::machine) fn is_due(&mut self, report: Report, now: Instant) -> bool {
        self.iter_mut().any(|host| host.schedule.is_due(report, now) && host.replies.are_sent())
    }

    /// Sends a report to the hosts for which it is due and that have no other output waiting.
    pub(in crate::machine) fn report(&mut self, report: Report, now: Instant, line: fmt::Arguments<'_>) {
        for host in self.iter_mut() {
            if host.schedule.is_due(report, now) && host.replies.are_sent() && host.replies.line(line).is_ok() {
                host.schedule.note_told(report, now);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::port::Received;
    use std::cell::RefCell;
    use std::string::String;
    use std::vec::Vec;

    /// A wire that takes three bytes at a time.
    struct Slow<'a>(&'a RefCell<Vec<u8>>);

    impl Serial for Slow<'_> {
        fn recv(&mut self) -> Option<Received> {
            None
        }

        fn send(&mut self, bytes: &[u8]) -> usize {
            let mut heard = self.0.borrow_mut();
            if heard.len() % 4 == 3 {
                heard.push(b'~');
                return 0;
            }
            heard.extend(bytes.iter().take(1));
            bytes.len().min(1)
        }
    }

    #[test]
    fn a_report_stands_neither_in_a_line_nor_in_an_answer() {
        let heard = RefCell::new(Vec::new());
        let lines: Lines<Slow<'_>> = core::iter::once(Slow(&heard)).collect();
        let mut memory = HostMemory::new();
        let mut hosts = Hosts::new(lines, &mut memory);
        hosts.open(Instant(0));
        hosts.switch_to(0);
        hosts.schedule(Report::Temperatures, 1, Instant(0));
        let mut now = Instant(0);
        for n in 0..200 {
            // An answer of three lines, each sent in many pieces, and a report that is always due.
            for part in ["one", "two", "three"] {
                if let (_, Some((_, replies))) = hosts.output() {
                    let _ = replies.line(format_args!("{part} {n}"));
                }
                hosts.send();
                now = now.after_ms(700);
                hosts.report(Report::Temperatures, now, format_args!(" T:1 /2"));
            }
            for _ in 0..60 {
                hosts.send();
            }
            now = now.after_ms(700);
            hosts.report(Report::Temperatures, now, format_args!(" T:1 /2"));
            for _ in 0..60 {
                hosts.send();
            }
        }
        drop(hosts);
        let text = String::from_utf8(heard.into_inner()).unwrap_or_default().replace('~', "");
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 800);
        for (n, answer) in lines.chunks(4).enumerate() {
            let expected = [std::format!("one {n}"), std::format!("two {n}"), std::format!("three {n}")];
            assert_eq!(answer[..3], expected);
            assert_eq!(answer[3], " T:1 /2");
        }
    }
}
