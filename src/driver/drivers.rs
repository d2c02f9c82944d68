//! All drivers: their proofs, their power, the current job, and the looks in between.

mod turns;

use super::chip::{Chip, Held, Shown};
use super::error::{DriverError, Fault, News};
use super::reading::Reading;
use super::run::{DriverJob, Next, Run};
use super::watch::Watch;
use crate::motors::{MOTORS, Motor, MotorName, MotorSet};
use crate::port::{BusError, DriverBus, Frame, MotorPower};
use crate::settings::Settings;
use crate::units::Instant;
use turns::Turn;

/// Greatest age of a proof in ms when power comes: eight quick proofs take 195 ms, and 460 with looks in between.
const FRESH_MS: u32 = 500;

/// The state of one driver.
#[derive(Debug)]
struct Driver<C: Chip> {
    /// The name of its motor.
    name: MotorName,
    /// Its required configuration.
    wanted: C::Config,
    /// Its proved configuration.
    held: Option<C::Config>,
    /// Time of the last proof, if it still counts: a proof is valid for one power-up.
    proved: Option<Instant>,
    /// Failed exchanges with it.
    errors: u16,
    is_warned: bool,
}

/// The drivers of a machine.
#[derive(Debug)]
pub struct Drivers<C: Chip> {
    lines: MotorSet,
    powered: MotorSet,
    drivers: [Driver<C>; MOTORS],
    watch: Watch,
    /// The current urgent look, or the poll that follows from a look.
    urgent: Option<Run<C>>,
    /// The current background look. Other exchanges may come between two of its own.
    background: Option<Run<C>>,
    /// The current job. Looks come between two of its exchanges.
    run: Option<Run<C>>,
    /// The owner of the exchange on the wire.
    on_wire: Option<Turn>,
    /// The job that a caller waits for, and its result.
    asked: Option<(DriverJob, Motor)>,
    is_awaited: bool,
    result: Option<Result<Reading, DriverError>>,
    fault: Option<Fault>,
}

impl<C: Chip> Drivers<C> {
    /// Drivers at the start: nothing is proved, and no motor has power. Those of `lines` can be reached if their motor
    /// is fitted.
    #[must_use]
    pub fn new(lines: MotorSet, settings: &Settings) -> Self {
        let drivers = Motor::ALL.map(|motor| Driver {
            name: settings.name_of(motor),
            wanted: C::config(motor, settings),
            held: None,
            proved: None,
            errors: 0,
            is_warned: false,
        });
        let not_fitted = MotorSet::ALL.without(settings.mechanism.fitted());
        Self {
            lines: lines.without(not_fitted),
            powered: MotorSet::NONE,
            drivers,
            watch: Watch::new(),
            urgent: None,
            background: None,
            run: None,
            on_wire: None,
            asked: None,
            is_awaited: false,
            result: None,
            fault: None,
        }
    }

    /// Motors with a driver that can be reached.
    #[must_use]
    pub const fn lines(&self) -> MotorSet {
        self.lines
    }

    /// Motors that have power.
    #[must_use]
    pub const fn powered(&self) -> MotorSet {
        self.powered
    }

    /// The first fault; only a reset ends it.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// The effect of the proved configuration of `motor`'s driver, and its number of failed exchanges.
    #[must_use]
    pub fn known(&self, motor: Motor) -> (Option<Held>, u16) {
        self.get(motor).map_or((None, 0), |d| (d.held.as_ref().map(C::held), d.errors))
    }

    /// What a reading of one of these drivers shows.
    #[must_use]
    pub fn shown(&self, reading: &Reading) -> Shown {
        C::shown(reading)
    }

    /// Sets the required configurations from `settings`. Drivers of motors with power are written soon, the others
    /// before their next power-up.
    pub fn want(&mut self, settings: &Settings) {
        for (motor, driver) in Motor::ALL.into_iter().zip(&mut self.drivers) {
            (driver.name, driver.wanted) = (settings.name_of(motor), C::config(motor, settings));
        }
    }

