//! The watch: sees every access of the firmware, moves the simulated machine and keeps the record.

use crate::board::{Emulated, Port, RAIL};
use crate::clock_rules::ClockRules;
use crate::driver_line::DriverLines;
use crate::laps::Laps;
use crate::safety::Safety;
use crate::steps::Recorder;
use crate::timer::Schedule;
use crate::trap::TRIGGER;
use crate::wiring::{BRR, PORTS, Wiring};
use corehbot::motors::{EndstopSet, Motor};
use corehbot::settings::Settings;
use corehbot_rig::Rig;
use rigless::emulator::{AccessKind, Driver, Settled, Stop};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::ops::Range;

/// GPIOA; the ports follow each other every 1 KiB (RM0390 rev 6, section 2.2.2).
const GPIO: u64 = 0x4002_0000;
const PORT_SIZE: u64 = 0x400;

/// A supply that has fallen, in mV, as long as it lasts after the reset that it brings about: 10 ms.
const LOW_SUPPLY: u32 = 2900;
const LOW_NS: u64 = 10_000_000;

/// Where a supply that falls must have been armed for: PVDO in PWR_CSR, and line 16 in EXTI_IMR and EXTI_RTSR (RM0390 rev 6,
/// sections 5.5.2, 10.3.1 and 10.3.3).
const DETECTOR: [(u64, u64); 3] = [(0x4000_7004, 1 << 2), (0x4001_3C00, 1 << 16), (0x4001_3C08, 1 << 16)];

/// RCC_CR, and PLLON in it (RM0390 rev 6, section 6.3.1).
const RCC_CR: u64 = 0x4002_3800;
const PLLON: u64 = 1 << 24;

/// Peripherals on both APB (RM0390 rev 6, section 2.2.2).
const APB: Range<u64> = 0x4000_0000..0x4002_0000;

/// How often the run is looked at: every ms.
const LOOK_NS: u64 = 1_000_000;

/// A run goes on for this long after the host is done: 20 ms.
const LAST_NS: u64 = 20_000_000;

/// A fault that the world does to the chip.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Injection {
    /// After so many step events, the next access to a port fails on the bus.
    BusError {
        /// Events before it.
        after: usize,
    },
    /// After so many step events, a driver loses its registers.
    DriverReset {
        /// Events before it.
        after: usize,
        /// Whose driver.
        motor: Motor,
    },
    /// After so many step events, the motor supply goes away.
    SupplyLost {
        /// Events before it.
        after: usize,
    },
    /// Somebody writes to a register.
    Poke {
        /// Virtual time before it, in ns.
        after: u64,
        /// Where.
        address: u64,
        /// What.
        value: u64,
    },
    /// After so many step events, the trap in the image springs (see [`crate::trap`]).
    Trap {
        /// Events before it.
        after: usize,
    },
    /// The same, and the supply of the processor falls at that instant.
    SupplyFalls {
        /// Events before it.
        after: usize,
    },
}

/// Why a run ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum End {
    /// The host was done.
    Done,
    /// The chip was reset.
    Reset,
    /// Neither a byte nor a step for this long, in ms.
    Stalled(u64),
    /// The power of the board went.
    PowerCut,
    /// Virtual time ran out.
    Late,
}

/// How long a run may take.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Virtual time in ns.
    pub whole: u64,
    /// Virtual time without a byte or a step, in ns.
    pub silent: u64,
    /// Virtual time to go on after a reset, in ns.
    pub after_reset: u64,
}

/// The watch.
pub struct Watch {
    wiring: &'static Wiring,
    stepper: u32,
    step_interrupt: Range<u64>,
    rig: Rig,
    endstops: Option<EndstopSet>,
    patience: Patience,
    injection: Option<Injection>,
    baud: Option<u32>,
    greeted: bool,
    done: Option<u64>,
    resets: usize,
    /// Step events.
    pub recorder: Recorder,
    /// Accesses of the step interrupt to peripherals on APB, which make it wait for the bus.
    pub slow_accesses: u64,
    /// Enable lines and heaters.
    pub safety: Safety,
    /// The firmware's clock.
    pub laps: Laps,
    /// The motor drivers.
    pub drivers: DriverLines,
    /// The clocks.
    pub clock_rules: ClockRules,
    /// Why the run ended.
    pub end: End,
    /// When the injected fault happened, in ns.
    pub injected: Option<u64>,
    /// The trap could be sprung.
    pub is_injectable: bool,
    is_supply_low: bool,
    /// When the supply came back after it had fallen, the processor was still at its own slow clock.
    pub has_waited: bool,
}

