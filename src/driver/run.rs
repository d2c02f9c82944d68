//! A run: the exchanges of one job with one driver, one after the other.
//!
//! There are three kinds of trouble, each with its own answer:
//!
//! - An exchange fails: it is tried again.
//! - A value is wrong: it is read until two readings agree, because one damaged reply in 256 passes its checksum.
//! - A configuration did not arrive correctly: it is written again from the beginning.

use super::config::{Config, WRITTEN};
use super::datagram;
use super::error::DriverError;
use super::reading::{LOADS, Reading};
use super::registers::{Register, chopconf, gconf, ioin};
use crate::motors::Motor;
use crate::port::{BusError, Frame};

/// Attempts to read before the driver counts as silent or unreadable.
const TRIES: u8 = 4;

/// Attempts to write a configuration before it counts as not accepted.
const ROUNDS: u8 = 3;

/// A task for a driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Job {
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

/// One exchange, and the check of its reply.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Step {
    /// It must be a TMC2209.
    Version,
    /// Write a register; the write is not counted.
    Tell(Register),
    /// No flag may be set.
    Flags,
    /// Read the count of accepted writes.
    Count,
    /// Write a register.
    Write(Register),
    /// It must have accepted all writes since [`Step::Count`], and no others.
    Counted,
    /// A register must have its written value.
    Same(Register),
    /// It must not have switched itself off.
    Status,
    /// Read without a check.
    Note(Register),
}

/// The register of a look, for a motor with power.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Look {
    /// GSTAT.
    Flags,
    /// DRV_STATUS.
    Status,
    /// CHOPCONF.
    Chopper,
}

impl Look {
    const fn steps(self) -> &'static [Step] {
        match self {
            Self::Flags => &[Step::Flags],
            Self::Status => &[Step::Status],
            Self::Chopper => &[Step::Same(Register::Chopconf)],
        }
    }
}

/// The quick proof, for a driver that was configured before.
const CHECK: &[Step] = &[Step::Flags, Step::Same(Register::Gconf), Step::Same(Register::Chopconf)];

const POLL: &[Step] = &[Step::Status, Step::Flags, Step::Same(Register::Chopconf)];

const READ: &[Step] = &[
    Step::Note(Register::Gstat),
    Step::Note(Register::Gconf),
    Step::Note(Register::Chopconf),
    Step::Note(Register::DrvStatus),
    Step::Note(Register::SgResult),
    Step::Note(Register::Ifcnt),
];

/// The drivers measure again in every full step.
const LOAD: &[Step] = &[Step::Note(Register::SgResult); LOADS];

const PHASE: &[Step] = &[Step::Note(Register::Mscnt); 2];

/// Another firmware may have set late replies, so the first write makes replies fast. The flags are cleared before all
/// else, so that any later reset is seen.
const CONFIGURE: &[Step] = &script::<4, CONFIGURE_STEPS>([
    Step::Tell(Register::Slaveconf),
    Step::Version,
    Step::Tell(Register::Gstat),
    Step::Count,
]);

/// The flags of a driver with power must not be cleared: they may show a reset that was not read yet.
const ADJUST: &[Step] = &script::<3, ADJUST_STEPS>([Step::Status, Step::Flags, Step::Count]);

/// The steps after the writes.
const AFTER: [Step; 5] = [
    Step::Counted,
    Step::Same(Register::Gconf),
    Step::Same(Register::Chopconf),
    Step::Same(Register::Pwmconf),
    Step::Flags,
];

const CONFIGURE_STEPS: usize = 4 + WRITTEN.len() + AFTER.len();
const ADJUST_STEPS: usize = 3 + WRITTEN.len() + AFTER.len();

/// The steps before, the writes, the steps after.
const fn script<const BEFORE: usize, const ALL: usize>(before: [Step; BEFORE]) -> [Step; ALL] {
    let mut steps = [Step::Counted; ALL];
    let mut i = 0;
    while i < ALL {
        steps[i] = if i < BEFORE {
            before[i]
        } else if i < BEFORE + WRITTEN.len() {
            Step::Write(WRITTEN[i - BEFORE])
        } else {
            AFTER[i - BEFORE - WRITTEN.len()]
        };
        i += 1;
    }
    steps
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub motor: Motor,
    pub job: Job,
    /// The required configuration.
    pub config: Config,
    steps: &'static [Step],
    at: usize,
    tries: u8,
    rounds: u8,
    /// Readings of the current value so far: once wrong, or once wrong and then right.
    doubt: Doubt,
    count: u8,
    reading: Reading,
}

impl Run {
    /// A new run; a driver that `is_configured` may use the quick proof.
    pub fn new(motor: Motor, job: Job, config: Config, is_configured: bool) -> Self {
        let steps = match job {
            Job::Verify if is_configured => CHECK,
            Job::Verify => CONFIGURE,
            Job::Adjust => ADJUST,
            Job::Poll => POLL,
            Job::Read => READ,
            Job::Load => LOAD,
            Job::Phase => PHASE,
        };
        let reading = Reading::default();
        Self { motor, job, config, steps, at: 0, tries: 0, rounds: 0, doubt: Doubt::None, count: 0, reading }
    }

