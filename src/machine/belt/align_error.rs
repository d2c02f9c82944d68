//! Why the motors of a belt could not be aligned.

use crate::driver::Fault;
use crate::machine::numbers::Thousandths;
use crate::motors::MotorName;
use crate::units::Mm;
use core::fmt::{self, Display, Formatter};

/// The reason.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum AlignError {
    /// The drivers have no UART.
    NoUart,
    /// A driver does not say how hard its motor pulls.
    Driver(Fault),
    /// Hardly anything was read in a stroke.
    TooFewReadings,
    /// Loads do not change with the strain.
    Flat,
    /// The strain is more than motors hold.
    TooFar,
    /// The findings do not agree.
    Unsure,
    /// The motors have changed in the meantime.
    Changed,
    /// Measured again, this strain is left in mm.
    Strained(Mm),
    /// The loads contradict each other by this strain in mm.
    Drags(Mm),
    /// A motor has no torque left where it strains the belt by hardly anything.
    AtLimit(MotorName),
}

impl Display for AlignError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoUart => put!(f, "its drivers cannot be asked for loads"),
            Self::Driver(fault) => fault.fmt(f),
            Self::TooFewReadings => put!(f, "the drivers were hardly read while the tool moved"),
            Self::Flat => put!(f, "the loads that the drivers measure do not change with the belt's strain"),
            Self::TooFar => put!(f, "more strain than three turns explain"),
            Self::Changed => put!(f, "a motor has skipped meanwhile"),
            Self::Strained(by) => {
                put!(f, "measured again, it is strained by {} mm: ", Thousandths(*by))?;
                put!(f, "a motor has skipped meanwhile, or something drags (a roller, a pulley)")
            }
            Self::Drags(by) => {
                put!(f, "strain differs by {} mm with direction or motor: something drags ", Thousandths(*by))?;
                put!(f, "(a roller, a pulley, a motor); see that all turn freely, then M915")
            }
            Self::AtLimit(name) => {
                put!(f, "motor {name} has no torque left: it, its pulley or a roller of its belt drags, ")?;
                put!(f, "or its current is too low (M906); see that all turn freely, then M915")
            }
            Self::Unsure => put!(f, "the loads that the drivers measure do not agree"),
        }
    }
}
