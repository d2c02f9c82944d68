//! All drivers: who holds what, who has power, and the one job that goes on.

use super::config::Config;
use super::error::{DriverError, Fault, News};
use super::reading::Reading;
use super::run::{Job, Next, Run};
use crate::motors::{Motor, MotorSet};
use crate::port::DriverBus;
use crate::settings::Settings;
use crate::units::Instant;

/// One driver is looked at every so many ms while motors have power: each of seven every 175 ms. It takes 22 ms of
/// wire at 19,200 baud, so the wire has little rest.
const POLL_MS: u32 = 25;

/// A proof is this many ms old at most when power comes: seven quick ones take 150 ms, and 330 with a poll after each.
const FRESH_MS: u32 = 500;

const MOTORS: usize = Motor::ALL.len();

/// What is known of one driver.
#[derive(Clone, Copy, Debug)]
struct Driver {
    /// What it is to hold.
    wanted: Config,
    /// What it has proved to hold.
    held: Option<Config>,
    /// When it last did, if that still counts: a proof is good for getting power once.
    proved: Option<Instant>,
    /// Exchanges with it that failed.
    errors: u16,
    is_warned: bool,
}

/// The drivers of a machine.
#[derive(Debug)]
pub struct Drivers {
    lines: MotorSet,
    powered: MotorSet,
    drivers: [Driver; MOTORS],
    run: Option<Run>,
    /// The job that somebody waits for, and its result.
    asked: Option<(Job, Motor)>,
    is_awaited: bool,
    result: Option<Result<Reading, DriverError>>,
    next_poll: Instant,
    polled: Motor,
    /// The last job was a poll, so that others that wait come first.
    has_polled: bool,
    fault: Option<Fault>,
}

