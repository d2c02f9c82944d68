//! Why a trace cannot be compensated.

use super::LONGEST_S;
use corehbot_twin::geometry::Workspace;
use corehbot_twin::steps::drive::NoColumn;

/// Why a trace cannot be compensated.
#[derive(Clone, Debug, PartialEq)]
pub enum CompensationError {
    /// It has no column for a motor.
    NoColumn(NoColumn),
    /// It lasts this many s.
    TooLong(f64),
    /// The path leaves the reach of the machine.
    OutOfReach {
        /// Extent of the path.
        path: Workspace,
        /// The reach.
        reach: Workspace,
    },
    /// After this many s a motor would step faster than once in 10 us.
    TooFast(f64),
}

impl std::fmt::Display for CompensationError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoColumn(error) => error.fmt(f),
            Self::TooLong(seconds) => {
                write!(f, "the trace lasts {seconds:.0} s; up to {LONGEST_S:.0} s are compensated")
            }
            Self::OutOfReach { path, reach } => write!(f, "the path takes {path} mm; the tool reaches {reach}"),
            Self::TooFast(seconds) => {
                write!(f, "after {seconds:.3} s a motor steps faster than 100,000 steps/s, which is not compensated")
            }
        }
    }
}

impl std::error::Error for CompensationError {}
