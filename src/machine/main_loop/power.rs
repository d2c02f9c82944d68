//! Power of the motors: their drivers, the board's lines to them, and the time after which idle motors lose it.
//!
//! Invariant: a motor gets power only after its driver has just shown that it holds its settings (`driver::Drivers`).
//! [`powering`](super::powering) has the waits for that.

use crate::driver::{DriverError, DriverJob, Drivers, Fault, News, Reading};
use crate::machine::ports::PortSet;
use crate::machine::state::idle_timeout::IdleTimeout;
use crate::motors::Coupling;
use crate::port::{DriverBus, Motor, MotorPower, MotorSet};
use crate::settings::Settings;
use crate::units::Instant;

/// The drivers, and which motors have power.
pub(in crate::machine) struct Power<P: PortSet> {
    motors: P::Motors,
    bus: P::Drivers,
    /// The settings in the motor drivers, and the motors with power.
    drivers: Drivers<P::Chip>,
    idle_timeout: IdleTimeout,
}

impl<P: PortSet> Power<P> {
    pub(super) fn new(motors: P::Motors, bus: P::Drivers, settings: &Settings, now: Instant) -> Self {
        Self { drivers: Drivers::new(bus.lines(), settings), motors, bus, idle_timeout: IdleTimeout::new(now) }
    }

    /// Motors with a driver that has a UART.
    pub const fn uarts(&self) -> MotorSet {
        self.drivers.lines()
    }

    /// Whether these motors have power, and their steps are of the size that is counted on.
    pub fn is_on(&self, motors: MotorSet) -> bool {
        motors.without(self.drivers.powered()).is_empty() && self.drivers.is_drivable()
    }

    /// M84 S.
    pub const fn set_idle_timeout(&mut self, seconds: u32, now: Instant) {
        self.idle_timeout.set(seconds, now);
    }

    /// The drivers, for reports.
    pub const fn drivers(&self) -> &Drivers<P::Chip> {
        &self.drivers
    }

    /// The motors with power.
    pub(super) const fn powered(&self) -> MotorSet {
        self.drivers.powered()
    }

    /// No motor has power at the start.
    pub(super) fn begin(&mut self) {
        self.motors.enable(MotorSet::NONE);
    }

    /// Has the drivers hold the settings of these; they get them in the background.
    pub(super) fn want(&mut self, wanted: &Settings) {
        self.drivers.want(wanted);
    }

    /// Whether the drivers of motors with power hold the wanted settings.
    pub(super) fn is_configured(&self) -> bool {
        self.drivers.is_configured()
    }

    /// Whether there is a motor with power and a driver that was not looked at since a fault.
    pub(super) fn are_unseen(&self) -> bool {
        self.drivers.are_unseen()
    }

    /// Has a job done with one driver.
    pub(super) fn ask(&mut self, job: DriverJob, motor: Motor) {
        self.drivers.ask(job, motor);
    }

    /// The result of that, once.
    pub(super) fn answer(&mut self) -> Option<Result<Reading, DriverError>> {
        self.drivers.answer()
    }

    /// These motors are looked at closely while they get power.
    pub(super) fn watch_closely(&mut self, motors: MotorSet) {
        self.drivers.watch_closely(motors);
    }

    /// A motor with a driver that needs a proof before these motors get power.
    pub(super) fn unproved(&self, motors: MotorSet, now: Instant) -> Option<Motor> {
        self.drivers.unproved(motors, now)
    }

    /// Gives power to these motors and to no others, if no driver lacks a proof.
    pub(super) fn set(&mut self, on: MotorSet, now: Instant) {
        // A proof that is too old is requested again.
        let _ = self.drivers.power(on, &mut self.motors, now);
    }

    /// Takes power from all motors, at once.
    pub(super) fn cut(&mut self) {
        self.drivers.cut(&mut self.motors);
    }

    /// A motor with a driver that has failed loses its power, the others keep theirs.
    pub(super) fn go_on_without(&mut self, motor: Motor) {
        self.drivers.go_on_without(motor, &mut self.motors);
    }

    /// Has the step pins turn these motors for each group.
    pub(super) fn couple(&mut self, coupling: &Coupling) {
        self.motors.couple(coupling);
    }

    /// The first fault of a driver.
    pub(super) const fn fault(&self) -> Option<Fault> {
        self.drivers.fault()
    }

    /// Continues the work of the drivers.
    pub(super) fn step(&mut self, now: Instant) -> Option<News> {
        self.drivers.step(&mut self.bus, now)
    }

    /// Something moves, or is about to.
    pub(super) const fn note_motion(&mut self, now: Instant) {
        self.idle_timeout.note_motion(now);
    }

    /// Whether motors have power that nothing has used for long enough; in a print for longer.
    pub(super) fn is_idle(&self, now: Instant, is_printing: bool) -> bool {
        self.idle_timeout.is_over(now, is_printing) && !self.drivers.powered().is_empty()
    }
}
