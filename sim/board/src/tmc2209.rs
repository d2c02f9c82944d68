//! A TMC2209 as its datasheet (rev 1.09) describes it, seen from its one-wire UART.
//!
//! Written from the datasheet alone, with a register table and a CRC of its own, so that a mistake of the firmware
//! cannot hide in both. Bytes go in by [`Tmc2209::hear`] and come out by [`Tmc2209::say`]. The caller that connects the
//! wire decides the levels and times on it. Faults are set from outside.

mod registers;

use registers::{Access, TABLE, place};
pub use registers::{
    DRV_STATUS, GSTAT, IFCNT, IHOLD_IRUN, IOIN, MSCNT, PWMCONF, SG_RESULT, SGTHRS, TCOOLTHRS, TPWMTHRS, VACTUAL,
    chopconf, gconf,
};
use std::collections::VecDeque;

/// First byte of every datagram (section 4.1.1).
const SYNC: u8 = 0x05;

/// The address in a reply: the master's (section 4.1.2).
const MASTER: u8 = 0xFF;

/// The version of a TMC2209 in IOIN (section 5.1).
const VERSION: u32 = 0x21;

/// drv_err in GSTAT (section 5.1).
const DRV_ERR: u32 = 1 << 1;

/// uv_cp in GSTAT (section 5.1).
const UV_CP: u32 = 1 << 2;

/// Over-temperature and shorts in DRV_STATUS (section 5.5.3).
const SHUT_DOWN: u32 = 0x1F << 1;

/// Damage to a reply on its way.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Corruption {
    /// The bits of this mask flip in the byte of that place.
    Flip {
        /// Place of the byte, 0 to 7.
        byte: usize,
        /// Its bits.
        mask: u8,
    },
    /// The reply ends after this many bytes.
    Cut(usize),
    /// Value and CRC are zero: a whole reply that is not true.
    Zero,
}

/// The chip.
#[derive(Clone, Debug)]
pub struct Tmc2209 {
    /// The pins MS1 and MS2, which are the address too.
    address: u8,
    registers: [u32; TABLE.len()],
    is_powered: bool,
    /// It hears and does everything, but its answers do not arrive.
    pub is_silent: bool,
    /// Accepts writes, counts them, and keeps the old values.
    pub is_deaf: bool,
    /// Writes do not even count.
    pub is_write_protected: bool,
    heard: Vec<u8>,
    saying: VecDeque<u8>,
    replies: u32,
    has_spoken: bool,
    corrupt: Vec<(u32, Corruption)>,
    stubborn: Vec<(u8, u32)>,
}

impl Tmc2209 {
    /// A chip with motor supply, just switched on; its pins MS2 and MS1 make `address` (0 to 3).
    #[must_use]
    pub fn new(address: u8) -> Self {
        Self {
            address: address & 3,
            registers: TABLE.map(|(.., reset)| reset),
            is_powered: true,
            is_silent: false,
            is_deaf: false,
            is_write_protected: false,
            heard: Vec::new(),
            saying: VecDeque::new(),
            replies: 0,
            has_spoken: false,
            corrupt: Vec::new(),
            stubborn: Vec::new(),
        }
    }

    /// A byte from the wire. A datagram that is not for this chip, or is damaged, changes nothing.
    pub fn hear(&mut self, byte: u8) {
        if !self.is_powered {
            self.heard.clear();
            return;
        }
        self.heard.push(byte);
        if self.heard.first() != Some(&SYNC) {
            self.heard.clear();
            return;
        }
        let length = match self.heard.get(2) {
            None => return,
            Some(register) if register & 0x80 == 0 => 4,
            Some(_) => 8,
        };
        if self.heard.len() == length {
            let datagram = std::mem::take(&mut self.heard);
            self.obey(&datagram);
            // The memory is kept for the next datagram.
            self.heard = datagram;
            self.heard.clear();
        }
    }

