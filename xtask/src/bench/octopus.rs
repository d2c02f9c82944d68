//! A step on the Octopus: the way of a plain event through the step interrupt of the image that is flashed.
//!
//! QEMU has no such board, so nothing runs here. The handler plays a plain event in a straight line, and all branches
//! of that line lead elsewhere. The instructions up to its return are counted in the image, with their waits.

use super::access::{Registers, effect};
use super::cycles::{EXCEPTION, cost};
use super::waits::{Bus, FLASH, LINE, bus, wait};
use crate::build::instruction::{Kind, decode};
use crate::image_code::Code;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot::port::STEP_PULSE_NS;
use std::collections::BTreeSet;

/// SysTick's vector (ARM DDI 0403E, B1.5.2).
const VECTOR: usize = 15;

/// A longer sequence is not a straight line.
const LONGEST: usize = 200;

/// A port's register that sets and resets pins (RM0390 rev 6, 7.4.7). The ports are found in RAM, so a store there
/// through an unknown pointer counts as a port access.
const BSRR: i32 = 0x18;

/// Ports that a plain event raises, and lowers again (`chips/stm32f446`, words.rs, QUICK).
const PORTS: usize = 3;

/// Cycles of 180 MHz between the last rise and the first fall, at the least.
const PULSE: u64 = (STEP_PULSE_NS as u64 * 180).div_ceil(1000);

/// Cycles that a handler's first instruction comes after the exception's request.
const ENTRY: u64 = 12;

/// The cycle counter, and the register that starts the timer (ARM DDI 0403E, C1.8.8 and B3.3.5). If it is set at once,
/// the timer fires this many cycles after its tick, less the cycles of [`ENTRY`] (`chips/stm32f446`, step_timer.rs,
/// EARLY).
const COUNTER: u32 = 0xE000_1004;
const START: u32 = 0xE000_E018;
const SET_BY: u64 = 5;

/// The cost of a plain event.
#[derive(Default)]
pub struct PlainStep {
    /// Instructions from the handler's first to its return.
    pub instructions: u64,
    /// Cycles with the exception's entry and return, and with all waits but those for flash.
    pub cycles: u64,
    /// Accesses to peripherals on APB.
    pub apb: u64,
    /// Flash lines that its code is in.
    pub lines: BTreeSet<u64>,
    /// Flash lines that its constants are in.
    pub constants: BTreeSet<u64>,
    /// Cycles from the begin of an event's tick to its first edge: if all is in the caches, and if nothing is.
    pub late: (u64, u64),
    /// Cycles from the last rise to the first fall, if nothing waits.
    pub pulse: u64,
}

impl PlainStep {
    /// Follows the handler of an image.
    pub fn of(code: &Code<'_>) -> Result<Self> {
        let step = Self::from(code, code.handler(VECTOR)?)?;
        ensure!(step.pulse >= PULSE, "step pulses are {} cycles, {PULSE} are wanted", step.pulse);
        Ok(step)
    }

    /// Follows a handler.
    fn from(code: &Code<'_>, handler: u64) -> Result<Self> {
        let mut line = Line { at: handler, registers: [None; 16], before: None, stored: 0 };
        // The core fetches the vector as it fetches instructions.
        let vector = (code.vectors() + 4 * VECTOR as u64) / LINE;
        let mut step = Self { cycles: ENTRY, lines: [vector].into(), ..Self::default() };
        let (mut stores, mut counter, mut set, mut waits) = (Vec::new(), 0, 0, 0);
        for _ in 0..LONGEST {
            let [first, second] = code.words(line.at);
            let passed = line.pass(code);
            step.instructions += 1;
            step.lines.extend([passed.at / LINE, (passed.at + passed.bytes - 1) / LINE]);
            step.constants.extend(passed.literal.map(|address| u64::from(address) / LINE));
            step.cycles += passed.cycles + passed.waits;
            waits += passed.waits;
            step.apb += u64::from(matches!(passed.bus, Some(Bus::Apb1 | Bus::Apb2)));
            let cold = FLASH * (step.lines.len() + step.constants.len()) as u64;
            if passed.is_port {
                stores.push((step.cycles, cold, step.cycles - waits));
            }
            match passed.address {
                Some(COUNTER) => counter = step.cycles,
                Some(START) => set = step.cycles,
                _ => {}
            }
            if is_return(first, second) {
                step.cycles += EXCEPTION - ENTRY;
                let edge = stores.first().context("the step interrupt stores to no port")?;
                ensure!(stores.len() == 2 * PORTS, "the step interrupt stores to {} ports", stores.len());
                // The timer is set some cycles after the counter was read, and rings as much later.
                let late = edge.0 - ENTRY + (set - counter).saturating_sub(SET_BY);
                step.late = (late, late + edge.1);
                step.pulse = stores[PORTS].2 - stores[PORTS - 1].2;
                return Ok(step);
            }
            // B in two bytes, and branches out of the line in four.
            if first >> 11 == 0b11100 || matches!(decode(first, second).kind, Kind::Branch(_) | Kind::Indirect) {
                bail!("the step interrupt jumps about at {:#010x}: it is no straight line", passed.at);
            }
        }
        bail!("the step interrupt does not return within {LONGEST} instructions");
    }

