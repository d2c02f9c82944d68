//! Differences from the measurements, and why there is no answer.

use super::parameter::Unknown;
use crate::solve::NotHeld;
use serde::Serialize;

/// Difference between the model and a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Misfit {
    /// The measured value.
    pub measured: f64,
    /// The model's.
    pub model: f64,
    /// The unit of both.
    pub unit: &'static str,
    /// Relative excess of the model's value, of 1.
    pub part: f64,
    /// The excess in uncertainties of the measurement.
    pub uncertainties: f64,
    /// Whether the others fit without it, and do not with it.
    #[serde(skip)]
    pub is_suspect: bool,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrateError {
    /// No measurement depends much on a fitted parameter.
    Nothing,
    /// The figures depend on these numbers, but determine none.
    Undetermined(Vec<Unknown>),
    /// No machine within a factor of a hundred of the start reproduces the measurements.
    NoMachine,
    /// The search found no minimum.
    NotConverged,
    /// Differences from each measurement, too large for one: those of the nearest machine, or of the machine that the
    /// others fit if there is a suspect.
    Unlike(Vec<Misfit>),
    /// Nothing holds the machine.
    NotHeld(NotHeld),
}

impl std::fmt::Display for CalibrateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Nothing => f.write_str("nothing was measured that depends on a parameter that is sought"),
            Self::Undetermined(unknowns) => {
                let keys: Vec<String> = unknowns.iter().map(ToString::to_string).collect();
                write!(f, "these measurements do not determine {}: ", keys.join(" and "))?;
                f.write_str("more than a third of the uncertainty that is assumed of each stays; ")?;
                f.write_str("measure something else that depends on it, or name one in `fixed`")
            }
            Self::NoMachine => f.write_str("no machine within a hundredfold of the nominal numbers measures like this"),
            Self::NotConverged => f.write_str(
                "the search for a machine did not converge; check units, and leave measurements out in turn",
            ),
            Self::Unlike(misfits) => {
                let most = misfits.iter().map(|misfit| misfit.uncertainties.abs()).fold(0.0, f64::max);
                write!(f, "no machine measures like this: the nearest is {most:.0} uncertainties from a measurement")
            }
            Self::NotHeld(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for CalibrateError {}