    /// The wire was at rest for 63 bit times or more: whatever was heard is forgotten (section 4.1.1).
    pub fn rest(&mut self) {
        self.heard.clear();
    }

    /// The next byte that it puts on the wire.
    pub fn say(&mut self) -> Option<u8> {
        self.saying.pop_front()
    }

    /// A whole request, and the reply to it, as bytes.
    pub fn exchange(&mut self, request: &[u8]) -> Vec<u8> {
        self.rest();
        self.saying.clear();
        request.iter().for_each(|byte| self.hear(*byte));
        self.saying.drain(..).collect()
    }

    fn obey(&mut self, datagram: &[u8]) {
        let Some((sum, body)) = datagram.split_last() else { return };
        if crc(body) != *sum || body.get(1) != Some(&self.address) {
            return;
        }
        match *body {
            [_, _, register] => self.answer(register),
            [_, _, register, a, b, c, d] => self.write(register & 0x7F, u32::from_be_bytes([a, b, c, d])),
            _ => {}
        }
    }

    fn write(&mut self, address: u8, value: u32) {
        if self.is_write_protected {
            return;
        }
        // Section 5.1: IFCNT counts every successful write access, and wraps.
        self.set(IFCNT, (self.register(IFCNT) + 1) & 0xFF);
        let Some((_, access, bits, _)) = place(address).map(|place| &TABLE[place]) else { return };
        if self.is_deaf {
            return;
        }
        let value = (u64::from(value) & ((1 << bits) - 1)) as u32;
        match access {
            Access::Read => {}
            Access::Write | Access::ReadWrite => self.set(address, value),
            Access::ReadClear => self.set(address, self.register(address) & !value),
        }
    }

    fn answer(&mut self, address: u8) {
        if self.is_silent {
            return;
        }
        let mut reply = reply(address, self.readable(address));
        let mut length = reply.len();
        let number = self.replies;
        self.replies += 1;
        self.has_spoken |= !self.corrupt.iter().any(|(at, _)| *at == number);
        for (_, corruption) in self.corrupt.iter().filter(|(at, _)| *at == number) {
            match *corruption {
                Corruption::Flip { byte, mask } => {
                    if let Some(byte) = reply.get_mut(byte) {
                        *byte ^= mask;
                    }
                }
                Corruption::Cut(bytes) => length = length.min(bytes),
                Corruption::Zero => (reply, length) = (self::reply(address, 0), reply.len()),
            }
        }
        self.saying.extend(&reply[..length]);
    }

    /// The result of a read; write-only and missing registers give 0.
    fn readable(&self, address: u8) -> u32 {
        if let Some((_, value)) = self.stubborn.iter().find(|(at, _)| *at == address) {
            return *value;
        }
        match place(address).map(|place| (&TABLE[place], self.registers[place])) {
            None | Some(((_, Access::Write, ..), _)) => 0,
            Some(_) if address == IOIN => {
                let (ms1, ms2) = (u32::from(self.address & 1), u32::from(self.address >> 1));
                VERSION << 24 | ms2 << 3 | ms1 << 2
            }
            Some((_, value)) => value,
        }
    }

    /// The true content of a register, readable or not.
    #[must_use]
    pub fn register(&self, address: u8) -> u32 {
        place(address).map_or(0, |place| self.registers[place])
    }

    /// Puts something into a register as the chip itself would: a status, or the trace of a fault. A short circuit or
    /// heat switches it off, which GSTAT keeps (drv_err, section 5.1).
    pub fn set(&mut self, address: u8, value: u32) {
        if address == DRV_STATUS && value & SHUT_DOWN != 0 {
            self.set(GSTAT, self.register(GSTAT) | DRV_ERR);
        }
        if let Some(place) = place(address) {
            self.registers[place] = value;
        }
    }

    /// The motor supply goes away: every register is lost, and it says nothing.
    pub fn power_off(&mut self) {
        self.is_powered = false;
        self.heard.clear();
        self.saying.clear();
    }