impl Watch {
    /// A watch over a board with `wiring` and a machine of `settings`, whose image has the Stepper and the step
    /// interrupt there.
    #[must_use]
    pub fn new(
        wiring: &'static Wiring,
        (stepper, step_interrupt): (u32, Range<u64>),
        settings: &Settings,
        patience: Patience,
        injection: Option<Injection>,
        baud: Option<u32>,
        drivers: DriverLines,
    ) -> Self {
        Self {
            wiring,
            stepper,
            step_interrupt,
            slow_accesses: 0,
            drivers,
            rig: Rig::new(settings, None),
            endstops: None,
            patience,
            injection,
            baud,
            greeted: false,
            done: None,
            resets: 0,
            recorder: Recorder::new(wiring),
            safety: Safety::new(wiring),
            laps: Laps::default(),
            clock_rules: ClockRules::new(wiring.crystal),
            end: End::Late,
            injected: None,
            is_injectable: true,
            is_supply_low: false,
            has_waited: false,
        }
    }

    fn port_written(
        &mut self,
        session: &mut Session<Emulated>,
        host: &mut dyn rigless::emulator::Host,
        at: VirtualNanos,
        n: usize,
    ) {
        let port = session.board_mut().port(n);
        self.safety.store(at.0, n, port, self.greeted);
        self.drivers.store(at.0, n, port, |pin| session.board_mut().is_pulled_up(pin));
        let (steps, forward) = self.recorder.store(at.0, n, port, self.safety.powered);
        if steps.is_empty() {
            return;
        }
        if let Some(event) = self.recorder.events.last_mut().filter(|event| event.schedule.is_none()) {
            event.schedule = Schedule::read(session.board_mut(), host, at, self.stepper);
        }
        self.rig.step(steps, forward);
        self.press(session, at);
        self.inject(session, host, at);
    }

    /// Lets the fault happen if its time has come.
    fn inject(&mut self, session: &mut Session<Emulated>, host: &mut dyn rigless::emulator::Host, at: VirtualNanos) {
        let events = self.recorder.events.len();
        match self.injection {
            Some(Injection::BusError { after }) if events >= after => {
                session.fail_next(GPIO, GPIO + PORTS as u64 * PORT_SIZE);
            }
            Some(Injection::DriverReset { after, motor }) if events >= after => self.drivers.of(motor).chip.reset(),
            Some(Injection::SupplyLost { after }) if events >= after => {
                Motor::ALL.into_iter().for_each(|motor| self.drivers.of(motor).chip.power_off());
            }
            Some(Injection::Trap { after }) if events >= after => self.spring(host),
            Some(Injection::SupplyFalls { after }) if events >= after => {
                let mcu = &mut session.board_mut().mcu;
                mcu.set_supply(LOW_SUPPLY);
                let mut has = |(register, bit)| mcu.peek(at, register, Width::W32).is_ok_and(|value| value & bit != 0);
                let is_armed = DETECTOR.into_iter().all(&mut has);
                self.is_supply_low = true;
                self.spring(host);
                self.is_injectable &= is_armed;
            }
            _ => return,
        }
        self.injection = None;
        self.injected = Some(at.0);
    }

    fn spring(&mut self, host: &mut dyn rigless::emulator::Host) {
        self.is_injectable = host.write(u64::from(TRIGGER), Width::W32, 1).is_ok();
    }

