//! Why a case gives no corner errors.

use std::fmt;

/// A problem that the caller can fix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Error {
    /// The speed is outside [`SPEEDS`](super::SPEEDS), m/s.
    Speed(f64),
    /// The gain of the DC motors' control is outside [`GAINS`](super::GAINS), V/rad.
    Gain(f64),
    /// The factor of this name is outside [`FACTORS`](super::FACTORS).
    Factor(&'static str, f64),
    /// The rig has an illegal value of this name.
    Parameter(&'static str),
    /// Stiff springs or friction need more than this many time steps: reduce them, or raise the speed.
    TooManySteps(usize),
    /// The tool did not come round this corner (1 is the first) before the middle of the next side: reduce speed or
    /// friction.
    NotTurned(usize),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Speed(v) => write!(f, "a speed of {v} m/s is outside {:?} m/s", super::SPEEDS),
            Error::Gain(gain) => write!(f, "a gain of {gain} V/rad is outside {:?} V/rad", super::GAINS),
            Error::Factor(name, value) => {
                write!(f, "the factor of {name}, {value}, is outside {:?}", super::FACTORS)
            }
            Error::Parameter(name) => write!(f, "the rig has an illegal {name}"),
            Error::TooManySteps(most) => write!(f, "more than {most} time steps: raise the speed or the mass"),
            Error::NotTurned(corner) => {
                write!(f, "the tool lags so much that it never turns corner {corner}: less speed or friction")
            }
        }
    }
}

impl std::error::Error for Error {}
