//! The watch: sees every access of the firmware, moves the simulated machine and keeps the record.

mod cells;
mod ending;
mod flash;
mod flips;
mod injection;
mod outside;

pub use cells::{BadWord, Damage};
pub use ending::{End, Patience};
pub use flips::{Flip, FlipEach};
pub use injection::{Injection, With};

use crate::board::{Emulated, Port};
use crate::clock_rules::ClockRules;
use crate::driver_line::DriverLines;
use crate::half_periods::Laps;
use crate::heat_pins::{Climate, HeatWatch, fitted};
use crate::mechanics::Mechanics;
use crate::safety::Safety;
use crate::sensor_bus::SensorBus;
use crate::servo_line::ServoLine;
use crate::steps::Recorder;
use crate::terminal::Terminal;
use crate::timer::Schedule;
use crate::wiring::{BRR, Load, PORTS, ProbeInput, SettingsMemory, SupplyLine, Wiring};
use corehbot::motors::{EndstopSet, prototype};
use corehbot::settings::Settings;
use corehbot_sim::heat_plant::HeatSetup;
use rigless::emulator::{AccessKind, Driver, HitKind, InterruptLine, Settled, Stop};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use std::ops::Range;

/// GPIOA; the ports follow each other every 1 KiB (RM0390 rev 6, section 2.2.2).
const GPIO: u64 = 0x4002_0000;
const PORT_SIZE: u64 = 0x400;

/// Peripherals on both APB (RM0390 rev 6, section 2.2.2).
const APB: Range<u64> = 0x4000_0000..0x4002_0000;

/// Interval at which the run is checked: every ms.
const LOOK_NS: u64 = 1_000_000;

/// The watch.
pub struct Watch {
    wiring: &'static Wiring,
    stepper: u32,
    step_interrupt: Range<u64>,
    /// The load on the motors.
    pub mechanics: Mechanics,
    probe: Option<ProbeInput>,
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
    /// Pins that the image has driven so far, itself or by a peripheral, in each port.
    pub driven: [u16; PORTS],
    /// Enable lines and heaters.
    pub safety: Safety,
    /// The firmware's clock.
    pub laps: Laps,
    /// The motor drivers.
    pub drivers: DriverLines,
    /// The servo's line.
    pub servo: ServoLine,
    /// The accelerometer's bus.
    pub sensor_bus: SensorBus,
    /// The line that switches the machine's power supply.
    supply: Option<SupplyLine>,
    /// The machine's heat.
    pub heat: HeatWatch,
    /// The host outside, with a hand at the machine.
    pub terminal: Option<Terminal>,
    /// The clocks.
    pub clock_rules: ClockRules,
    /// Why the run ended.
    pub end: End,
    /// When the injected fault happened, in ns.
    pub injected: Option<u64>,
    /// When a context fell into the trap, in ns.
    pub fallen: Option<u64>,
    /// Bits of registers that flipped.
    pub flips: Vec<Flip>,
    /// The word of RAM that is damaged.
    bad_word: Option<BadWord>,
    /// The last one's register before it.
    before_flip: u32,
    /// The trap could be sprung.
    pub is_injectable: bool,
    /// Where the stack ends, below which it does not grow.
    pub stack_end: u32,
    /// Bytes from there up that were never written during the run.
    pub stack_free: u32,
    /// Events together with the trap.
    with: With,
    /// A line of the interrupt controller that is held high.
    held: Option<InterruptLine>,
    is_supply_low: bool,
    /// The processor stands still, because its flash is at work.
    is_holding: bool,
    /// When the supply came back after it had fallen, the processor was still at its own slow clock.
    pub has_waited: bool,
}

