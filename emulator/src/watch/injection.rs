//! Faults that a run injects: into the bus, the drivers, the supply, the image itself.

use super::{BadWord, FlipEach, GPIO, PORT_SIZE, Watch};
use crate::board::Emulated;
use crate::trap::{FALLEN, TRIGGER};
use crate::wiring::{PORTS, RAIL};
use corehbot::motors::Motor;
use rigless::device::Level;
use rigless::emulator::{self, InterruptLine};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// A supply that has fallen, in mV, as long as it lasts after the reset that it brings about: 10 ms.
const LOW_SUPPLY: u32 = 2900;
const LOW_NS: u64 = 10_000_000;

/// Where a supply that falls must have been armed for: PVDO in PWR_CSR, and line 16 in EXTI_IMR and EXTI_RTSR (RM0390
/// rev 6, sections 5.5.2, 10.3.1 and 10.3.3).
const DETECTOR: [(u64, u64); 3] = [(0x4000_7004, 1 << 2), (0x4001_3C00, 1 << 16), (0x4001_3C08, 1 << 16)];

/// RCC_CR, and PLLON in it (RM0390 rev 6, section 6.3.1).
const RCC_CR: u64 = 0x4002_3800;
const PLLON: u64 = 1 << 24;

/// More bytes than a Stepper has.
const STEPPER_SIZE: u64 = 4096;

/// A fault that the world does to the chip.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Injection {
    /// After this many step events, the next access to a port fails on the bus.
    BusError {
        /// Events before it.
        after: usize,
    },
    /// After this many step events, a driver loses its registers.
    DriverReset {
        /// Events before it.
        after: usize,
        /// The motor of the driver.
        motor: Motor,
    },
    /// After this many step events, the motor supply goes away.
    SupplyLost {
        /// Events before it.
        after: usize,
    },
    /// A value is written to a register.
    Poke {
        /// Virtual time before it, in ns.
        after: u64,
        /// Where.
        address: u64,
        /// The value.
        value: u64,
    },
    /// After this many step events, a bit of the first of these words flips in the Stepper's memory.
    Flip {
        /// Events before it.
        after: usize,
        /// The word before.
        word: u32,
    },
    /// The slow oscillator has another rate, as the calendar counts it.
    SlowOscillator {
        /// Virtual time before it, in ns.
        after: u64,
        /// The rate in Hz.
        hz: u64,
    },
    /// A word of RAM is damaged.
    BadWord(BadWord),
    /// Bits of registers flip, one after the other.
    FlipEach(FlipEach),
    /// After this many step events, the trap in the image springs (see [`crate::trap`]).
    Trap {
        /// Events before it.
        after: usize,
    },
    /// The trap springs when a heater's pin has just gone high, at this time at the earliest.
    TrapWhileHot {
        /// Virtual time before it, in ns.
        after: u64,
        /// Events together with it.
        with: With,
    },
    /// A line of the interrupt controller goes high and stays there until the chip is reset, from a time on when a
    /// heater's pin has just gone high.
    Storm {
        /// Virtual time before it, in ns.
        after: u64,
        /// The interrupt.
        line: u16,
    },
    /// After this many step events, the trap springs, and the supply of the processor falls at that instant.
    SupplyFalls {
        /// Events before it.
        after: usize,
    },
}

/// Events together with a trap.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum With {
    /// Nothing.
    Nothing,
    /// It springs again after each reset.
    Repetition,
    /// The supply of the processor falls when it springs.
    LowSupply,
    /// The crystal stops when a context falls into it.
    StoppedCrystal,
}

impl Watch {
    /// Lets the fault happen if its time has come.
    pub(super) fn inject(
        &mut self,
        session: &mut Session<Emulated>,
        host: &mut dyn rigless::emulator::Host,
        at: VirtualNanos,
    ) {
        let events = self.recorder.events.len();
        match self.injection {
            Some(Injection::BusError { after }) if events >= after => {
                session.fail_next(GPIO, GPIO + PORTS as u64 * PORT_SIZE);
            }
            Some(Injection::DriverReset { after, motor }) if events >= after => self.drivers.of(motor).chip.reset(),
            Some(Injection::SupplyLost { after }) if events >= after => {
                Motor::ALL.into_iter().for_each(|motor| self.drivers.of(motor).chip.power_off());
            }
            Some(Injection::Trap { after }) if events >= after => self.spring(session, host),
            Some(Injection::Flip { after, word }) if events >= after => self.flip(host, word),
            Some(Injection::SupplyFalls { after }) if events >= after => self.drop_supply(session, host, at),
            _ => return,
        }
        self.injection = None;
        self.injected = Some(at.0);
    }