    /// A motor of `on` that may not have power yet, because its driver still needs a proof.
    #[must_use]
    pub fn unproved(&self, on: MotorSet, now: Instant) -> Option<Motor> {
        let fresh = on.without(self.powered);
        let changing = self.run.filter(Run::writes).map(|run| run.motor);
        let mut both = Motor::ALL.into_iter().zip(&self.drivers);
        both.find(|(motor, d)| {
            let is_fresh = d.proved.is_some_and(|proved| now <= proved.after_ms(FRESH_MS));
            let is_proved = d.held == Some(d.wanted) && is_fresh && changing != Some(*motor);
            fresh.has(*motor) && self.lines.has(*motor) && !is_proved
        })
        .map(|(motor, _)| motor)
    }

    /// Powers exactly the motors of `on`, in one transaction.
    ///
    /// # Errors
    /// A motor that is [`unproved`](Self::unproved); nothing changes then.
    pub fn power(&mut self, on: MotorSet, power: &mut impl MotorPower, now: Instant) -> Result<(), Motor> {
        if let Some(motor) = self.unproved(on, now) {
            return Err(motor);
        }
        if self.fault.is_some() {
            return Ok(());
        }
        for (motor, driver) in Motor::ALL.into_iter().zip(&mut self.drivers) {
            driver.proved = driver.proved.filter(|_| !on.has(motor));
        }
        self.powered = on;
        power.enable(on);
        Ok(())
    }

    /// Takes the power from all motors, in any state.
    pub fn cut(&mut self, power: &mut impl MotorPower) {
        self.powered = MotorSet::NONE;
        power.enable(MotorSet::NONE);
    }

    /// Whether every motor with power makes the required microsteps.
    #[must_use]
    pub fn is_drivable(&self) -> bool {
        let agrees = |d: &Driver<C>| d.held.is_some_and(|held| microsteps::<C>(&held) == microsteps::<C>(&d.wanted));
        Motor::ALL
            .into_iter()
            .zip(&self.drivers)
            .all(|(motor, d)| !(self.lines.has(motor) && self.powered.has(motor)) || agrees(d))
    }

    /// Whether every motor with power has its required configuration.
    #[must_use]
    pub fn is_configured(&self) -> bool {
        self.stale().is_none()
    }

    /// Begins a job as soon as possible, and drops the result of the previous one.
    pub fn ask(&mut self, job: DriverJob, motor: Motor) {
        (self.asked, self.is_awaited, self.result) = (Some((job, motor)), false, None);
    }

    /// The result of the requested job, once.
    pub fn answer(&mut self) -> Option<Result<Reading, DriverError>> {
        self.result.take()
    }

    /// Motors that can pull against each other: a failure of one must be found within 100 ms.
    pub const fn watch_closely(&mut self, motors: MotorSet) {
        self.watch.hurry(motors);
    }

    /// After a fault of one driver: takes the power from its motor alone, and looks at all others at once. These are
    /// still watched, and a second fault is reported; jobs are dropped.
    pub fn go_on_without(&mut self, motor: Motor, power: &mut impl MotorPower) {
        self.powered = self.powered.without(MotorSet::of(motor));
        power.enable(self.powered);
        (self.run, self.asked, self.is_awaited) = (None, None, false);
        self.watch.ask_at_once(MotorSet::ALL);
    }

    /// Whether a driver with power still waits for its first look without a fault since
    /// [`go_on_without`](Self::go_on_without).
    #[must_use]
    pub const fn are_unseen(&self) -> bool {
        !self.watch.unseen(self.watched()).is_empty()
    }

    /// Motors with power and a driver that can be reached.
    const fn watched(&self) -> MotorSet {
        self.lines.without(MotorSet::ALL.without(self.powered))
    }

