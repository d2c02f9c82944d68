//! The watch: sees every access of the firmware, moves the simulated machine and keeps the record.

use crate::board::{Emulated, Port};
use crate::driver_line::DriverLines;
use crate::laps::Laps;
use crate::safety::Safety;
use crate::steps::Recorder;
use crate::timer::{self, Meaning};
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

/// GPIOA; the ports follow each other every 1 KiB (RM0390 rev 6, section 2.2.2).
const GPIO: u64 = 0x4002_0000;
const PORT_SIZE: u64 = 0x400;

/// What lies below RAM is reserved up to the option bytes (RM0390 rev 6, section 3.3) and answers with a bus error,
/// where the model answers 0. So many accesses are made to fail: those of an overflowing stack and of the
/// exception that it raises.
const BELOW_RAM: (u64, u64) = (0x1FFF_C010, 0x2000_0000);
const FAILING: usize = 64;

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
    /// Enable lines and heaters.
    pub safety: Safety,
    /// The firmware's clock.
    pub laps: Laps,
    /// The motor drivers.
    pub drivers: DriverLines,
    /// Why the run ended.
    pub end: End,
    /// When the injected fault happened, in ns.
    pub injected: Option<u64>,
    /// The trap could be sprung.
    pub is_injectable: bool,
}

impl Watch {
    /// A watch over a board with `wiring` and a machine of `settings`.
    #[must_use]
    pub fn new(
        wiring: &'static Wiring,
        settings: &Settings,
        patience: Patience,
        injection: Option<Injection>,
        baud: Option<u32>,
        drivers: DriverLines,
    ) -> Self {
        Self {
            wiring,
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
            end: End::Late,
            injected: None,
            is_injectable: true,
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
            Some(Injection::Trap { after }) if events >= after => {
                for _ in 0..FAILING {
                    session.fail_next(BELOW_RAM.0, BELOW_RAM.1);
                }
                self.is_injectable = host.write(u64::from(TRIGGER), Width::W32, 1).is_ok();
            }
            _ => return,
        }
        self.injection = None;
        self.injected = Some(at.0);
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
        if access.kind != AccessKind::Write {
            return;
        }
        self.set_rate(session.board_mut(), access.virtual_time, access.address);
        self.laps.written(session.board_mut(), access.virtual_time, access.address, access.value);
        let port = access.address.wrapping_sub(GPIO) / PORT_SIZE;
        if (port as usize) < PORTS {
            self.port_written(session, host, access.virtual_time, port as usize);
            session.pause_at(self.drivers.next.map(VirtualNanos));
        } else if let Some(meaning) =
            timer::meaning(session.board_mut(), access.virtual_time, access.address, access.value)
        {
            match meaning {
                Meaning::Alarm(alarm) => self.recorder.alarm(alarm),
                Meaning::Silence => self.recorder.silence(),
            }
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
