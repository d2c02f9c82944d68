//! A run: the exchanges of one job with one driver, one after the other.
//!
//! Three answers to three kinds of trouble. An exchange that fails is tried again. A value that should not be is
//! read until two readings agree, for one damaged reply in 256 passes its checksum. And a configuration that did not arrive as it
//! should is written again from the beginning.

use super::config::{Config, WRITTEN};
use super::datagram;
use super::error::DriverError;
use super::reading::{LOADS, Reading};
use super::registers::{Register, chopconf, gconf, ioin};
use crate::motors::Motor;
use crate::port::{BusError, Frame};

/// How often a read is tried before the driver counts as silent or unreadable.
const TRIES: u8 = 4;

/// How often a configuration is written again before it counts as not taken.
const ROUNDS: u8 = 3;

/// What is to be done with a driver.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Job {
    /// Prove that it holds its configuration, and write that if need be. The motor has no power.
    Verify,
    /// Change the configuration of a motor that has power.
    Adjust,
    /// See whether all is well with a motor that has power, or what is wrong.
    Poll,
    /// Read what a report tells.
    Read,
    /// Read several times how hard the motor pulls.
    Load,
    /// Read twice where in its sine table the driver stands.
    Phase,
}

/// One exchange, and what is made of it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Step {
    /// It must be a TMC2209.
    Version,
    /// Write a register without counting it.
    Tell(Register),
    /// No flag may be up.
    Flags,
    /// How many writes it has taken so far.
    Count,
    /// Write a register.
    Write(Register),
    /// It must have taken all writes since [`Step::Count`], and no others.
    Counted,
    /// A register must hold what was written.
    Same(Register),
    /// It must not have switched itself off.
    Status,
    /// Read without a judgement.
    Note(Register),
}

/// What a look is at: one register of a motor that has power.
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

/// The drivers measure anew every full step.
const LOAD: &[Step] = &[Step::Note(Register::SgResult); LOADS];

const PHASE: &[Step] = &[Step::Note(Register::Mscnt); 2];

/// Another firmware may have asked for late replies, so the first word is to answer soon. The flags are cleared
/// before everything else: a reset from there on is seen.
const CONFIGURE: &[Step] = &script::<4, CONFIGURE_STEPS>([
    Step::Tell(Register::Slaveconf),
    Step::Version,
    Step::Tell(Register::Gstat),
    Step::Count,
]);

/// A driver that has power must not have its flags cleared: they may tell of a reset that nobody has seen yet.
const ADJUST: &[Step] = &script::<3, ADJUST_STEPS>([Step::Status, Step::Flags, Step::Count]);

/// What follows the writes.
const AFTER: [Step; 5] = [
    Step::Counted,
    Step::Same(Register::Gconf),
    Step::Same(Register::Chopconf),
    Step::Same(Register::Pwmconf),
    Step::Flags,
];

const CONFIGURE_STEPS: usize = 4 + WRITTEN.len() + AFTER.len();
const ADJUST_STEPS: usize = 3 + WRITTEN.len() + AFTER.len();

/// What comes before, the writes, what comes after.
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

/// How a run goes on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Next {
    /// With another exchange.
    Exchange,
    /// Not at all: it is done.
    Done(Result<Reading, DriverError>),
}

/// Whether a value was found to be wrong.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Doubt {
    None,
    Wrong,
    WrongThenRight,
}

/// A job with one driver, on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub motor: Motor,
    pub job: Job,
    /// The configuration that the driver must hold.
    pub config: Config,
    steps: &'static [Step],
    at: usize,
    tries: u8,
    rounds: u8,
    /// What the present value said so far: once wrong, or once wrong and then right.
    doubt: Doubt,
    count: u8,
    reading: Reading,
}

impl Run {
    /// A new run; a driver that `is_configured` may prove it quickly.
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

    /// A look at a driver whose motor has power, and that holds `config`.
    pub fn look(motor: Motor, look: Look, config: Config) -> Self {
        Self { steps: look.steps(), ..Self::new(motor, Job::Poll, config, true) }
    }

    /// Whether it is a look at GSTAT alone.
    pub fn is_of_flags(&self) -> bool {
        matches!(self.steps, [Step::Flags])
    }

    /// Whether another register may tell why a look has found this: DRV_STATUS why a driver has switched itself off, GSTAT that it was
    /// reset and so has another CHOPCONF.
    pub fn is_part_of_the_story(&self, error: DriverError) -> bool {
        let is_of_others = matches!(error, DriverError::ShutDown | DriverError::Microsteps | DriverError::Differs(_));
        self.steps.len() == 1 && is_of_others
    }

    /// Whether it may write, so that what the driver holds is not known until it is done.
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

    /// What the exchange brought, and how to go on. The second value tells whether it failed.
    pub fn take(&mut self, outcome: Result<Frame, BusError>) -> (Next, bool) {
        let Some(step) = self.step() else { return (Next::Done(Ok(self.reading)), false) };
        let register = match step {
            Step::Tell(_) | Step::Write(_) => {
                return match outcome {
                    Ok(_) => (self.go_on(), false),
                    // Whether it arrived is not known, so the count would be worth nothing.
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

    /// A driver is not as it should be: writes what it must hold, if that may be written now.
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