    /// The motor supply comes back; the chip is as new.
    pub fn power_on(&mut self) {
        self.is_powered = true;
        self.has_spoken = false;
        self.registers = TABLE.map(|(.., reset)| reset);
    }

    /// The supply dipped: every register is lost, and it answers again.
    pub fn reset(&mut self) {
        self.power_off();
        self.power_on();
    }

    /// Whether it has motor supply.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        self.is_powered
    }

    /// Whether it drives its motor when it is enabled. It must have supply, must not have switched itself off, and its
    /// charge pump must not be too low (section 5.1: drv_err, uv_cp).
    #[must_use]
    pub fn is_driving(&self) -> bool {
        self.is_powered && self.register(GSTAT) & (DRV_ERR | UV_CP) == 0
    }

    /// Whether its registers size its steps, because it was configured; otherwise its pins do.
    #[must_use]
    pub fn is_configured(&self) -> bool {
        self.register(gconf::ADDRESS) & gconf::MSTEP_REG_SELECT != 0
    }

    /// Microsteps that a full step really has: by MRES (section 5.5.1), or by the pins MS2 and MS1 (pin table).
    #[must_use]
    pub fn microsteps(&self) -> u32 {
        if !self.is_configured() {
            return [8, 32, 64, 16][usize::from(self.address)];
        }
        let mres = (self.register(chopconf::ADDRESS) >> chopconf::MRES) & 0xF;
        256 >> mres.min(8)
    }

    /// Moves it by step pulses, counted in microsteps from its start; pulses with the direction line high count down.
    /// This sets its place in the sine table of 1024 entries (section 5.4). It counts without motor current too.
    pub fn step_to(&mut self, low_steps: i64) {
        let places = low_steps * i64::from(256 / self.microsteps());
        self.set(MSCNT, places.rem_euclid(1024) as u32);
    }

    /// Root mean square of the current at full run current, in mA, with sense resistors of 110 mOhm and the
    /// internal reference (section 9).
    #[must_use]
    pub fn run_current_ma(&self) -> f64 {
        let full_scale = if self.register(chopconf::ADDRESS) & chopconf::VSENSE == 0 { 0.325 } else { 0.180 };
        let scale = (self.register(IHOLD_IRUN) >> 8) & 0x1F;
        f64::from(scale + 1) / 32.0 * full_scale / (0.110 + 0.020) / 2f64.sqrt() * 1000.0
    }

    /// The reply of that number, counted from [`replies`](Self::replies) on, is damaged.
    pub fn corrupt_reply(&mut self, number: u32, corruption: Corruption) {
        self.corrupt.push((self.replies + number, corruption));
    }

    /// From now on this register reads as `value`, whatever is in it.
    pub fn answer_wrongly(&mut self, address: u8, value: u32) {
        self.stubborn.push((address, value));
    }

    /// Whether it has truly answered since its registers were last lost, so that the firmware could know of it.
    #[must_use]
    pub const fn has_spoken(&self) -> bool {
        self.has_spoken
    }

    /// Replies that it has begun.
    #[must_use]
    pub const fn replies(&self) -> u32 {
        self.replies
    }
}

/// A reply with the value of a register (section 4.1.2).
fn reply(address: u8, value: u32) -> [u8; 8] {
    let [a, b, c, d] = value.to_be_bytes();
    let mut reply = [SYNC, MASTER, address, a, b, c, d, 0];
    reply[7] = crc(&reply[..7]);
    reply
}

/// CRC-8 with polynomial x^8 + x^2 + x + 1, each byte from its least significant bit on (section 4.2).
#[must_use]
pub fn crc(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |crc, byte| CRC[usize::from(crc ^ byte.reverse_bits())])
}

/// The CRC of a byte, its bits reversed: looked up, because drivers are asked all the time.
const CRC: [u8; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < table.len() {
        let mut crc = byte as u8;
        let mut bit = 0;
        while bit < 8 {
            crc = crc << 1 ^ if crc & 0x80 == 0 { 0 } else { 0x07 };
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};