    /// The same for faults that wait for a heater's pin to be high.
    pub(super) fn inject_while_hot(
        &mut self,
        session: &mut Session<Emulated>,
        host: &mut dyn rigless::emulator::Host,
        at: VirtualNanos,
    ) {
        let Some(injection) = self.injection else { return };
        match injection {
            Injection::TrapWhileHot { after, .. } | Injection::Storm { after, .. }
                if at.0 < after || !self.heat.has_just_gone_on(at.0) =>
            {
                return;
            }
            Injection::TrapWhileHot { with: With::LowSupply, .. } => self.drop_supply(session, host, at),
            Injection::TrapWhileHot { with, .. } => {
                self.with = with;
                self.spring(session, host);
            }
            Injection::Storm { line, .. } => self.hold(host, line, Level::High),
            Injection::SlowOscillator { after, .. } if at.0 < after => return,
            Injection::SlowOscillator { hz, .. } => session.board_mut().mcu.calendar.drift = Some(hz),
            Injection::BadWord(word) if at.0 < word.after => return,
            Injection::BadWord(word) => self.damage(session, host, word),
            Injection::FlipEach(each) => return self.flip_next(session.board_mut(), at.0, &each),
            _ => return,
        }
        self.injection = None;
        self.injected = Some(at.0);
    }

    /// Flips the lowest bit of the first such word in the Stepper's memory.
    fn flip(&mut self, host: &mut dyn rigless::emulator::Host, word: u32) {
        let words = (0..STEPPER_SIZE).step_by(4).map(|offset| u64::from(self.stepper) + offset);
        let mut is_it = |address: &u64| host.read(*address, Width::W32).is_ok_and(|found| found == u64::from(word));
        let found = words.into_iter().find(&mut is_it);
        self.is_injectable = found.is_some_and(|address| host.write(address, Width::W32, u64::from(word ^ 1)).is_ok());
    }

    /// A context has fallen into the trap.
    pub(super) fn fall(&mut self, session: &mut Session<Emulated>, at: VirtualNanos) {
        session.unwatch(emulator::Watch::Instruction(FALLEN.into()));
        if self.fallen.is_none() && self.with == With::StoppedCrystal {
            self.is_injectable &= session.board_mut().mcu.stop_crystal(at);
        }
        self.fallen.get_or_insert(at.0);
    }

    /// The chip was reset: injected faults end, unless they are to come again.
    pub(super) fn release(&mut self, host: &mut dyn rigless::emulator::Host) {
        if self.injected.is_some() && self.with != With::Repetition {
            let _ = host.write(u64::from(TRIGGER), Width::W32, 0);
        }
        if let Some(line) = self.held.take() {
            host.set_interrupt(line, Level::Low);
        }
    }

    fn hold(&mut self, host: &mut dyn rigless::emulator::Host, line: u16, level: Level) {
        let Some(line) = InterruptLine::new(line) else { return };
        host.set_interrupt(line, level);
        self.held = Some(line);
    }

    /// The supply falls, for which detector and line have to be armed.
    fn drop_supply(
        &mut self,
        session: &mut Session<Emulated>,
        host: &mut dyn rigless::emulator::Host,
        at: VirtualNanos,
    ) {
        let mcu = &mut session.board_mut().mcu;
        mcu.set_supply(LOW_SUPPLY);
        let mut has = |(register, bit)| mcu.peek(at, register, Width::W32).is_ok_and(|value| value & bit != 0);
        let is_armed = DETECTOR.into_iter().all(&mut has);
        self.is_supply_low = true;
        self.spring(session, host);
        self.is_injectable &= is_armed;
    }

    /// From now on any code that reaches the trap falls into it. Watching for that costs time, so it begins here.
    fn spring(&mut self, session: &mut Session<Emulated>, host: &mut dyn rigless::emulator::Host) {
        session.watch(emulator::Watch::Instruction(FALLEN.into()));
        self.is_injectable = host.write(u64::from(TRIGGER), Width::W32, 1).is_ok();
    }

    /// Restores the supply some time after the reset, and checks that the firmware has waited for it.
    pub(super) fn restore_supply(&mut self, session: &mut Session<Emulated>, at: u64) {
        let reset_at = session.resets().first().map(|r| r.at.0);
        if !self.is_supply_low || reset_at.is_none_or(|reset| at < reset + LOW_NS) {
            return;
        }
        let mcu = &mut session.board_mut().mcu;
        let control = mcu.peek(VirtualNanos(at), RCC_CR, Width::W32);
        self.has_waited = control.is_ok_and(|control| control & PLLON == 0);
        mcu.set_supply(RAIL);
        self.is_supply_low = false;
    }

    /// Writes to the register if it is time for that.
    pub(super) fn poke(&mut self, session: &mut Session<Emulated>, at: u64) {
        if let Some(Injection::Poke { after, address, value }) = self.injection
            && at >= after
        {
            let written = session.board_mut().mcu.write(VirtualNanos(at), address, Width::W32, value);
            self.is_injectable = written.is_ok();
            self.injection = None;
            self.injected = Some(at);
        }
    }
}
