//! The motor drivers of the simulated machine: a TMC2209 for each motor, on a wire of its own.
//!
//! A test holds them too, and makes them fail while the firmware talks to them.

use crate::tmc2209::{Tmc2209, gconf};
use corehbot::motors::{Coupling, MOTORS, Motor, MotorSet};
use corehbot::port::{BusError, DriverBus, Frame, MotorPower, Servo};
use corehbot::units::TICKS_PER_SECOND;
use std::cell::{Cell, RefCell, RefMut};

/// Speed of the wire: the speed of Marlin's software UART, the slowest in use.
const BAUD: u64 = 19_200;

/// Bits of a byte with start and stop.
const BYTE: u64 = 10;

/// Bit times between request and reply (TMC2209 datasheet rev 1.09, section 5.1: SENDDELAY 0).
const DELAY: u64 = 8;

/// Bit times after which a reply that is not there will not come.
const PATIENCE: u64 = 20;

/// The chips, and the lines that switch them on.
#[derive(Debug)]
pub struct Drivers {
    chips: RefCell<[Tmc2209; MOTORS]>,
    enabled: Cell<MotorSet>,
    switched: Cell<u64>,
    seen: Cell<u64>,
    betrayed: Cell<MotorSet>,
    lines: MotorSet,
    /// Which motors the step pins are to turn from now on, if that has changed.
    coupling: Cell<Option<Coupling>>,
    /// The last order to the servo of a probe, with its time in ticks, until the probe takes it.
    servo: Cell<Option<(u64, Option<u16>)>>,
}

impl Default for Drivers {
    fn default() -> Self {
        Self::new()
    }
}

impl Drivers {
    /// A chip for each motor, just switched on.
    #[must_use]
    pub fn new() -> Self {
        Self::with_lines(MotorSet::ALL)
    }

    /// A chip for each motor; only the chips of `lines` are on a wire.
    #[must_use]
    pub fn with_lines(lines: MotorSet) -> Self {
        let chips = RefCell::new(std::array::from_fn(|_| Tmc2209::new(0)));
        Self {
            chips,
            enabled: Cell::default(),
            switched: Cell::default(),
            seen: Cell::default(),
            betrayed: Cell::default(),
            lines,
            coupling: Cell::default(),
            servo: Cell::default(),
        }
    }

    /// The chip of a motor, to read and to break.
    pub fn chip(&self, motor: Motor) -> RefMut<'_, Tmc2209> {
        RefMut::map(self.chips.borrow_mut(), |chips| &mut chips[motor.index()])
    }

    /// Motors that the firmware has switched on.
    #[must_use]
    pub fn enabled(&self) -> MotorSet {
        self.enabled.get()
    }

    /// When they were last switched, in ticks.
    #[must_use]
    pub fn switched(&self) -> u64 {
        self.switched.get()
    }

    /// When the firmware last read the wires, in ticks.
    #[must_use]
    pub fn seen(&self) -> u64 {
        self.seen.get()
    }

    /// Motors that were ever switched on although their driver ran by its pins, and had said so.
    #[must_use]
    pub fn betrayed(&self) -> MotorSet {
        self.betrayed.get()
    }

    /// Motors that are switched on although their driver would make another number of microsteps, or has no supply.
    #[must_use]
    pub fn astray(&self, microsteps: u32) -> MotorSet {
        let is_astray = |motor: &Motor| {
            let chip = self.chip(*motor);
            self.lines.has(*motor)
                && self.enabled().has(*motor)
                && (!chip.is_powered() || chip.microsteps() != microsteps)
        };
        Motor::ALL.into_iter().filter(is_astray).fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(motor)))
    }

    /// Which motors the step pins are to turn from now on, once if that has changed.
    pub(crate) fn take_coupling(&self) -> Option<Coupling> {
        self.coupling.take()
    }

    /// The last order to the servo of a probe and its time in ticks, once.
    pub(crate) fn take_servo(&self) -> Option<(u64, Option<u16>)> {
        self.servo.take()
    }

    /// The lines that switch the drivers on, with the time in ticks.
    #[must_use]
    pub const fn power<'d>(&'d self, now: &'d Cell<u64>) -> Power<'d> {
        Power { drivers: self, now }
    }

    /// The line to the servo of a probe, with the time in ticks.
    #[must_use]
    pub const fn servo<'d>(&'d self, now: &'d Cell<u64>) -> ServoLine<'d> {
        ServoLine { drivers: self, now }
    }

    /// The firmware's end of the wires, with the time in ticks.
    #[must_use]
    pub const fn bus<'d>(&'d self, now: &'d Cell<u64>) -> Bus<'d> {
        Bus { drivers: self, now, pending: None }
    }
}

/// The lines that switch the drivers on.
#[derive(Debug)]
pub struct Power<'d> {
    drivers: &'d Drivers,
    now: &'d Cell<u64>,
}

/// The line to the servo of a probe.
#[derive(Debug)]
pub struct ServoLine<'d> {
    drivers: &'d Drivers,
    now: &'d Cell<u64>,
}

/// The firmware's end of the wires.
#[derive(Debug)]
pub struct Bus<'d> {
    drivers: &'d Drivers,
    now: &'d Cell<u64>,
    /// How the exchange ends, and when.
    pending: Option<(u64, Result<Frame, BusError>)>,
}

impl MotorPower for Power<'_> {
    fn enable(&mut self, on: MotorSet) {
        let drivers = self.drivers;
        let fresh = on.without(drivers.enabled.replace(on));
        drivers.switched.set(self.now.get());
        for motor in Motor::ALL.into_iter().filter(|motor| fresh.has(*motor) && drivers.lines.has(*motor)) {
            let chip = drivers.chip(motor);
            if chip.register(gconf::ADDRESS) & gconf::MSTEP_REG_SELECT == 0 && chip.has_spoken() {
                drivers.betrayed.set(drivers.betrayed().with(MotorSet::of(motor)));
            }
        }
    }

    fn couple(&mut self, coupling: &Coupling) {
        self.drivers.coupling.set(Some(*coupling));
    }
}

impl Servo for ServoLine<'_> {
    fn order(&mut self, micros: Option<u16>) {
        self.drivers.servo.set(Some((self.now.get(), micros)));
    }
}

impl DriverBus for Bus<'_> {
    fn lines(&self) -> MotorSet {
        self.drivers.lines
    }

    fn begin(&mut self, motor: Motor, request: &Frame, reply: usize) {
        let said = self.drivers.chip(motor).exchange(request);
        let mut bits = request.len() as u64 * BYTE;
        let outcome = if reply == 0 {
            Ok(Frame::new())
        } else {
            bits += DELAY + reply as u64 * BYTE;
            let whole = Frame::from_slice(&said).ok().filter(|frame| frame.len() == reply);
            whole.ok_or(BusError::Silent)
        };
        if outcome.is_err() {
            bits += PATIENCE;
        }
        self.pending = Some((self.now.get() + bits * u64::from(TICKS_PER_SECOND) / BAUD, outcome));
    }

    fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        let now = self.now.get();
        self.drivers.seen.set(now);
        self.pending.take_if(|(due, _)| *due <= now).map(|(_, outcome)| outcome)
    }
}
