//! The state of an endpoint.

use crate::bits::{CNAK, DPID, EPENA, NAKSTS, SD0PID, SD1PID, SNAK, STALL, STORED, USBAEP};
use std::collections::VecDeque;

/// What both directions have.
#[derive(Clone, Debug, Default)]
pub struct Endpoint {
    /// The bits that are stored as written.
    stored: u32,
    pub is_active: bool,
    pub is_enabled: bool,
    pub is_nak: bool,
    pub is_stalled: bool,
    /// The next packet is DATA1.
    pub toggle: bool,
    /// Flags of its interrupt register.
    pub flags: u32,
    /// XFRSIZ: bytes that are left, for IN to be written and for OUT to come.
    pub size: u32,
    /// PKTCNT.
    pub packets: u32,
}

impl Endpoint {
    /// An endpoint after a reset.
    pub fn new(number: usize) -> Self {
        Self { is_active: number == 0, ..Self::default() }
    }

    /// Bytes of the longest packet.
    pub fn longest(&self, number: usize) -> u32 {
        match (number, self.stored & 3) {
            // Endpoint 0 has a code in place of a number.
            (0, code) => 64 >> code,
            _ => self.stored & 0x7FF,
        }
    }

    /// Its control register.
    pub fn control(&self) -> u32 {
        let flags = [
            (USBAEP, self.is_active),
            (DPID, self.toggle),
            (NAKSTS, self.is_nak),
            (STALL, self.is_stalled),
            (EPENA, self.is_enabled),
        ];
        flags.into_iter().filter(|(_, is_set)| *is_set).fold(self.stored, |word, (bit, _)| word | bit)
    }

    /// The part of a write to the control register that is alike in both directions. Returns whether NAK was set anew.
    pub fn set_control(&mut self, number: usize, value: u32) -> bool {
        self.stored = value & STORED;
        if number == 0 {
            // The program sets it and the core clears it (RM0390, STALL of DIEPCTL0).
            self.is_stalled |= value & STALL != 0;
        } else {
            self.is_active = value & USBAEP != 0;
            self.is_stalled = value & STALL != 0;
            if value & (SD0PID | SD1PID) != 0 {
                self.toggle = value & SD1PID != 0;
            }
        }
        let is_set = value & SNAK != 0;
        self.is_nak = is_set || (self.is_nak && value & CNAK == 0);
        is_set
    }
}

/// An IN endpoint, with its transmit FIFO.
#[derive(Clone, Debug, Default)]
pub struct InEndpoint {
    pub common: Endpoint,
    /// Words in the FIFO.
    pub fifo: VecDeque<u32>,
    /// Bytes of the transfer that the host has not got.
    pub to_send: u32,
}

/// An OUT endpoint.
#[derive(Clone, Debug, Default)]
pub struct OutEndpoint {
    pub common: Endpoint,
    /// STUPCNT: SETUP packets in a row that are still expected.
    pub setups: u32,
}
