//! A host: transfers in stages, with toggles and retries, as USB 2.0 (chapter 8) has them. It sends one packet a turn,
//! so a program under test runs between any two.

use crate::bus::{Handshake, InAnswer};
use crate::core::{ENDPOINTS, UsbCore};
use std::collections::VecDeque;

/// Attempts at a packet without an answer, before a transfer fails (USB 2.0, section 10.2.6).
const ATTEMPTS: u32 = 3;

/// Requests of chapter 9 that change toggles.
const CLEAR_FEATURE: u8 = 1;
const SET_ADDRESS: u8 = 5;
const SET_CONFIGURATION: u8 = 9;
const SET_INTERFACE: u8 = 11;

/// A transfer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Transfer {
    /// A request to endpoint 0.
    Control {
        /// The eight bytes of the request.
        setup: [u8; 8],
        /// Data to the device; empty if data come from it.
        data: Vec<u8>,
    },
    /// Up to `length` bytes from a bulk or interrupt endpoint; a short packet ends it.
    In {
        /// The endpoint.
        endpoint: usize,
        /// Bytes at most.
        length: usize,
    },
    /// Bytes to a bulk endpoint.
    Out {
        /// The endpoint.
        endpoint: usize,
        /// The bytes.
        data: Vec<u8>,
    },
}

/// How a transfer ended.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Outcome {
    /// Done, with the bytes from the device.
    Done(Vec<u8>),
    /// The endpoint is halted, or the request was refused.
    Stalled,
    /// Nobody answered.
    Lost,
}

/// The stages of a transfer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stage {
    Setup,
    DataIn,
    DataOut,
    StatusIn,
    StatusOut,
}

/// A transfer under way.
#[derive(Clone, Debug)]
struct Work {
    id: u32,
    transfer: Transfer,
    stage: Stage,
    /// Bytes that went out.
    sent: usize,
    /// Bytes that came in.
    got: Vec<u8>,
    silences: u32,
}

/// How a packet went.
enum Step {
    /// Nothing moved.
    Refused,
    /// A packet was taken.
    Moved,
    Ended(Outcome),
}

/// The host. A driver of endpoint sizes is not in it: packets have 64 bytes, or 8 for interrupt endpoints as the device
/// chooses.
#[derive(Clone, Debug, Default)]
pub struct UsbHost {
    /// The address that the device has.
    pub address: u8,
    toggles: [[bool; ENDPOINTS]; 2],
    work: Vec<Work>,
    ended: VecDeque<(u32, Outcome)>,
    next_id: u32,
    /// The transfer that has the next turn.
    place: usize,
    /// Loses the handshake of every n-th packet, if it is not 0.
    pub lost_handshakes: u32,
    packets: u32,
}

/// Bytes of a bulk or control packet at full speed.
pub const PACKET: usize = 64;

impl UsbHost {
    /// A host with nothing to do.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Resets the bus. Transfers under way are lost.
    pub fn reset(&mut self, core: &mut UsbCore) {
        core.bus_reset();
        (self.address, self.toggles) = (0, [[false; ENDPOINTS]; 2]);
        let lost = std::mem::take(&mut self.work);
        self.ended.extend(lost.into_iter().map(|work| (work.id, Outcome::Lost)));
    }

    /// Begins a transfer, and returns its number.
    pub fn submit(&mut self, transfer: Transfer) -> u32 {
        self.next_id += 1;
        let stage = match transfer {
            Transfer::Control { .. } => Stage::Setup,
            Transfer::In { .. } => Stage::DataIn,
            Transfer::Out { .. } => Stage::DataOut,
        };
        self.work.push(Work { id: self.next_id, transfer, stage, sent: 0, got: Vec::new(), silences: 0 });
        self.next_id
    }

    /// Ends a transfer without an outcome. Returns whether it was under way.
    pub fn cancel(&mut self, id: u32) -> bool {
        let before = self.work.len();
        self.work.retain(|work| work.id != id);
        self.work.len() != before
    }

    /// A transfer that has ended.
    pub fn take_ended(&mut self) -> Option<(u32, Outcome)> {
        self.ended.pop_front()
    }