    /// A look at a driver with power and the configuration `config`.
    pub fn look(motor: Motor, look: Look, config: Config) -> Self {
        Self { steps: look.steps(), ..Self::new(motor, Job::Poll, config, true) }
    }

    /// Whether it is a look at GSTAT alone.
    pub fn is_of_flags(&self) -> bool {
        matches!(self.steps, [Step::Flags])
    }

    /// Whether another register may give the reason for this finding. DRV_STATUS shows why a driver has switched itself
    /// off; GSTAT shows the reset that changed CHOPCONF.
    pub fn is_part_of_the_story(&self, error: DriverError) -> bool {
        let is_of_others = matches!(error, DriverError::ShutDown | DriverError::Microsteps | DriverError::Differs(_));
        self.steps.len() == 1 && is_of_others
    }

    /// Whether it may write, so that the driver's configuration is unknown until it is done.
    pub fn writes(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::Write(_)))
    }

    fn step(&self) -> Option<Step> {
        self.steps.get(self.at).copied()
    }

    /// The next request, and the length of its reply.
    pub fn request(&self) -> Option<(Frame, usize)> {
        let read = |register| (datagram::read(register), datagram::REPLY);
        Some(match self.step()? {
            Step::Version => read(Register::Ioin),
            Step::Tell(register) | Step::Write(register) => (datagram::write(register, self.config.value(register)), 0),
            Step::Flags => read(Register::Gstat),
            Step::Count | Step::Counted => read(Register::Ifcnt),
            Step::Status => read(Register::DrvStatus),
            Step::Same(register) | Step::Note(register) => read(register),
        })
    }

    /// Takes the result of the exchange, and returns the continuation and whether the exchange failed.
    pub fn take(&mut self, outcome: Result<Frame, BusError>) -> (Next, bool) {
        let Some(step) = self.step() else { return (Next::Done(Ok(self.reading)), false) };
        let register = match step {
            Step::Tell(_) | Step::Write(_) => {
                return match outcome {
                    Ok(_) => (self.go_on(), false),
                    // It is not known whether the write arrived, so the count would be useless.
                    Err(_) => (self.fail(DriverError::NotTaken), true),
                };
            }
            Step::Version => Register::Ioin,
            Step::Flags => Register::Gstat,
            Step::Count | Step::Counted => Register::Ifcnt,
            Step::Status => Register::DrvStatus,
            Step::Same(register) | Step::Note(register) => register,
        };
        let value = match outcome {
            Ok(reply) => datagram::value(&reply, register).ok_or(DriverError::Garbled),
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
        self.reading.note(register, value);
        (self.judge(step, value), false)
    }

    fn judge(&mut self, step: Step, value: u32) -> Next {
        let wrong = match step {
            Step::Version => {
                let version = value >> ioin::VERSION;
                (version != ioin::TMC2209).then_some(DriverError::WrongChip(version as u8))
            }
            Step::Flags => DriverError::from_flags(value),
            Step::Status => DriverError::from_status(value),
            Step::Counted => {
                let writes = self.steps.iter().filter(|step| matches!(step, Step::Write(_))).count() as u8;
                (value as u8 != self.count.wrapping_add(writes)).then_some(DriverError::NotTaken)
            }
            Step::Same(register) => self.difference(register, value),
            Step::Count => {
                self.count = value as u8;
                None
            }
            Step::Tell(_) | Step::Write(_) | Step::Note(_) => None,
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

    fn difference(&self, register: Register, value: u32) -> Option<DriverError> {
        let wanted = self.config.value(register);
        let decides = match register {
            Register::Gconf => gconf::MSTEP_REG_SELECT,
            Register::Chopconf => 0xF << chopconf::MRES,
            _ => 0,
        };
        if value == wanted {
            None
        } else if (value ^ wanted) & decides != 0 {
            Some(DriverError::Microsteps)
        } else {
            Some(DriverError::Differs(register))
        }
    }

    fn go_on(&mut self) -> Next {
        (self.at, self.tries, self.doubt) = (self.at + 1, 0, Doubt::None);
        if self.at < self.steps.len() { Next::Exchange } else { Next::Done(Ok(self.reading)) }
    }

    /// A driver is wrong: writes its configuration again, if writing is allowed now.
    fn fail(&mut self, error: DriverError) -> Next {
        let again = match (self.job, error) {
            (Job::Poll | Job::Read | Job::Load | Job::Phase, _) | (_, DriverError::WrongChip(_)) => false,
            (Job::Verify, _) => true,
            (Job::Adjust, _) => {
                matches!(error, DriverError::NotTaken | DriverError::Differs(_) | DriverError::Microsteps)
            }
        };
        if !again || self.rounds >= ROUNDS {
            return Next::Done(Err(error));
        }
        if self.job == Job::Verify {
            self.steps = CONFIGURE;
        }
        (self.rounds, self.at, self.tries, self.doubt) = (self.rounds + 1, 0, 0, Doubt::None);
        Next::Exchange
    }
}

#[cfg(test)]
mod tests;
