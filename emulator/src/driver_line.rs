//! A driver on its wire: the simulator's TMC2209, and the bits that it hears and sends.
//!
//! The firmware's edges come from its stores to the port. The driver's own edges are played at their instants of
//! virtual time. For each of them the run stops between two instructions.

use crate::board::{Emulated, Port};
use crate::uart_decoder::{Heard, Hearing};
use crate::wiring::{PORTS, Pin, Wiring};
use corehbot::motors::{MOTORS, Motor, MotorSet};
use corehbot_sim::tmc2209::Tmc2209;
use rigless::time::VirtualNanos;
use std::collections::VecDeque;

/// Number of the register SLAVECONF; its bits 8 to 11 are SENDDELAY (datasheet rev 1.09, section 5.1).
const SLAVECONF: u8 = 0x03;

/// A bit at the rate that the firmware states, in ns; only to measure how far its edges are from where they belong.
const STATED_BIT: f64 = 1e9 / 19_200.0;

/// A driver and its wire.
#[derive(Clone, Debug)]
pub struct DriverLine {
    /// The chip.
    pub chip: Tmc2209,
    /// Inverts one bit of every `noise`-th reply on the wire; 0 is never.
    pub noise: u32,
    /// The wire is shorted to the supply or to ground.
    pub short: Option<bool>,
    /// The firmware drove the wire while the driver did.
    pub collisions: u32,
    /// Times when the wire was driven by neither end, and no resistor pulled it up.
    pub floating: u32,
    /// Datagrams heard, and replies said.
    pub datagrams: [u32; 2],
    /// Furthest distance of an edge of the firmware's from where it belongs, seen from its datagram's first, in ns.
    pub jitter: u64,
    /// Where the wire is on the chip, if there is one.
    pin: Option<Pin>,
    is_driven: bool,
    hearing: Hearing,
    /// When the present datagram began.
    first: Option<u64>,
    /// Levels to come, and their times; the last entry releases the wire.
    saying: VecDeque<(u64, Option<bool>)>,
    is_saying: bool,
}

impl DriverLine {
    fn new(pin: Option<Pin>) -> Self {
        Self {
            // No jumper: both address pins are low.
            chip: Tmc2209::new(0),
            noise: 0,
            short: None,
            collisions: 0,
            floating: 0,
            datagrams: [0; 2],
            jitter: 0,
            pin,
            is_driven: false,
            hearing: Hearing::default(),
            first: None,
            saying: VecDeque::new(),
            is_saying: false,
        }
    }

    /// The firmware drives the wire, or does not.
    fn set(&mut self, at: u64, level: Option<bool>) {
        let was_driven = std::mem::replace(&mut self.is_driven, level.is_some());
        if self.is_saying {
            self.collisions += u32::from(self.is_driven);
            return;
        }
        self.listen(at);
        if self.hearing.is_late(at) {
            self.chip.rest();
        }
        if !was_driven {
            self.first = None;
        }
        self.hearing.edge(at, level.unwrap_or(true));
        if was_driven && self.is_driven {
            let first = *self.first.get_or_insert(at);
            let bits = (at - first) as f64 / STATED_BIT;
            self.jitter = self.jitter.max(((bits - bits.round()).abs() * STATED_BIT) as u64);
        }
    }

    /// Time of the next event of its own.
    fn next(&self) -> Option<u64> {
        if self.short.is_some() {
            return (!self.is_saying).then_some(0);
        }
        self.saying.front().map(|(at, _)| *at).or_else(|| self.hearing.next())
    }

    /// Advances to `at`: handles the heard bytes, and returns the new level of the wire if it changes.
    fn advance(&mut self, at: u64) -> Option<Option<bool>> {
        if self.short.is_some() {
            self.is_saying = true;
            return Some(self.short);
        }
        self.listen(at);
        let mut level = None;
        while let Some((_, new)) = self.saying.pop_front_if(|(due, _)| *due <= at) {
            self.collisions += u32::from(self.is_driven);
            self.is_saying = new.is_some();
            level = Some(new);
        }
        level
    }

    fn listen(&mut self, at: u64) {
        match self.hearing.take(at) {
            None => return,
            Some(Heard::Nothing) => self.chip.rest(),
            Some(Heard::Byte(byte)) => {
                if self.hearing.is_complete() {
                    self.datagrams[0] += 1;
                }
                self.chip.hear(byte);
            }
        }
        let mut reply: Vec<u8> = std::iter::from_fn(|| self.chip.say()).collect();
        if reply.is_empty() {
            return;
        }
        self.datagrams[1] += 1;
        if self.noise != 0
            && self.datagrams[1].is_multiple_of(self.noise)
            && let Some(byte) = reply.last_mut()
        {
            *byte ^= 0x10;
        }
        self.say(&reply);
    }