    /// Whether transfers are under way.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        !self.work.is_empty()
    }

    /// Sends a packet of the first transfer that gets on, each in its turn. Returns whether one did.
    pub fn turn(&mut self, core: &mut UsbCore) -> bool {
        for _ in 0..self.work.len() {
            self.place = if self.place + 1 < self.work.len() { self.place + 1 } else { 0 };
            let mut work = self.work.remove(self.place);
            let is_behind = self.work[..self.place].iter().any(|other| other.uses(&work));
            let step = if is_behind { Step::Refused } else { self.step(&mut work, core) };
            match step {
                Step::Ended(outcome) => {
                    self.after(&work.transfer, &outcome);
                    self.ended.push_back((work.id, outcome));
                    return true;
                }
                Step::Moved => {
                    self.work.insert(self.place, work);
                    return true;
                }
                Step::Refused => self.work.insert(self.place, work),
            }
        }
        false
    }

    /// The host's own side of a request that was carried out.
    fn after(&mut self, transfer: &Transfer, outcome: &Outcome) {
        let Transfer::Control { setup, .. } = transfer else { return };
        if !matches!(outcome, Outcome::Done(_)) {
            return;
        }
        let [kind, request, value, _, index, ..] = *setup;
        match (kind, request) {
            (0, SET_ADDRESS) => self.address = value,
            (0, SET_CONFIGURATION) | (1, SET_INTERFACE) => self.toggles = [[false; ENDPOINTS]; 2],
            (2, CLEAR_FEATURE) => {
                if let Some(toggle) = self.toggles[usize::from(index >> 7)].get_mut(usize::from(index & 0xF)) {
                    *toggle = false;
                }
            }
            _ => {}
        }
    }

    fn step(&mut self, work: &mut Work, core: &mut UsbCore) -> Step {
        match (work.stage, &work.transfer) {
            (Stage::Setup, Transfer::Control { setup, .. }) => self.send_setup(*setup, work, core),
            (Stage::DataOut, Transfer::Control { data, .. }) => self.send(0, data.clone(), work, core),
            (Stage::DataOut, Transfer::Out { endpoint, data }) => self.send(*endpoint, data.clone(), work, core),
            (Stage::StatusOut, _) => self.send(0, Vec::new(), work, core),
            (Stage::DataIn, Transfer::In { endpoint, length }) => self.ask(*endpoint, *length, work, core),
            (Stage::DataIn, Transfer::Control { setup, .. }) => self.ask(0, length_of(*setup), work, core),
            _ => self.ask(0, 0, work, core),
        }
    }

    fn send_setup(&mut self, setup: [u8; 8], work: &mut Work, core: &mut UsbCore) -> Step {
        if core.setup(self.address, setup) != Handshake::Ack {
            return work.silence();
        }
        (self.toggles[0][0], self.toggles[1][0]) = (true, true);
        work.silences = 0;
        work.stage = match (setup[0] & 0x80 != 0, length_of(setup)) {
            (_, 0) => Stage::StatusIn,
            (true, _) => Stage::DataIn,
            (false, _) => Stage::DataOut,
        };
        Step::Moved
    }

    /// The handshake of this packet does not reach its sender.
    fn is_lost(&mut self) -> bool {
        self.packets = self.packets.wrapping_add(1);
        self.lost_handshakes > 0 && self.packets.is_multiple_of(self.lost_handshakes)
    }

    fn send(&mut self, n: usize, data: Vec<u8>, work: &mut Work, core: &mut UsbCore) -> Step {
        let from = if work.stage == Stage::StatusOut { 0 } else { work.sent };
        let packet = &data[from..data.len().min(from + PACKET)];
        match core.out(self.address, n, self.toggles[0][n], packet) {
            Handshake::Ack if self.is_lost() => work.silence(),
            Handshake::Ack => {
                self.toggles[0][n] = !self.toggles[0][n];
                work.silences = 0;
                work.sent += packet.len();
                let is_over = work.sent >= data.len();
                match (work.stage, &work.transfer) {
                    (Stage::StatusOut, _) => Step::Ended(Outcome::Done(std::mem::take(&mut work.got))),
                    (_, Transfer::Control { .. }) if is_over => {
                        (work.stage, self.toggles[1][0]) = (Stage::StatusIn, true);
                        Step::Moved
                    }
                    _ if is_over => Step::Ended(Outcome::Done(Vec::new())),
                    _ => Step::Moved,
                }
            }
            Handshake::Nak => Step::Refused,
            Handshake::Stall => Step::Ended(Outcome::Stalled),
            Handshake::Silence => work.silence(),
        }
    }

    fn ask(&mut self, n: usize, length: usize, work: &mut Work, core: &mut UsbCore) -> Step {
        match core.ask(self.address, n) {
            InAnswer::Data { toggle, bytes } => {
                // A packet with the wrong toggle was got before; it is acknowledged again and dropped.
                let is_new = toggle == self.toggles[1][n];
                if is_new {
                    self.toggles[1][n] = !toggle;
                    work.got.extend(&bytes);
                }
                work.silences = 0;
                if self.is_lost() {
                    return if is_new { work.after_in(&bytes, length, &mut self.toggles) } else { Step::Moved };
                }
                core.acknowledge(n);
                if is_new { work.after_in(&bytes, length, &mut self.toggles) } else { Step::Moved }
            }
            InAnswer::Nak => Step::Refused,
            InAnswer::Stall => Step::Ended(Outcome::Stalled),
            InAnswer::Silence => work.silence(),
        }
    }
}

impl Work {
    /// The endpoint and direction that it uses; control transfers use endpoint 0 alone.
    fn pipe(&self) -> (usize, bool) {
        match self.transfer {
            Transfer::Control { .. } => (0, false),
            Transfer::In { endpoint, .. } => (endpoint, true),
            Transfer::Out { endpoint, .. } => (endpoint, false),
        }
    }

    /// Whether both use the same pipe, so that one has to wait for the other.
    fn uses(&self, other: &Self) -> bool {
        self.pipe() == other.pipe()
    }

    fn silence(&mut self) -> Step {
        self.silences += 1;
        if self.silences < ATTEMPTS { Step::Refused } else { Step::Ended(Outcome::Lost) }
    }

    /// A packet of `bytes` came, of `length` wanted ones.
    fn after_in(&mut self, bytes: &[u8], length: usize, toggles: &mut [[bool; ENDPOINTS]; 2]) -> Step {
        let is_over = bytes.len() < PACKET || self.got.len() >= length;
        match (self.stage, &self.transfer) {
            (Stage::StatusIn, _) => Step::Ended(Outcome::Done(Vec::new())),
            (_, Transfer::Control { .. }) if is_over => {
                (self.stage, toggles[0][0]) = (Stage::StatusOut, true);
                Step::Moved
            }
            _ if is_over => Step::Ended(Outcome::Done(std::mem::take(&mut self.got))),
            _ => Step::Moved,
        }
    }
}

/// wLength of a request.
fn length_of(setup: [u8; 8]) -> usize {
    usize::from(u16::from_le_bytes([setup[6], setup[7]]))
}
