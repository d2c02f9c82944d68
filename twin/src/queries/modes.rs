//! Natural frequencies of the machine.

use super::{At, Setup};
use crate::solve::NotHeld;
use crate::solve::modes::modes;
use serde::Serialize;

/// Natural frequencies at the tool's place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Modes {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// All of them, ascending.
    #[serde(rename = "frequencies_Hz")]
    pub frequencies_hz: Vec<f64>,
    /// The part with most of the energy in each.
    pub of: Vec<String>,
}

impl Modes {
    /// The answer.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(setup: &Setup) -> Result<Self, NotHeld> {
        let modes = modes(&setup.elastic())?;
        let frequencies_hz = modes.iter().map(|mode| mode.frequency_hz).collect();
        Ok(Self {
            at: setup.at(),
            frequencies_hz,
            of: modes.iter().map(super::super::solve::modes::Mode::of).collect(),
        })
    }
}

impl std::fmt::Display for Modes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.at)?;
        for (frequency, of) in self.frequencies_hz.iter().zip(&self.of) {
            writeln!(f, "  {frequency:>9.2} Hz  {of}")?;
        }
        Ok(())
    }
}
