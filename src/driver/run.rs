//! A run: the exchanges of one job with one driver, one after the other.
//!
//! There are three kinds of trouble, each with its own answer:
//!
//! - An exchange fails: it is tried again.
//! - A value is wrong: it is read until two readings agree, because one damaged reply in 256 passes its checksum.
//! - A configuration did not arrive correctly: it is written again from the beginning.

use super::chip::{Check, Chip, Step};
use super::error::DriverError;
use super::reading::Reading;
use crate::motors::Motor;
use crate::port::{BusError, Frame};

/// Attempts to read before the driver counts as silent or unreadable.
const TRIES: u8 = 4;

/// Attempts to write a configuration before it counts as not accepted.
const ROUNDS: u8 = 3;

/// A task for a driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DriverJob {
    /// Prove its configuration, and write it if necessary. The motor has no power.
    Verify,
    /// Change the configuration of a motor that has power.
    Adjust,
    /// Check a motor with power, and find its error.
    Poll,
    /// Read the values for a report.
    Read,
    /// Read the motor's load several times.
    Load,
    /// Read the driver's position in its sine table twice.
    Phase,
}

/// The register of a look, for a motor with power.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Look {
    /// The flags.
    Flags,
    /// Heat and shorts.
    Status,
    /// The microsteps.
    Chopper,
}

impl Look {
    const fn steps<C: Chip>(self) -> &'static [Step<C::Register>] {
        match self {
            Self::Flags => C::SCRIPTS.flags,
            Self::Status => C::SCRIPTS.status,
            Self::Chopper => C::SCRIPTS.chopper,
        }
    }
}

/// Continuation of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Next {
    /// Another exchange.
    Exchange,
    /// The run is done.
    Done(Result<Reading, DriverError>),
}

/// Whether a value was wrong.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Doubt {
    None,
    Wrong,
    WrongThenRight,
}

/// A job in progress with one driver.
#[derive(Debug)]
pub(super) struct Run<C: Chip> {
    pub motor: Motor,
    pub job: DriverJob,
    /// The required configuration.
    pub config: C::Config,
    steps: &'static [Step<C::Register>],
    at: usize,
    tries: u8,
    rounds: u8,
    /// Readings of the current value so far: once wrong, or once wrong and then right.
    doubt: Doubt,
    count: u8,
    reading: Reading,
}

impl<C: Chip> Clone for Run<C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<C: Chip> Copy for Run<C> {}

impl<C: Chip> Run<C> {
    /// A new run; a driver that `is_configured` may use the quick proof.
    pub fn new(motor: Motor, job: DriverJob, config: C::Config, is_configured: bool) -> Self {
        let steps = match job {
            DriverJob::Verify if is_configured => C::SCRIPTS.check,
            DriverJob::Verify => C::SCRIPTS.configure,
            DriverJob::Adjust => C::SCRIPTS.adjust,
            DriverJob::Poll => C::SCRIPTS.poll,
            DriverJob::Read => C::SCRIPTS.read,
            DriverJob::Load => C::SCRIPTS.load,
            DriverJob::Phase => C::SCRIPTS.phase,
        };
        let reading = Reading::default();
        Self { motor, job, config, steps, at: 0, tries: 0, rounds: 0, doubt: Doubt::None, count: 0, reading }
    }

    /// A look at a driver with power and the configuration `config`.
    pub fn look(motor: Motor, look: Look, config: C::Config) -> Self {
        Self { steps: look.steps::<C>(), ..Self::new(motor, DriverJob::Poll, config, true) }
    }

    /// Whether it is a look at the flags alone.
    pub fn is_of_flags(&self) -> bool {
        matches!(self.steps, [Step::Read(_, Check::Flags)])
    }

    /// Whether another register may give the reason for this finding. The status shows why a driver has switched itself
    /// off; the flags show the reset that changed its microsteps.
    pub fn is_part_of_the_story(&self, error: DriverError) -> bool {
        let is_of_others = matches!(error, DriverError::ShutDown | DriverError::Microsteps | DriverError::Differs(_));
        self.steps.len() == 1 && is_of_others
    }

