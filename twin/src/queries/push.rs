//! The effect of a force on the tool.

use super::strain::Strain;
use super::{At, Setup};
use crate::solve::NotHeld;
use crate::solve::balance::balance;
use serde::Serialize;

/// The effect of a force on the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Push {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// The force to the right and away from the front.
    #[serde(rename = "force_N")]
    pub force_n: [f64; 2],
    /// The effect.
    #[serde(flatten)]
    pub strain: Strain,
}

impl Push {
    /// The answer.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn new(setup: &Setup, force_n: [f64; 2]) -> Result<Self, NotHeld> {
        let elastic = setup.elastic();
        let [x, y] = force_n;
        let balance = balance(&elastic, &setup.params, [x, y, 0.0], &[])?;
        Ok(Self { at: setup.at(), force_n, strain: Strain::new(setup, &elastic, &balance) })
    }
}

impl std::fmt::Display for Push {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y] = self.force_n;
        write!(f, "{}, pushed by ({x}, {y}) N\n{}", self.at, self.strain)
    }
}