    /// Does the next part of the work. Never waits; call it every millisecond.
    pub fn step(&mut self, bus: &mut impl DriverBus, now: Instant) -> Option<News> {
        if self.lines.is_empty() || self.is_over() {
            return None;
        }
        let mut news = None;
        if let Some(turn) = self.on_wire {
            let outcome = bus.outcome()?;
            self.on_wire = None;
            news = self.take(turn, outcome, now);
        }
        if !matches!(news, Some(News::Stopped(_))) {
            self.exchange(bus, now);
        }
        news
    }

    /// Whether no exchange follows: a driver has failed, and no motor has power.
    const fn is_over(&self) -> bool {
        self.fault.is_some() && self.powered.is_empty()
    }

    fn take(&mut self, turn: Turn, outcome: Result<Frame, BusError>, now: Instant) -> Option<News> {
        let place = match turn {
            Turn::Urgent => &mut self.urgent,
            Turn::Background => &mut self.background,
            Turn::Job => &mut self.run,
        };
        let mut run = place.take()?;
        let (next, has_failed) = run.take(outcome);
        if next == Next::Exchange {
            *place = Some(run);
        }
        if let Some(driver) = self.get_mut(run.motor) {
            driver.errors = driver.errors.saturating_add(u16::from(has_failed));
        }
        match next {
            Next::Exchange => None,
            Next::Done(result) => self.finish(&run, result, now),
        }
    }

    /// A motor with power without its required configuration.
    fn stale(&self) -> Option<Motor> {
        let both = Motor::ALL.into_iter().zip(&self.drivers);
        both.filter(|(motor, _)| self.powered.has(*motor) && self.lines.has(*motor))
            .find(|(_, d)| d.held != Some(d.wanted))
            .map(|(motor, _)| motor)
    }

    fn finish(&mut self, run: &Run<C>, result: Result<Reading, DriverError>, now: Instant) -> Option<News> {
        let motor = run.motor;
        let has_power = self.powered.has(motor);
        let driver = self.get_mut(motor)?;
        match (run.job, result) {
            (DriverJob::Verify | DriverJob::Adjust, Ok(_)) => {
                (driver.held, driver.proved) = (Some(run.config), Some(now))
            }
            (DriverJob::Verify, Err(_)) => driver.held = None,
            (DriverJob::Poll, Ok(reading)) => {
                if run.is_of_flags() {
                    self.watch.note_well(motor);
                }
                let driver = self.get_mut(motor)?;
                let is_new = C::shown(&reading).is_hot && !driver.is_warned;
                driver.is_warned |= is_new;
                return is_new.then_some(News::Hot(motor));
            }
            (DriverJob::Poll, Err(error)) if has_power && run.is_part_of_the_story(error) => {
                self.urgent = Some(Run::new(motor, DriverJob::Poll, run.config, true));
                return None;
            }
            (DriverJob::Poll | DriverJob::Adjust, Err(error)) if has_power => {
                let fault = Fault { motor, name: driver.name, error };
                self.fault.get_or_insert(fault);
                return Some(News::Stopped(fault));
            }
            // It lost its power in between, and must prove everything before its next power-up.
            (DriverJob::Adjust, Err(_)) => driver.held = None,
            (DriverJob::Poll, Err(_)) => {
                driver.held = None;
                return None;
            }
            (DriverJob::Read | DriverJob::Load | DriverJob::Phase, _) => {}
        }
        if core::mem::take(&mut self.is_awaited) {
            self.result = Some(result);
        }
        None
    }

    fn get(&self, motor: Motor) -> Option<&Driver<C>> {
        self.drivers.get(motor.index())
    }

    fn get_mut(&mut self, motor: Motor) -> Option<&mut Driver<C>> {
        self.drivers.get_mut(motor.index())
    }
}

/// Microsteps of a full step with these contents.
fn microsteps<C: Chip>(config: &C::Config) -> u32 {
    C::held(config).microsteps
}
