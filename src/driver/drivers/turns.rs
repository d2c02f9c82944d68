//! Turns: the order of exchanges on the wires, which take one at a time.

use super::{Drivers, microsteps};
use crate::driver::chip::Chip;
use crate::driver::reading::Reading;
use crate::driver::run::{DriverJob, Look, Run};
use crate::driver::watch::{Slot, Wanted};
use crate::motors::Motor;
use crate::port::DriverBus;
use crate::units::Instant;

/// The owner of an exchange.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Turn {
    Urgent,
    Background,
    Job,
}

impl<C: Chip> Drivers<C> {
    /// Sends the next request.
    pub(super) fn exchange(&mut self, bus: &mut impl DriverBus, now: Instant) {
        let turn = self.next_turn(now);
        let run = match turn {
            Turn::Urgent => self.urgent,
            Turn::Background => self.background,
            Turn::Job => self.run,
        };
        let Some(run) = run else { return };
        if run.writes()
            && let Some(driver) = self.get_mut(run.motor)
        {
            // With power, the old values are as good as the new ones, unless the size of a step changes.
            let steps = microsteps::<C>(&run.config);
            driver.held = driver.held.filter(|held| run.job == DriverJob::Adjust && microsteps::<C>(held) == steps);
        }
        if let Some((request, reply)) = run.request() {
            bus.begin(run.motor, &request, reply);
            self.on_wire = Some(turn);
        }
    }

    /// The owner of the next exchange. An urgent look without a reply, or with a finding, is repeated at once. So is a
    /// background look of a motor that has lost its power since.
    fn next_turn(&mut self, now: Instant) -> Turn {
        if self.urgent.is_some() {
            return Turn::Urgent;
        }
        if self.background.is_some_and(|look| !self.powered.has(look.motor)) {
            return Turn::Background;
        }
        if self.run.is_none() {
            self.run = self.begin_job();
        }
        let wanted = Wanted {
            watched: self.watched(),
            writing: self.run.filter(Run::writes).map(|run| run.motor),
            has_job: self.run.is_some(),
            has_look: self.background.is_some(),
        };
        match self.watch.next(wanted, now) {
            Slot::Job => Turn::Job,
            Slot::Again => Turn::Background,
            Slot::Urgent(motor) => {
                self.urgent = self.look_at(motor, Look::Flags);
                Turn::Urgent
            }
            Slot::Background(motor, look) => {
                self.background = self.look_at(motor, look);
                Turn::Background
            }
        }
    }

    fn look_at(&self, motor: Motor, look: Look) -> Option<Run<C>> {
        self.get(motor).map(|driver| Run::look(motor, look, driver.held.unwrap_or(driver.wanted)))
    }

    /// The next job: a change first, then a request.
    fn begin_job(&mut self) -> Option<Run<C>> {
        if self.fault.is_some() {
            return None;
        }
        if let Some(motor) = self.stale() {
            return Some(Run::new(motor, DriverJob::Adjust, self.get(motor)?.wanted, true));
        }
        let (job, motor) = self.asked.take()?;
        if !self.lines.has(motor) || (job == DriverJob::Verify && self.powered.has(motor)) {
            // Nothing to report, or nothing to prove: the flags of a motor with power must not be cleared.
            self.result = Some(Ok(Reading::default()));
            return None;
        }
        self.is_awaited = true;
        let driver = self.get(motor)?;
        Some(Run::new(motor, job, driver.wanted, driver.held == Some(driver.wanted)))
    }
}