    /// Has the supply come back some time after the reset, and sees whether the firmware has waited for it.
    fn restore_supply(&mut self, session: &mut Session<Emulated>, at: u64) {
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

    /// Has the serial ports run at the rate that the hosts want, whatever the image has just written.
    fn set_rate(&self, board: &mut Emulated, at: VirtualNanos, address: u64) {
        let Some(baud) = self.baud else { return };
        if let Some(port) = self.wiring.host_ports.iter().find(|port| port.base + BRR == address) {
            let divisor = board.bus_hz(port) / u64::from(baud);
            // What the image has written there was legal, and so is this.
            let _ = board.mcu.write(at, address, Width::W32, divisor);
        }
    }

    /// Gives the endstop inputs the levels that the machine's switches have.
    fn press(&mut self, session: &mut Session<Emulated>, at: VirtualNanos) {
        let pressed = self.rig.endstops();
        if self.endstops == Some(pressed) {
            return;
        }
        for (endstop, pin) in self.wiring.endstops {
            let is_pressed = pressed.has(endstop);
            if self.endstops.is_none_or(|before| before.has(endstop) != is_pressed) {
                session.board_mut().drive(at, pin, is_pressed);
            }
        }
        self.endstops = Some(pressed);
    }

    /// Whether the run is over at `at`.
    fn look(&mut self, session: &mut Session<Emulated>, at: u64) -> bool {
        self.restore_supply(session, at);
        let reset_at = session.resets().first().map(|r| r.at.0);
        let steps_at = self.recorder.events.last().map_or(0, |e| e.at);
        if session.board_mut().eeprom().is_some_and(|eeprom| eeprom.is_cut()) {
            self.end = End::PowerCut;
            return true;
        }
        if let Some(Injection::Poke { after, address, value }) = self.injection
            && at >= after
        {
            let written = session.board_mut().mcu.write(VirtualNanos(at), address, Width::W32, value);
            self.is_injectable = written.is_ok();
            self.injection = None;
            self.injected = Some(at);
        }
        let mut active = steps_at;
        let mut is_done = true;
        for line in session.board_mut().hosts() {
            self.greeted |= line.started.is_some();
            is_done &= line.is_done();
            active = active.max(line.active);
        }
        if is_done && self.done.is_none() {
            self.done = Some(at);
        }
        self.end = match (reset_at, self.done) {
            (Some(reset), _) if at >= reset + self.patience.after_reset => End::Reset,
            (None, Some(done)) if at >= done + LAST_NS => End::Done,
            (None, None) if at >= active + self.patience.silent => End::Stalled((at - active) / LOOK_NS),
            _ if at >= self.patience.whole => End::Late,
            _ => return false,
        };
        true
    }
}

impl Driver<Emulated> for Watch {
    fn on_settled(
        &mut self,
        session: &mut Session<Emulated>,
        host: &mut dyn rigless::emulator::Host,
        settled: Settled,
    ) {
        if self.endstops.is_none() {
            self.press(session, VirtualNanos(0));
        }
        let Settled::Access { access, .. } = settled else {
            if let Settled::Stop(stop) = settled {
                self.drivers.advance(session.board_mut(), stop.at);
                session.pause_at(self.drivers.next.map(VirtualNanos));
            }
            return;
        };
        if session.resets().len() != self.resets {
            self.resets = session.resets().len();
            let at = session.resets().last().map_or(0, |r| r.at.0);
            self.safety.reset(at);
            self.clock_rules.reset();
            for n in 0..PORTS {
                self.drivers.store(at, n, Port::default(), |_| true);
                self.recorder.store(at, n, Port::default(), self.safety.powered);
            }
            self.endstops = None;
            for &(pin, high) in self.wiring.resistors {
                session.board_mut().drive(access.virtual_time, pin, high);
            }
            self.press(session, access.virtual_time);
        }
        let is_stepping = access.program_counter.is_some_and(|pc| self.step_interrupt.contains(&pc));
        self.slow_accesses += u64::from(is_stepping && APB.contains(&access.address));
        if access.kind != AccessKind::Write {
            return;
        }
        self.clock_rules.written(session.board_mut(), &access);
        self.set_rate(session.board_mut(), access.virtual_time, access.address);
        self.laps.written(session.board_mut(), access.virtual_time, access.address, access.value);
        let port = access.address.wrapping_sub(GPIO) / PORT_SIZE;
        if (port as usize) < PORTS {
            self.port_written(session, host, access.virtual_time, port as usize);
            session.pause_at(self.drivers.next.map(VirtualNanos));
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Emulated>,
        stop: Stop,
        _host: &mut dyn rigless::emulator::Host,
    ) -> Option<VirtualNanos> {
        if self.look(session, stop.at.0) { None } else { Some(VirtualNanos(stop.at.0 + LOOK_NS)) }
    }
}