    /// Puts `reply` on the wire after the delay that SENDDELAY asks for (datasheet rev 1.09, sections 4.1.2 and 5.1).
    fn say(&mut self, reply: &[u8]) {
        let (bit, end) = self.hearing.clock();
        let delay = u64::from(self.chip.register(SLAVECONF) >> 8 & 0xF | 1) * 8;
        let instant = |bits: u64| end + (delay + bits) * bit;
        self.saying.push_back((instant(0), Some(false)));
        let bits = reply.iter().flat_map(|byte| (0..10).map(move |n| (u16::from(*byte) << 1 | 1 << 9) >> n & 1 != 0));
        for (n, is_high) in bits.enumerate() {
            self.saying.push_back((instant(n as u64), Some(is_high)));
        }
        // It lets go four bit times after the last stop bit.
        self.saying.push_back((instant(reply.len() as u64 * 10 + 4), None));
    }
}

/// The drivers of a board.
#[derive(Clone, Debug)]
pub struct DriverLines {
    lines: [DriverLine; MOTORS],
    /// The motors that the board has a slot for.
    motors: MotorSet,
    masks: [u16; PORTS],
    seen: [(u16, u16); PORTS],
    /// Time of the first event of its own.
    pub next: Option<u64>,
}

impl DriverLines {
    /// A driver in every slot of `wiring`, with motor supply and as new.
    #[must_use]
    pub fn new(wiring: &'static Wiring) -> Self {
        let mut masks = [0; PORTS];
        let pins = wiring.slots.map(|slot| slot.and_then(|slot| slot.uart));
        for pin in pins.into_iter().flatten() {
            masks[pin.port] |= pin.mask();
        }
        let lines = pins.map(DriverLine::new);
        Self { lines, motors: wiring.motors(), masks, seen: [(0, 0); PORTS], next: None }
    }

    /// The driver of `motor`, to change something about it.
    pub fn of(&mut self, motor: Motor) -> &mut DriverLine {
        self.next = Some(0);
        &mut self.lines[motor.index()]
    }

    /// The chip of `motor`, so that the motor's state can act on it.
    pub const fn chip(&mut self, motor: Motor) -> &mut Tmc2209 {
        &mut self.lines[motor.index()].chip
    }

    /// Every driver.
    pub fn iter(&self) -> impl Iterator<Item = &DriverLine> {
        self.by_motor().map(|(_, line)| line)
    }

    fn by_motor(&self) -> impl Iterator<Item = (Motor, &DriverLine)> {
        Motor::ALL.into_iter().zip(&self.lines).filter(|(motor, _)| self.motors.has(*motor))
    }

    /// Motors with a driver that makes another number of microsteps than `microsteps`.
    #[must_use]
    pub fn others_than(&self, microsteps: u32) -> MotorSet {
        let motors = self.by_motor().filter(|(_, line)| line.chip.microsteps() != microsteps);
        motors.fold(MotorSet::NONE, |set, (motor, _)| set.with(MotorSet::of(motor)))
    }

    /// Port `n` was written to. `is_pulled_up` returns whether an input has its resistor to the supply.
    pub fn store(&mut self, at: u64, n: usize, port: Port, is_pulled_up: impl FnOnce(Pin) -> bool) {
        let now = (port.outputs & self.masks[n], port.outputs & port.data & self.masks[n]);
        let (before, after) = (std::mem::replace(&mut self.seen[n], now), now);
        let changed = (before.0 ^ after.0) | (before.1 ^ after.1);
        if changed == 0 {
            return;
        }
        let mut is_pulled_up = Some(is_pulled_up);
        for line in &mut self.lines {
            let Some(pin) = line.pin.filter(|pin| pin.port == n && changed & pin.mask() != 0) else { continue };
            let mask = pin.mask();
            let level = (after.0 & mask != 0).then_some(after.1 & mask != 0);
            if level.is_none()
                && let Some(ask) = is_pulled_up.take()
            {
                line.floating += u32::from(!ask(pin));
            }
            line.set(at, level);
        }
        self.schedule();
    }

    /// Comes to `at`.
    pub fn advance(&mut self, board: &mut Emulated, at: VirtualNanos) {
        if self.next.is_none_or(|next| next > at.0) {
            return;
        }
        for line in &mut self.lines {
            if let (Some(level), Some(pin)) = (line.advance(at.0), line.pin) {
                board.put(at, pin, level);
            }
        }
        self.schedule();
    }

    fn schedule(&mut self) {
        self.next = self.lines.iter().filter_map(DriverLine::next).min();
    }
}