    /// Cycles if nothing of it is in the caches.
    pub fn cold(&self) -> u64 {
        self.cycles + FLASH * (self.lines.len() + self.constants.len()) as u64
    }
}

/// A straight line of code that is followed.
struct Line {
    at: u64,
    registers: Registers,
    /// Registers that the instruction before wrote, and whether it loaded one of them.
    before: Option<(u16, bool)>,
    /// Cycles for which a store is still under way.
    stored: u64,
}

/// An instruction that was passed.
struct Passed {
    at: u64,
    bytes: u64,
    /// Its own cycles, and its wait cycles.
    cycles: u64,
    waits: u64,
    /// The accessed address, if it is known.
    address: Option<u32>,
    bus: Option<Bus>,
    /// Where its constant is.
    literal: Option<u32>,
    /// Whether it stored to a port.
    is_port: bool,
}

impl Line {
    /// Passes one instruction.
    fn pass(&mut self, code: &Code<'_>) -> Passed {
        let at = self.at;
        let [first, second] = code.words(at);
        let (cost, effect) = (cost(first, second), effect(first, second, &self.registers));
        let access = effect.access;
        let address = access.and_then(|access| access.address(&self.registers, at));
        let (written, has_loaded) = self.before.unwrap_or_default();
        let uses = |register: usize| written >> register & 1 == 1;
        let needs = access.is_some_and(|access| uses(access.base) || access.index.is_some_and(uses));
        let is_one = access.is_some_and(|access| access.words == 1 && !access.is_store);
        let mut cycles = cost.cycles;
        // Loads overlap unless the second one needs the result of the first; an address that was only just computed is
        // a cycle late (ARM 100166, 3.3.2).
        cycles -= u64::from(is_one && cost.is_load && has_loaded && !needs);
        cycles += u64::from(needs && !has_loaded && written != 0);
        let is_port = access.is_some_and(|access| access.is_store && access.offset == BSRR && access.words == 1)
            && address.is_none_or(|address| bus(address) == Bus::Ahb);
        let bus = address.map(bus).or(is_port.then_some(Bus::Ahb));
        // A store runs in parallel with the program, up to the next load or store (ARM 100166, 3.3.2), except a store
        // to the core's own registers.
        let wait = bus.map_or(0, wait) * access.map_or(0, |access| access.words);
        let is_beside = access.is_some_and(|access| access.is_store) && bus != Some(Bus::Core);
        let mut waits = if access.is_some() { std::mem::take(&mut self.stored) } else { 0 };
        if is_beside {
            self.stored = wait;
        } else {
            waits += wait;
            self.stored = self.stored.saturating_sub(cycles);
        }
        let literal = address.filter(|_| access.is_some_and(|access| access.base == 15));
        for register in (0..16).filter(|register| effect.written >> register & 1 == 1) {
            self.registers[register] = None;
        }
        if let Some((register, value)) = effect.known {
            self.registers[register] = Some(value);
        }
        if let (Some(address), Some(register)) =
            (literal, (effect.written != 0).then(|| effect.written.trailing_zeros()))
        {
            let [low, high] = code.words(u64::from(address));
            self.registers[register as usize] = Some(u32::from(high) << 16 | u32::from(low));
        }
        // The update of a stack pointer by a load or store is not a result that a later instruction waits for.
        let written = if access.is_some_and(|access| access.is_store) { 0 } else { effect.written };
        self.before = Some((written, cost.is_load && is_one));
        self.at += 2 * cost.length;
        Passed { at, bytes: 2 * cost.length, cycles, waits, address, bus, literal, is_port }
    }
}

/// POP, or LDM from SP, with PC; LDR of PC from SP; BX LR (ARM DDI 0403E, A7.7).
const fn is_return(first: u16, second: u16) -> bool {
    match first {
        0x4770 => true,
        0xE8BD => second & 0x8000 != 0,
        0xF85D => second & 0xF000 == 0xF000,
        _ => first & 0xFF00 == 0xBD00,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_are_distinguished_from_others() {
        assert!(is_return(0xBDF0, 0), "pop {{r4-r7, pc}}");
        assert!(is_return(0xE8BD, 0x81F0), "pop.w {{r4-r8, pc}}");
        assert!(is_return(0x4770, 0), "bx lr");
        assert!(!is_return(0xE8BD, 0x41F0), "pop.w {{r4-r8, lr}}");
        assert!(!is_return(0xB5F0, 0), "push");
        assert!(!is_return(0xF85D, 0x8B04), "ldr r8, [sp], #4");
    }
}
