//! The USB pump: the buffers between the Console and the USB port, without the port.
//!
//! - Bytes to the host leave with the next packet, however short. A full packet that ends a reply is followed by an
//!   empty one.
//! - While the port is closed, output of the Console is discarded; lines that the host had sent are still carried out.
//! - When the host opens the port, both directions start empty. 100 ms later the Console gets that event first.
//! - If the host has the port open and fetches nothing for 500 ms, output of the Console is discarded until it fetches.
//! - A packet from the host is requested only if it fits, so the host waits and nothing is lost.
//!
//! After discarded output, the host never sees half a line joined to a whole one. Output resumes at the start of a
//! line, after a line break if the host has half of another.

use corehbot::port::Received;
use corehbot::units::Instant;
use heapless::Deque;

/// Bytes in a packet: the most for bulk endpoints at full speed (USB 2.0, 5.8.3).
pub const PACKET: usize = 64;

/// Bytes from the host that wait for the Console: some ten lines.
const INCOMING: usize = 512;

/// Bytes that wait for the host: a report of the settings (M503).
const OUTGOING: usize = 1024;

/// A host that reads at all fetches a packet within a few ms. The Console must not wait much longer than the planned
/// moves take to print.
const PATIENCE_MS: u32 = 500;

/// After opening the port the host is left alone for this long. Linux echoes received bytes until the program that has
/// opened the port switches that off (termios, ECHO), and most programs do that next.
const SETTLE_MS: u32 = 100;

/// The buffers.
pub struct Pump {
    incoming: Deque<u8, INCOMING>,
    outgoing: Deque<u8, OUTGOING>,
    /// A program on the host has the port open (DTR).
    is_open: bool,
    /// When the port was opened, until the Console knows of it.
    opened: Option<Instant>,
    /// How often the port was opened or closed, wrapping.
    session: u8,
    /// Since when the oldest packet waits for the host to fetch it.
    waits_since: Option<Instant>,
    /// The host fetches nothing.
    is_deaf: bool,
    /// Output after the buffered bytes was discarded.
    is_cut: bool,
    /// The Console is in the middle of a line.
    is_within: bool,
    /// The host has the beginning of a line, and not its end.
    has_half: bool,
    /// The host has a full packet and does not know that nothing follows.
    wants_end: bool,
    /// The host may have a packet under way from an earlier session.
    has_stray: bool,
}

impl Default for Pump {
    fn default() -> Self {
        Self::new()
    }
}

impl Pump {
    /// A closed port; all zeros, so it costs no flash.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            incoming: Deque::new(),
            outgoing: Deque::new(),
            is_open: false,
            opened: None,
            session: 0,
            waits_since: None,
            is_deaf: false,
            is_cut: false,
            is_within: false,
            has_half: false,
            wants_end: false,
            has_stray: false,
        }
    }

    /// The next event or byte from the host for the Console.
    pub fn recv(&mut self, now: impl FnOnce() -> Instant) -> Option<Received> {
        if let Some(opened) = self.opened {
            if now() < opened.after_ms(SETTLE_MS) {
                return None;
            }
            self.opened = None;
            // Drops output that the Console was sending to the previous session.
            self.is_within = false;
            return Some(Received::Opened);
        }
        self.incoming.pop_front().map(Received::Byte)
    }

    /// Takes as many of `bytes` as fit and returns their number; discarded bytes count as taken.
    pub fn send(&mut self, bytes: &[u8], now: Instant) -> usize {
        if self.waits_since.is_some_and(|since| now >= since.after_ms(PATIENCE_MS)) {
            self.is_deaf = true;
            self.forget_replies();
        }
        bytes.iter().take_while(|byte| self.say(**byte)).count()
    }

    /// Takes a byte, if there is room.
    fn say(&mut self, byte: u8) -> bool {
        let resumes = self.is_cut && !self.is_within;
        if !self.is_open || self.opened.is_some() || self.is_deaf || (self.is_cut && !resumes) {
            self.is_cut = true;
        } else {
            if resumes && self.has_half && self.outgoing.push_back(b'\n').is_err() {
                return false;
            }
            self.is_cut = false;
            if self.outgoing.push_back(byte).is_err() {
                return false;
            }
        }
        self.is_within = byte != b'\n';
        true
    }

    fn forget_replies(&mut self) {
        self.is_cut |= !self.outgoing.is_empty() || self.is_within;
        self.outgoing.clear();
    }

    /// The host has opened or closed the port, or neither. Returns whether anything changed.
    pub fn set_open(&mut self, is_open: bool, now: Instant) -> bool {
        if self.is_open == is_open {
            return false;
        }
        self.is_open = is_open;
        self.session = self.session.wrapping_add(1);
        self.forget_replies();
        // Its packet is given up; how much of it the host has is not known.
        if self.waits_since.take().is_some() {
            self.is_cut = true;
        }
        self.is_deaf = false;
        self.opened = is_open.then_some(now);
        if is_open {
            self.has_stray = !self.has_room();
            self.incoming.clear();
        }
        true
    }

    /// Changes whenever the port is opened or closed: then a packet that was taken before must not be sent any more.
    #[must_use]
    pub const fn session(&self) -> u8 {
        self.session
    }

    /// The next packet for the host, which may be empty, if there is any.
    pub fn packet(&mut self, into: &mut [u8; PACKET], now: Instant) -> Option<usize> {
        if !self.is_open {
            return None;
        }
        let mut length = 0;
        for place in into {
            let Some(byte) = self.outgoing.pop_front() else { break };
            *place = byte;
            length += 1;
        }
        if length == 0 && !self.wants_end {
            return None;
        }
        self.waits_since = Some(now);
        Some(length)
    }

    /// The host has fetched everything before `packet`, and this one is under way.
    pub fn on_sent(&mut self, packet: &[u8]) {
        self.waits_since = None;
        self.is_deaf = false;
        self.wants_end = packet.len() == PACKET;
        if let Some(last) = packet.last() {
            self.has_half = *last != b'\n';
        }
    }

    /// Whether a packet from the host fits.
    #[must_use]
    pub fn has_room(&self) -> bool {
        INCOMING - self.incoming.len() >= PACKET
    }

    /// Whether a packet that is there already belongs to an earlier session; asked once.
    pub fn take_stray(&mut self) -> bool {
        core::mem::take(&mut self.has_stray)
    }

    /// A packet has come, for which there is room.
    pub fn on_packet(&mut self, packet: &[u8]) {
        for byte in packet {
            // There is room.
            let _ = self.incoming.push_back(*byte);
        }
    }
}

#[cfg(test)]
#[path = "usb_pump_tests.rs"]
mod tests;
