//! Lines that go ahead: a command says them on its way, and waits for no room.
//!
//! Those that find no room in the replies of their host go into a ring of their own, and the replies are held until
//! that is sent. One ring does for all hosts: one command is carried out at a time, and the next one begins when the
//! ring is empty. So between two answers a command may say as much as the ring holds, however much waits already.

use super::host::Host;
use crate::port::Serial;
use crate::protocol::{NoRoom, Replies};

/// Writes a part of an answer.
type Part<'w> = dyn Fn(&mut Replies) -> Result<(), NoRoom> + 'w;

/// The lines that go ahead.
pub(in crate::machine) struct Told<'m> {
    ring: &'m mut Replies,
    /// Whether the ring has lines: asked several times in every turn.
    has_lines: bool,
    /// The host that they are for.
    to: usize,
    /// Whether lines go ahead now.
    is_ahead: bool,
}

impl<'m> Told<'m> {
    /// None.
    pub(super) const fn new(ring: &'m mut Replies) -> Self {
        Self { ring, has_lines: false, to: 0, is_ahead: false }
    }

    /// Whether lines to the host being served go ahead from now on.
    pub const fn go_ahead(&mut self, may: bool) {
        self.is_ahead = may;
    }

    /// Whether the ring is empty.
    pub const fn are_sent(&self) -> bool {
        !self.has_lines
    }

    /// Puts a part, all of it or nothing, into the replies of a host, or behind them if it goes ahead; false if there
    /// is no room for it.
    pub fn put(&mut self, to: usize, replies: &mut Replies, part: &Part<'_>) -> bool {
        if part(replies).is_ok() {
            return true;
        }
        let is_free = self.are_sent() || self.to == to;
        if !self.is_ahead || !is_free || part(self.ring).is_err() {
            return false;
        }
        (self.to, self.has_lines) = (to, true);
        replies.hold(true);
        true
    }

    /// The host has gone.
    pub(super) fn forget(&mut self, host: usize) {
        if host == self.to {
            self.ring.clear();
            self.has_lines = false;
        }
    }

    /// Sends as many bytes as fit.
    pub(super) fn send<S: Serial>(&mut self, hosts: &mut [Host<'_, S>]) {
        if !self.are_sent()
            && let Some(host) = hosts.get_mut(self.to)
        {
            host.send_told(self.ring);
            self.has_lines = !self.ring.are_sent();
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::String;

    /// Takes out what waits.
    fn drain(replies: &mut Replies) -> String {
        let mut text = String::new();
        while replies.has_pending() {
            let bytes = replies.pending();
            text.push_str(core::str::from_utf8(bytes).unwrap_or_default());
            replies.sent(bytes.len());
        }
        text
    }

    #[test]
    fn lines_that_go_ahead_find_room_behind_full_replies_and_in_order() {
        let mut rings = [Replies::new(), Replies::new(), Replies::new()];
        let [ring, replies, other] = &mut rings;
        let mut told = Told::new(ring);
        while replies.ok().is_ok() {}
        let line = |text: &'static str| move |replies: &mut Replies| replies.line(format_args!("{text}"));
        assert!(!told.put(1, replies, &line("one")), "only what goes ahead");
        told.go_ahead(true);
        assert!(told.put(1, replies, &line("one")) && told.put(1, replies, &line("two")));
        assert!(!told.are_sent());
        // Another host has its own replies, and no room beyond them while the ring is in use.
        assert!(told.put(2, other, &line("three")) && drain(other) == "three\n");
        while other.ok().is_ok() {}
        assert!(!told.put(2, other, &line("four")));
        // Nothing comes between the lines, and nothing before they are sent.
        assert!(drain(replies).ends_with("ok\n") && !replies.are_sent());
        assert_eq!((replies.ok(), replies.room()), (Err(NoRoom), 0));
        assert!(told.put(1, replies, &line("five")));
        assert_eq!(drain(told.ring), "one\ntwo\nfive\n");
        replies.hold(false);
        assert_eq!(replies.ok(), Ok(()));
    }

    #[test]
    fn a_host_that_has_gone_gets_nothing_of_it() {
        let (mut ring, mut replies) = (Replies::new(), Replies::new());
        while replies.ok().is_ok() {}
        let mut told = Told::new(&mut ring);
        told.go_ahead(true);
        assert!(told.put(1, &mut replies, &Replies::busy));
        told.forget(0);
        assert!(!told.are_sent());
        told.forget(1);
        replies.clear();
        assert!(told.are_sent() && replies.are_sent());
    }
}