    /// Whether it may write, so that the driver's configuration is unknown until it is done.
    pub fn writes(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::Write(_)))
    }

    fn step(&self) -> Option<Step<C::Register>> {
        self.steps.get(self.at).copied()
    }

    /// The next request, and the length of its reply.
    pub fn request(&self) -> Option<(Frame, usize)> {
        Some(match self.step()? {
            Step::Tell(register) | Step::Write(register) => C::write(register, C::value(&self.config, register)),
            Step::Read(register, _) => C::read(register),
        })
    }

    /// Takes the result of the exchange, and returns the continuation and whether the exchange failed.
    pub fn take(&mut self, outcome: Result<Frame, BusError>) -> (Next, bool) {
        let (register, check) = match self.step() {
            None => return (Next::Done(Ok(self.reading)), false),
            Some(Step::Tell(_) | Step::Write(_)) => {
                return match outcome {
                    Ok(_) => (self.go_on(), false),
                    // It is not known whether the write arrived, so the count would be useless.
                    Err(_) => (self.fail(DriverError::NotTaken), true),
                };
            }
            Some(Step::Read(register, check)) => (register, check),
        };
        let value = match outcome {
            Ok(reply) => C::reply(&reply, register).ok_or(DriverError::Garbled),
            Err(BusError::Silent) => Err(DriverError::Silent),
            Err(BusError::Garbled) => Err(DriverError::Garbled),
        };
        let value = match value {
            Ok(value) => value,
            Err(error) => {
                self.tries += 1;
                let next = if self.tries < TRIES { Next::Exchange } else { Next::Done(Err(error)) };
                return (next, true);
            }
        };
        C::note(&mut self.reading, register, value);
        (self.judge(register, check, value), false)
    }

    fn judge(&mut self, register: C::Register, check: Check, value: u32) -> Next {
        let wrong = match check {
            Check::Chip => C::other_chip(value),
            Check::Flags => C::error_of_flags(value),
            Check::Status => C::error_of_status(value),
            Check::Counted => {
                let writes = self.steps.iter().filter(|step| matches!(step, Step::Write(_))).count() as u8;
                (value as u8 != self.count.wrapping_add(writes)).then_some(DriverError::NotTaken)
            }
            Check::Same => C::difference(register, value, C::value(&self.config, register)),
            Check::Count => {
                self.count = value as u8;
                None
            }
            Check::Any => None,
        };
        // A second wrong value fails. After a single one, two right ones in a row have to follow.
        self.doubt = match (wrong, self.doubt) {
            (None, Doubt::None | Doubt::WrongThenRight) => return self.go_on(),
            (None, Doubt::Wrong) => Doubt::WrongThenRight,
            (Some(_), Doubt::None) => Doubt::Wrong,
            (Some(error), _) => return self.fail(error),
        };
        self.tries = 0;
        Next::Exchange
    }

    fn go_on(&mut self) -> Next {
        (self.at, self.tries, self.doubt) = (self.at + 1, 0, Doubt::None);
        if self.at < self.steps.len() { Next::Exchange } else { Next::Done(Ok(self.reading)) }
    }

    /// A driver is wrong: writes its configuration again, if writing is allowed now.
    fn fail(&mut self, error: DriverError) -> Next {
        let again = match (self.job, error) {
            (DriverJob::Poll | DriverJob::Read | DriverJob::Load | DriverJob::Phase, _)
            | (_, DriverError::WrongChip(..)) => false,
            (DriverJob::Verify, _) => true,
            (DriverJob::Adjust, _) => {
                matches!(error, DriverError::NotTaken | DriverError::Differs(_) | DriverError::Microsteps)
            }
        };
        if !again || self.rounds >= ROUNDS {
            return Next::Done(Err(error));
        }
        if self.job == DriverJob::Verify {
            self.steps = C::SCRIPTS.configure;
        }
        (self.rounds, self.at, self.tries, self.doubt) = (self.rounds + 1, 0, 0, Doubt::None);
        Next::Exchange
    }
}

#[cfg(test)]
mod tests;
