//! Watch: the next driver with power to look at, and the register.
//!
//! The wires take one exchange at a time, of 7.4 ms at 19,200 baud: a **slot**.
//!
//! - **Urgent** motors can pull against each other (the machine's residuals). One that fails must be off within 100 ms,
//!   so every second slot reads GSTAT of one of them, in turn. GSTAT has everything that ends a motor's torque or
//!   changes its steps: reset, a short circuit or heat (drv_err), a low charge pump (uv_cp). A driver without supply
//!   does not reply.
//! - The slots in between belong to jobs, and otherwise to the **background**: GSTAT of the other motors, and CHOPCONF
//!   and DRV_STATUS of all; DRV_STATUS warns of heat. One in [`BETWEEN`] of these slots is reserved for the background
//!   even when a job is pending.
//!
//! Each of four urgent motors gets a look every 64 ms. A driver that has lost its supply is asked four times, 32 ms,
//! before it counts as silent: 96 ms at most. Without urgent motors all slots are background, and each driver of seven
//! gets a look every 168 ms, of eight every 192 ms.

use super::run::Look;
use crate::motors::{MOTORS, Motor, MotorSet};
use crate::units::Instant;

/// Least time in ms from one look to the next: an exchange and the next turn of the main loop.
const SLOT_MS: u32 = 8;

/// One in N slots between urgent looks is reserved for the background even when a job is pending.
const BETWEEN: u8 = 5;

/// Background registers while there are urgent looks. One in three is GSTAT of a motor that is not urgent: each of
/// three motors every 144 ms, of four every 192 ms. CHOPCONF of each of seven comes every 224 ms, DRV_STATUS every 672.
const BESIDE: [Look; 12] = [
    Look::Flags,
    Look::Chopper,
    Look::Chopper,
    Look::Flags,
    Look::Chopper,
    Look::Status,
    Look::Flags,
    Look::Chopper,
    Look::Chopper,
    Look::Flags,
    Look::Chopper,
    Look::Status,
];

/// The same while jobs wait: GSTAT of each of three every 320 ms, of four every 480 ms, the others in free slots.
const BUSY: [Look; 8] =
    [Look::Flags, Look::Flags, Look::Flags, Look::Chopper, Look::Flags, Look::Flags, Look::Flags, Look::Status];

/// Background registers if no motor is urgent.
const ALONE: [Look; 3] = [Look::Status, Look::Flags, Look::Chopper];

/// The owner of a slot.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Slot {
    /// An urgent look at GSTAT of this driver.
    Urgent(Motor),
    /// A look in the background, at this register of this driver.
    Background(Motor, Look),
    /// The current background look, once more.
    Again,
    /// A job, or none.
    Job,
}

/// The state that decides on the next slot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Motors with power and a driver that can be reached.
    pub watched: MotorSet,
    /// The driver that is being written: its CHOPCONF may be old or new.
    pub writing: Option<Motor>,
    /// A job waits for a slot.
    pub has_job: bool,
    /// A background look is not complete.
    pub has_look: bool,
}

/// The motors in turn: the place of the next one.
#[derive(Clone, Copy, Debug)]
struct Round(usize);

impl Round {
    fn next(&mut self, of: MotorSet) -> Option<Motor> {
        for place in self.0..self.0 + MOTORS {
            let next = Motor::ALL.get(place % MOTORS).copied()?;
            if of.has(next) {
                self.0 = next.index() + 1;
                return Some(next);
            }
        }
        None
    }
}

/// The order of looks.
#[derive(Debug)]
pub(super) struct Watch {
    urgent: MotorSet,
    /// Motors that need a look at GSTAT before all else.
    at_once: MotorSet,
    is_urgent_turn: bool,
    /// Slots of jobs since the last background slot.
    given: u8,
    place: usize,
    urgent_round: Round,
    flags: Round,
    chopper: Round,
    status: Round,
    due: Instant,
}

impl Watch {
    pub fn new() -> Self {
        let round = Round(0);
        Self {
            urgent: MotorSet::NONE,
            at_once: MotorSet::NONE,
            is_urgent_turn: true,
            given: 0,
            place: ALONE.len() - 1,
            urgent_round: round,
            flags: round,
            chopper: round,
            status: round,
            due: Instant::default(),
        }
    }

    /// These motors can pull against each other.
    pub const fn hurry(&mut self, urgent: MotorSet) {
        self.urgent = urgent;
    }

    /// GSTAT of these is read before all else.
    pub const fn ask_at_once(&mut self, motors: MotorSet) {
        self.at_once = motors;
    }

    /// GSTAT of this driver was without fault.
    pub const fn note_well(&mut self, motor: Motor) {
        self.at_once = self.at_once.without(MotorSet::of(motor));
    }

    /// Those of `motors` that still wait for their look at GSTAT.
    pub const fn unseen(&self, motors: MotorSet) -> MotorSet {
        motors.without(MotorSet::ALL.without(self.at_once))
    }

    /// The owner of the present slot.
    pub fn next(&mut self, wanted: Wanted, now: Instant) -> Slot {
        let Wanted { watched, has_job, has_look, .. } = wanted;
        if watched.is_empty() || now < self.due {
            return Slot::Job;
        }
        let (unseen, urgent) = (self.unseen(watched), watched.without(MotorSet::ALL.without(self.urgent)));
        let has_urgent = !urgent.is_empty();
        let first = if unseen.is_empty() { urgent } else { unseen };
        let is_urgent_turn = self.is_urgent_turn && has_urgent;
        self.is_urgent_turn = !self.is_urgent_turn;
        let slot = if is_urgent_turn || !unseen.is_empty() {
            self.urgent_round.next(first).map_or(Slot::Job, Slot::Urgent)
        } else if has_job && self.is_for_job(has_urgent) {
            return Slot::Job;
        } else if has_look {
            Slot::Again
        } else {
            self.background(wanted, has_urgent)
        };
        self.due = now.after_ms(SLOT_MS);
        slot
    }

    /// Whether a pending job gets a slot that is not urgent.
    const fn is_for_job(&mut self, has_urgent: bool) -> bool {
        let most = if has_urgent { BETWEEN - 1 } else { 1 };
        let is_for_job = self.given < most;
        self.given = if is_for_job { self.given + 1 } else { 0 };
        is_for_job
    }

    fn background(&mut self, wanted: Wanted, has_urgent: bool) -> Slot {
        let order = match (has_urgent, wanted.has_job) {
            (true, false) => &BESIDE[..],
            (true, true) => &BUSY[..],
            (false, _) => &ALONE[..],
        };
        self.place = (self.place + 1) % order.len();
        let look = order.get(self.place).copied().unwrap_or(Look::Flags);
        if !has_urgent && look == Look::Status {
            // The three registers of one driver follow each other.
            (self.flags, self.chopper) = (self.status, self.status);
        }
        let (round, motors) = match look {
            Look::Flags if has_urgent => (&mut self.flags, wanted.watched.without(self.urgent)),
            Look::Flags => (&mut self.flags, wanted.watched),
            Look::Chopper => (&mut self.chopper, wanted.watched),
            Look::Status => (&mut self.status, wanted.watched),
        };
        match round.next(motors) {
            Some(motor) if look == Look::Chopper && wanted.writing == Some(motor) => {
                Slot::Background(motor, Look::Flags)
            }
            Some(motor) => Slot::Background(motor, look),
            // All of them are urgent.
            None => self.chopper.next(wanted.watched).map_or(Slot::Job, |motor| Slot::Background(motor, Look::Status)),
        }
    }
}

#[cfg(test)]
mod tests;