impl Watch {
    /// A watch over a board with `wiring` and a machine of `settings`; the image has the Stepper and the step interrupt
    /// at the given addresses.
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
            mechanics: Mechanics::rigid(settings),
            probe: wiring.probe(settings),
            supply: wiring.supply(settings),
            endstops: None,
            patience,
            injection,
            baud,
            greeted: false,
            done: None,
            resets: 0,
            recorder: Recorder::new(wiring),
            driven: [0; PORTS],
            safety: Safety::new(wiring, fitted(settings)),
            servo: ServoLine::new(wiring.servo),
            sensor_bus: SensorBus::new(wiring.sensor),
            heat: HeatWatch::new(wiring, settings, &Climate::default(), &HeatSetup::default()),
            terminal: None,
            laps: Laps::default(),
            clock_rules: ClockRules::new(wiring.hse),
            end: End::Late,
            injected: None,
            fallen: None,
            flips: Vec::new(),
            bad_word: None,
            before_flip: 0,
            is_injectable: true,
            stack_end: 0,
            stack_free: 0,
            with: With::Nothing,
            held: None,
            is_supply_low: false,
            is_holding: false,
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
        self.mechanics.attend(at.0, self.safety.supplied());
        self.sensor_bus.store(session.board_mut(), at, n, port);
        if let Some(line) = self.supply.filter(|line| line.pin.port == n) {
            let driven = if line.is_on_high { port.high() } else { port.low() };
            self.heat.switch(at.0, driven & line.pin.mask() != 0);
        }
        if let Some((began, micros)) = self.servo.store(at.0, n, port) {
            self.mechanics.servo(began, micros);
            self.press(session, at);
        }
        self.drivers.store(at.0, n, port, |pin| session.board_mut().is_pulled_up(pin));
        let (steps, forward) = self.recorder.store(at.0, n, port, self.safety.powered);
        if steps.is_empty() {
            return;
        }
        if let Some(event) = self.recorder.events.last_mut().filter(|event| event.schedule.is_none()) {
            event.schedule = Schedule::read(session.board_mut(), host, at, self.stepper);
        }
        let tick = self.recorder.events.last().and_then(|event| event.schedule).map(|schedule| schedule.tick());
        self.mechanics.step(at.0, tick, (steps, forward), &mut self.drivers, self.safety.supplied());
        self.press(session, at);
        self.inject(session, host, at);
    }

    /// Looks at the heaters on the timer at `address`; returns whether there are any.
    fn timer_written(&mut self, board: &mut Emulated, at: VirtualNanos, address: u64) -> bool {
        let has_timer = |load: &Load| load.timer.is_some_and(|(timer, _)| timer.has(address));
        let mut is_heaters = false;
        for (_, load) in self.wiring.heaters.iter().filter(|(_, load)| has_timer(load)) {
            self.safety.store(at.0, load.pin.port, board.port(load.pin.port), self.greeted);
            is_heaters = true;
        }
        is_heaters
    }

    /// Sets the serial ports to the rate that the hosts want, whatever the image has just written.
    fn set_rate(&self, board: &mut Emulated, at: VirtualNanos, address: u64) {
        let Some(baud) = self.baud else { return };
        if let Some(port) = self.wiring.host_ports.iter().find(|port| port.base + BRR == address) {
            let divisor = board.bus_hz(port) / u64::from(baud);
            // The image's own write there was legal, and so is this one.
            let _ = board.mcu.write(at, address, Width::W32, divisor);
        }
    }

    /// Gives the endstop inputs the levels that the machine's switches have.
    fn press(&mut self, session: &mut Session<Emulated>, at: VirtualNanos) {
        let pressed = self.mechanics.endstops(at.0);
        if self.endstops == Some(pressed) {
            return;
        }
        for (endstop, pin) in self.wiring.endstops {
            let is_pressed = pressed.has(endstop);
            if self.endstops.is_none_or(|before| before.has(endstop) != is_pressed) {
                session.board_mut().drive(at, pin, is_pressed);
            }
        }
        let has_triggered = pressed.has(EndstopSet::PROBE);
        if let Some(probe) = self.probe
            && self.endstops.is_none_or(|before| before.has(EndstopSet::PROBE) != has_triggered)
        {
            session.board_mut().put(at, probe.pin, probe.level(has_triggered));
        }
        self.endstops = Some(pressed);
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
        let access = match settled {
            Settled::Access { access, .. } => access,
            Settled::Stop(stop) => {
                self.drivers.advance(session.board_mut(), stop.at);
                self.heat.look(session.board_mut(), stop.at.0, self.mechanics.counts()[prototype::E0.index()]);
                self.inject_while_hot(session, host, stop.at);
                if self.mechanics.next().is_some_and(|next| next <= stop.at.0) {
                    self.press(session, stop.at);
                }
                self.look_at_flash(session, host, stop.at, None);
                return self.pause(session);
            }
            Settled::Hit(hit) if hit.kind == HitKind::Write => return self.spoil(host),
            Settled::Hit(hit) => return self.fall(session, hit.at),
            _ => return,
        };
        if session.resets().len() != self.resets {
            self.resets = session.resets().len();
            let at = session.resets().last().map_or(0, |r| r.at.0);
            self.safety.reset(at);
            self.heat.switch(at, self.supply.is_none());
            self.release(host);
            self.clock_rules.reset();
            self.sensor_bus.reset();
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
        if self.wiring.settings == SettingsMemory::Flash {
            self.look_at_flash(session, host, access.virtual_time, Some(&access));
            self.pause(session);
        }
        let is_stepping = access.program_counter.is_some_and(|pc| self.step_interrupt.contains(&pc));
        self.slow_accesses += u64::from(is_stepping && APB.contains(&access.address));
        if access.kind != AccessKind::Write {
            return;
        }
        self.clock_rules.written(session.board_mut(), &access);
        self.sensor_bus.written(session.board_mut(), &access);
        self.set_rate(session.board_mut(), access.virtual_time, access.address);
        self.laps.written(session.board_mut(), access.virtual_time, access.address, access.value);
        let port = access.address.wrapping_sub(GPIO) / PORT_SIZE;
        let is_port = (port as usize) < PORTS;
        let is_timer = self.timer_written(session.board_mut(), access.virtual_time, access.address);
        if is_port || is_timer {
            self.heat.look(session.board_mut(), access.virtual_time.0, self.mechanics.counts()[prototype::E0.index()]);
        }
        let is_mode = (access.address & (PORT_SIZE - 1)) == 0;
        if is_port && is_mode && access.program_counter.is_some_and(|pc| pc >= u64::from(self.wiring.application)) {
            self.driven[port as usize] |= session.board_mut().driven(port as usize);
        }
        if is_port {
            self.port_written(session, host, access.virtual_time, port as usize);
            self.pause(session);
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Emulated>,
        stop: Stop,
        host: &mut dyn rigless::emulator::Host,
    ) -> Option<VirtualNanos> {
        self.attend_outside(session, host, &stop);
        if !self.look(session, stop.at.0) {
            return Some(VirtualNanos(stop.at.0 + LOOK_NS));
        }
        // RAM begins as zeros, so stack that was never reached is zero too.
        let words = (0..).map(|word| host.read(u64::from(self.stack_end + 4 * word), Width::W32));
        self.stack_free = 4 * words.take_while(|word| matches!(word, Ok(0))).count() as u32;
        None
    }
}
