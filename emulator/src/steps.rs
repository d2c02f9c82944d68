//! Step events as the pins show them.
//!
//! The firmware raises the step lines of one event with one store a port, and lowers them all before the next event. So
//! an event is every rise until the first fall. [`WINDOW_NS`] bounds it: a later rise is an event of its own, whatever
//! the firmware intended.

use crate::board::Port;
use crate::timer::Schedule;
use crate::wiring::{PORTS, Wiring};
use corehbot::motors::{MOTORS, MotorSet, prototype};

/// Rises further apart than this belong to different events: 1 us, a twentieth of the closest spacing of one motor.
pub const WINDOW_NS: u64 = 1000;

/// One step event.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StepEvent {
    /// When the first line rose, in ns since reset.
    pub at: u64,
    /// Motors with a rising step line.
    pub steps: MotorSet,
    /// Direction lines of those motors when they rose.
    pub forward: MotorSet,
    /// From the first rise to the last, in ns.
    pub spread: u32,
    /// Its scheduled time.
    pub schedule: Option<Schedule>,
}

/// Shortest times seen, in ns.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pulse {
    /// A step line high.
    pub high: u64,
    /// A step line low.
    pub low: u64,
    /// From a change of a motor's direction line to its step.
    pub set_up: u64,
}

/// Watches step and direction lines.
#[derive(Debug)]
pub struct Recorder {
    wiring: &'static Wiring,
    masks: [u16; PORTS],
    levels: [u16; PORTS],
    high: MotorSet,
    forward: MotorSet,
    rose: [u64; MOTORS],
    fell: [Option<u64>; MOTORS],
    turned: [Option<u64>; MOTORS],
    open: bool,
    /// All events so far.
    pub events: Vec<StepEvent>,
    /// Shortest times.
    pub pulse: Pulse,
    /// Events in which the motors of a pair rose with two stores.
    pub split_pairs: u64,
    /// Steps of motors without power.
    pub unpowered: u64,
    /// Those motors.
    pub without_power: MotorSet,
}

/// Pairs of motors that share a belt half, and must step in one store.
const PAIRS: [MotorSet; 2] = [
    MotorSet(MotorSet::of(prototype::M1).0 | MotorSet::of(prototype::M8).0),
    MotorSet(MotorSet::of(prototype::M4).0 | MotorSet::of(prototype::M11).0),
];

impl Recorder {
    /// A recorder for the pins of `wiring`, all of them low.
    #[must_use]
    pub fn new(wiring: &'static Wiring) -> Self {
        let mut masks = [0; PORTS];
        for slot in wiring.slots.iter().flatten() {
            masks[slot.step.port] |= slot.step.mask();
            masks[slot.dir.port] |= slot.dir.mask();
        }
        Self {
            wiring,
            masks,
            levels: [0; PORTS],
            high: MotorSet::NONE,
            forward: MotorSet::NONE,
            rose: [0; MOTORS],
            fell: [None; MOTORS],
            turned: [None; MOTORS],
            open: false,
            events: Vec::new(),
            pulse: Pulse { high: u64::MAX, low: u64::MAX, set_up: u64::MAX },
            split_pairs: 0,
            unpowered: 0,
            without_power: MotorSet::NONE,
        }
    }

    /// Port `n` was written to at `at`; returns the motors that stepped, and their directions.
    pub fn store(&mut self, at: u64, n: usize, port: Port, powered: MotorSet) -> (MotorSet, MotorSet) {
        let levels = port.high() & self.masks[n];
        let changed = levels ^ self.levels[n];
        if changed == 0 {
            return (MotorSet::NONE, MotorSet::NONE);
        }
        self.levels[n] = levels;
        let (mut rises, mut falls) = (MotorSet::NONE, MotorSet::NONE);
        for slot in self.wiring.slots.iter().flatten() {
            let i = slot.motor.index();
            let one = MotorSet::of(slot.motor);
            if slot.dir.port == n && changed & slot.dir.mask() != 0 {
                self.forward = MotorSet(self.forward.0 ^ one.0);
                self.turned[i] = Some(at);
            }
            if slot.step.port == n && changed & slot.step.mask() != 0 {
                if levels & slot.step.mask() != 0 {
                    rises = rises.with(one);
                    self.rose[i] = at;
                } else {
                    falls = falls.with(one);
                    self.pulse.high = self.pulse.high.min(at - self.rose[i]);
                    self.fell[i] = Some(at);
                }
            }
        }
        self.high = self.high.with(rises).without(falls);
        if !falls.is_empty() {
            self.open = false;
        }
        if !rises.is_empty() {
            self.rise(at, rises, powered);
        }
        (rises, MotorSet(self.forward.0 & rises.0))
    }

    fn rise(&mut self, at: u64, rises: MotorSet, powered: MotorSet) {
        for i in 0..MOTORS {
            if rises.0 & 1 << i != 0 {
                let since = |then: Option<u64>| then.map_or(u64::MAX, |then| at - then);
                self.pulse.low = self.pulse.low.min(since(self.fell[i]));
                self.pulse.set_up = self.pulse.set_up.min(since(self.turned[i].take()));
            }
        }
        self.unpowered += u64::from(rises.without(powered).0.count_ones());
        self.without_power = self.without_power.with(rises.without(powered));
        let forward = MotorSet(self.forward.0 & rises.0);
        let split = |before: MotorSet| {
            PAIRS.iter().filter(|pair| before.0 & pair.0 != 0 && rises.0 & pair.0 != 0).count() as u64
        };
        match self.events.last_mut() {
            Some(event) if self.open && at - event.at <= WINDOW_NS => {
                self.split_pairs += split(event.steps);
                event.steps = event.steps.with(rises);
                event.forward = event.forward.with(forward);
                event.spread = (at - event.at) as u32;
            }
            _ => {
                self.events.push(StepEvent { at, steps: rises, forward, spread: 0, schedule: None });
                self.open = true;
            }
        }
    }
}

#[cfg(test)]
mod tests;
