//! Why a command ends before it is done, and why the Console does.

use crate::connectors::Heater;
use core::fmt;

/// Why a command ends before it is done. No interrupt of the processor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Interrupt {
    /// M112, or a fault that only a reset ends.
    Halt,
    /// A motor of the belt has failed, and the others are to park the tool; then it is a halt.
    Limp,
    /// M410.
    QuickStop,
    /// Motors may not have power; the host was told why. Nothing was planned.
    NoPower,
    /// The job ends, the machine stays: see [`JobEnd`].
    EndJob(JobEnd),
}

/// Why a job ends although the machine stays as it is: nothing is broken that a reset would mend.
///
/// A command that finds such a reason returns [`Interrupt::EndJob`], however deep it stands. The dispatch then does what it takes, in one
/// place (`commands::job`): hosts are told to cancel, in no words that make them hang up, heaters go off, the state of the program is
/// that of a new one, and the old stream moves and heats nothing any more.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum JobEnd {
    /// The user wished it (M524).
    Cancelled,
    /// A heater stopped rising below its target; in whole degrees Celsius.
    Unreachable { heater: Heater, at: i32, target: i32 },
}

impl fmt::Display for JobEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => f.write_str("print cancelled, heaters are off"),
            Self::Unreachable { heater, at, target } => write!(
                f,
                "print ended, heaters are off: {} stays at {at} C and does not get to {target} C. \
                 Choose a lower target, or look at its heater, its supply and what cools it",
                heater.name()
            ),
        }
    }
}

/// Why [`Console::run`](crate::machine::Console::run) ends: the machine is to begin anew, as after a reset. No motor has power.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Restart;