impl Drivers {
    /// Drivers of which those of `lines` can be talked to, if their motor is fitted. Nothing is known of them, and no motor has power.
    #[must_use]
    pub fn new(lines: MotorSet, settings: &Settings) -> Self {
        let drivers = Motor::ALL.map(|motor| Driver {
            wanted: Config::new(motor, settings),
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
            run: None,
            asked: None,
            is_awaited: false,
            result: None,
            next_poll: Instant::default(),
            polled: Motor::E0,
            has_polled: false,
            fault: None,
        }
    }

    /// Motors whose driver can be talked to.
    #[must_use]
    pub const fn lines(&self) -> MotorSet {
        self.lines
    }

    /// Motors that have power.
    #[must_use]
    pub const fn powered(&self) -> MotorSet {
        self.powered
    }

    /// The fault that took the power from all motors; only a reset ends it.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// What the driver of `motor` has proved to hold, and how many exchanges with it failed.
    #[must_use]
    pub fn known(&self, motor: Motor) -> (Option<Config>, u16) {
        self.get(motor).map_or((None, 0), |d| (d.held, d.errors))
    }

    /// From now on the drivers are to hold what `settings` say. Those of motors with power are written soon, the
    /// others before they get it.
    pub fn want(&mut self, settings: &Settings) {
        for (motor, driver) in Motor::ALL.into_iter().zip(&mut self.drivers) {
            driver.wanted = Config::new(motor, settings);
        }
    }

    /// A motor of `on` that may not have power yet, because its driver has yet to prove what it holds.
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
    pub fn power(&mut self, on: MotorSet, bus: &mut impl DriverBus, now: Instant) -> Result<(), Motor> {
        if let Some(motor) = self.unproved(on, now) {
            return Err(motor);
        }
        if self.fault.is_some() {
            return Ok(());
        }
        if self.powered.is_empty() {
            self.next_poll = now.after_ms(POLL_MS);
        }
        for (motor, driver) in Motor::ALL.into_iter().zip(&mut self.drivers) {
            driver.proved = driver.proved.filter(|_| !on.has(motor));
        }
        self.powered = on;
        bus.enable(on);
        Ok(())
    }

    /// Takes the power from all motors, whatever goes on.
    pub fn cut(&mut self, bus: &mut impl DriverBus) {
        self.powered = MotorSet::NONE;
        bus.enable(MotorSet::NONE);
    }

    /// Whether every motor that has power makes the microsteps that it is to make.
    #[must_use]
    pub fn is_drivable(&self) -> bool {
        let agrees = |d: &Driver| d.held.is_some_and(|held| held.microsteps() == d.wanted.microsteps());
        Motor::ALL
            .into_iter()
            .zip(&self.drivers)
            .all(|(motor, d)| !(self.lines.has(motor) && self.powered.has(motor)) || agrees(d))
    }

    /// Whether every motor that has power holds what it is to hold.
    #[must_use]
    pub fn is_configured(&self) -> bool {
        self.stale().is_none()
    }

    /// Begins a job as soon as that may be, and forgets the one before if nobody took its result.
    pub fn ask(&mut self, job: Job, motor: Motor) {
        (self.asked, self.is_awaited, self.result) = (Some((job, motor)), false, None);
    }

    /// The result of the job that was asked for, once.
    pub fn answer(&mut self) -> Option<Result<Reading, DriverError>> {
        self.result.take()
    }

    /// Goes on. Never waits; call it every millisecond.
    pub fn step(&mut self, bus: &mut impl DriverBus, now: Instant) -> Option<News> {
        if self.lines.is_empty() || self.fault.is_some() {
            return None;
        }
        let Some(mut run) = self.run else {
            self.run = self.begin(now);
            self.exchange(bus);
            return None;
        };
        let outcome = bus.outcome()?;
        let (next, has_failed) = run.take(outcome);
        if let Some(driver) = self.get_mut(run.motor) {
            driver.errors = driver.errors.saturating_add(u16::from(has_failed));
        }
        self.run = Some(run);
        let news = match next {
            Next::Exchange => None,
            Next::Done(result) => {
                self.run = None;
                self.finish(&run, result, now)
            }
        };
        if self.run.is_none() && self.fault.is_none() {
            self.run = self.begin(now);
        }
        self.exchange(bus);
        news
    }

    /// Sends what the present run wants sent.
    fn exchange(&mut self, bus: &mut impl DriverBus) {
        let Some(run) = self.run else { return };
        if run.writes()
            && let Some(driver) = self.get_mut(run.motor)
        {
            // Under power the old values are as good as the new ones, unless a step changes its size.
            let microsteps = run.config.microsteps();
            driver.held = driver.held.filter(|held| run.job == Job::Adjust && held.microsteps() == microsteps);
        }
        if let Some((request, reply)) = run.request() {
            bus.begin(run.motor, &request, reply);
        }
    }

    /// The job that is to be done now: health, changes, what somebody asked for. On a bad wire a poll takes so long
    /// that the next is due, and the others get every second turn nevertheless.
    fn begin(&mut self, now: Instant) -> Option<Run> {
        let watched = self.lines.without(MotorSet::ALL.without(self.powered));
        let is_awaited = self.stale().is_some() || self.asked.is_some();
        let others_first = core::mem::take(&mut self.has_polled) && is_awaited;
        if !watched.is_empty() && now >= self.next_poll && !others_first {
            self.has_polled = true;
            self.next_poll = now.after_ms(POLL_MS);
            let mut order = Motor::ALL.into_iter().cycle().skip(self.polled as usize + 1).take(MOTORS);
            if let Some(motor) = order.find(|motor| watched.has(*motor)) {
                self.polled = motor;
                let driver = self.get(motor)?;
                return Some(Run::new(motor, Job::Poll, driver.held.unwrap_or(driver.wanted), true));
            }
        }
        if let Some(motor) = self.stale() {
            return Some(Run::new(motor, Job::Adjust, self.get(motor)?.wanted, true));
        }
        let (job, motor) = self.asked.take()?;
        if !self.lines.has(motor) || (job == Job::Verify && self.powered.has(motor)) {
            // Nothing to say, or nothing to prove: the flags of a motor with power are not to be cleared.
            self.result = Some(Ok(Reading::default()));
            return None;
        }
        self.is_awaited = true;
        let driver = self.get(motor)?;
        Some(Run::new(motor, job, driver.wanted, driver.held == Some(driver.wanted)))
    }

    /// A motor with power that does not hold what it is to hold.
    fn stale(&self) -> Option<Motor> {
        let both = Motor::ALL.into_iter().zip(&self.drivers);
        both.filter(|(motor, _)| self.powered.has(*motor) && self.lines.has(*motor))
            .find(|(_, d)| d.held != Some(d.wanted))
            .map(|(motor, _)| motor)
    }

    fn finish(&mut self, run: &Run, result: Result<Reading, DriverError>, now: Instant) -> Option<News> {
        let motor = run.motor;
        let has_power = self.powered.has(motor);
        let driver = self.get_mut(motor)?;
        match (run.job, result) {
            (Job::Verify | Job::Adjust, Ok(_)) => (driver.held, driver.proved) = (Some(run.config), Some(now)),
            (Job::Verify, Err(_)) => driver.held = None,
            (Job::Poll, Ok(reading)) => {
                let is_new = reading.is_hot() && !driver.is_warned;
                driver.is_warned |= is_new;
                return is_new.then_some(News::Hot(motor));
            }
            (Job::Poll | Job::Adjust, Err(error)) if has_power => {
                let fault = Fault { motor, error };
                self.fault = Some(fault);
                return Some(News::Stopped(fault));
            }
            // It lost its power in the meantime, and must prove everything before it gets it again.
            (Job::Poll | Job::Adjust, Err(_)) => driver.held = None,
            (Job::Read | Job::Load | Job::Phase, _) => {}
        }
        if core::mem::take(&mut self.is_awaited) {
            self.result = Some(result);
        }
        None
    }

    fn get(&self, motor: Motor) -> Option<&Driver> {
        self.drivers.get(motor as usize)
    }

    fn get_mut(&mut self, motor: Motor) -> Option<&mut Driver> {
        self.drivers.get_mut(motor as usize)
    }
}
