//! The core as a host sees it: tokens and handshakes, and the states of the bus.

use crate::bits as b;
use crate::breach::Breach;
use crate::core::{ENDPOINTS, UsbCore};
use crate::fifo::Status;

/// The answer to a packet of a host.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Handshake {
    /// Taken.
    Ack,
    /// Not now.
    Nak,
    /// The endpoint is halted, or the request is refused.
    Stall,
    /// No answer: nobody is there, or the packet was damaged.
    Silence,
}

/// The answer to a host that asks for data.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum InAnswer {
    /// A packet, which comes again until [`UsbCore::acknowledge`].
    Data {
        /// DATA1.
        toggle: bool,
        /// Its bytes.
        bytes: Vec<u8>,
    },
    /// There is none now.
    Nak,
    /// The endpoint is halted, or the request is refused.
    Stall,
    /// No answer.
    Silence,
}

impl UsbCore {
    /// Whether the pull-up of D+ tells the host of a device.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.dctl & b::SDIS == 0
    }

    /// The host resets the bus.
    pub fn bus_reset(&mut self) {
        if !self.is_connected() {
            return;
        }
        self.is_suspended = false;
        self.is_in_setup = false;
        self.flags |= b::USBRST;
        for n in 1..ENDPOINTS {
            self.ins[n].common.is_active = false;
            self.outs[n].common.is_active = false;
        }
    }

    /// The reset is over, and the speed is known.
    pub fn end_reset(&mut self) {
        if self.is_connected() {
            self.flags |= b::ENUMDNE;
        }
    }

    /// Nothing was on the bus for 3 ms.
    pub fn suspend(&mut self) {
        self.is_suspended = true;
        self.flags |= b::ESUSP | b::USBSUSP;
    }

    /// The host goes on after a suspend.
    pub fn resume(&mut self) {
        self.is_suspended = false;
        self.flags |= b::WKUPINT;
    }

    /// A start of frame.
    pub fn start_frame(&mut self, number: u16) {
        self.frame = number & 0x3FFF;
        self.flags |= b::SOF;
    }

    /// A session was requested (SRQINT), as a core says that senses VBUS.
    pub fn begin_session(&mut self) {
        self.flags |= b::SRQINT;
    }

    /// A SETUP packet to endpoint 0.
    pub fn setup(&mut self, address: u8, data: [u8; 8]) -> Handshake {
        if !self.hears(address) || !self.has_room(8, true) {
            return Handshake::Silence;
        }
        // The stage of an earlier SETUP packet has no end of its own.
        self.is_in_setup = true;
        self.received.push(Status::Setup, 0, false, &data);
        let out = &mut self.outs[0];
        if out.setups == 0 {
            out.common.flags |= b::B2BSTUP;
        }
        out.setups = out.setups.saturating_sub(1);
        for common in [&mut self.outs[0].common, &mut self.ins[0].common] {
            // Both stages that follow begin with DATA1.
            (common.is_nak, common.is_stalled, common.toggle) = (true, false, true);
        }
        Handshake::Ack
    }

    /// A packet to an OUT endpoint.
    pub fn out(&mut self, address: u8, n: usize, toggle: bool, data: &[u8]) -> Handshake {
        if !self.hears(address) || n >= ENDPOINTS || !self.outs[n].common.is_active {
            return Handshake::Silence;
        }
        self.end_setup(n);
        let has_room = self.has_room(data.len(), false);
        let is_held = self.has_global_out_nak;
        let common = &mut self.outs[n].common;
        if common.is_stalled {
            return Handshake::Stall;
        }
        if common.is_nak || is_held || !common.is_enabled || common.packets == 0 || !has_room {
            return Handshake::Nak;
        }
        if data.len() > common.longest(n) as usize {
            // Babble: the core drops it.
            return Handshake::Silence;
        }
        if toggle != common.toggle {
            // The host has not heard the last handshake (USB 2.0, section 8.6.4).
            return Handshake::Ack;
        }
        common.toggle = !common.toggle;
        common.packets -= 1;
        common.size = common.size.saturating_sub(data.len() as u32);
        let is_over = common.packets == 0 || data.len() < common.longest(n) as usize;
        self.received.push(Status::Data, n, toggle, data);
        if is_over {
            self.outs[n].common.is_nak = true;
            self.received.push(Status::OutDone, n, false, &[]);
        }
        Handshake::Ack
    }

    /// The host asks an IN endpoint for a packet.
    pub fn ask(&mut self, address: u8, n: usize) -> InAnswer {
        if !self.hears(address) || n >= ENDPOINTS || !self.ins[n].common.is_active {
            return InAnswer::Silence;
        }
        self.end_setup(n);
        let is_held = self.has_global_in_nak;
        let endpoint = &mut self.ins[n];
        let common = &mut endpoint.common;
        if common.is_stalled {
            return InAnswer::Stall;
        }
        if common.is_nak || is_held || !common.is_enabled {
            return InAnswer::Nak;
        }
        let length = endpoint.to_send.min(common.longest(n)) as usize;
        if endpoint.fifo.len() < length.div_ceil(4) {
            common.flags |= b::ITTXFE;
            return InAnswer::Nak;
        }
        let mut bytes: Vec<u8> = endpoint.fifo.iter().flat_map(|word| word.to_le_bytes()).take(length).collect();
        bytes.truncate(length);
        InAnswer::Data { toggle: common.toggle, bytes }
    }

    /// The host has the packet that [`UsbCore::ask`] gave it.
    pub fn acknowledge(&mut self, n: usize) {
        let endpoint = &mut self.ins[n];
        let length = endpoint.to_send.min(endpoint.common.longest(n));
        endpoint.to_send -= length;
        if n == 0 {
            // The status stage of SET_ADDRESS still has the old address (RM0390 rev 6, section 31.16.4).
            self.address = self.own_address();
        }
        let endpoint = &mut self.ins[n];
        endpoint.fifo.drain(..length.div_ceil(4) as usize);
        let common = &mut endpoint.common;
        common.toggle = !common.toggle;
        common.packets = common.packets.saturating_sub(1);
        if common.packets == 0 {
            (common.is_enabled, common.flags) = (false, common.flags | b::XFRC);
        }
    }

    /// Whether a packet to `address` reaches the core.
    fn hears(&mut self, address: u8) -> bool {
        let turnaround = self.gusbcfg >> 10 & 0xF;
        if turnaround != b::FULL_SPEED_TRDT && self.is_connected() {
            self.note(Breach::Turnaround(turnaround));
        }
        self.is_connected()
            && !self.is_suspended
            && self.address == address
            && self.flags & (b::USBRST | b::ENUMDNE) == 0
    }

    /// The first token after a SETUP packet ends its stage.
    fn end_setup(&mut self, n: usize) {
        if n == 0 && std::mem::take(&mut self.is_in_setup) {
            self.received.push(Status::SetupDone, 0, false, &[]);
        }
    }
}
