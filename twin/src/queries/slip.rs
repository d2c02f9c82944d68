//! The effect of a slipped motor: it stands this many full steps from its commanded place, and the belt is strained.

use super::strain::Strain;
use super::{At, Setup};
use crate::solve::NotHeld;
use crate::solve::balance::balance;
use serde::Serialize;

/// Full steps of a slip: a rotor that loses its field regains it an electrical turn away.
pub const A_SLIP: f64 = 4.0;

/// The effect of a slipped motor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Slip {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// The motor that slipped.
    pub motor: u8,
    /// By how many full steps, counter-clockwise.
    pub full_steps: f64,
    /// The same in mm of belt.
    pub belt_mm: f64,
    /// The effect.
    #[serde(flatten)]
    pub strain: Strain,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SlipError {
    /// The machine has no such motor; it has these.
    NoMotor(u8, Vec<u8>),
    /// Nothing holds the machine.
    NotHeld(NotHeld),
}

impl std::fmt::Display for SlipError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoMotor(motor, known) => {
                let known: Vec<String> = known.iter().map(ToString::to_string).collect();
                write!(f, "there is no motor {motor}; the machine has {}", known.join(", "))
            }
            Self::NotHeld(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SlipError {}

impl Slip {
    /// The answer.
    ///
    /// # Errors
    /// There is no such motor, or nothing holds the machine.
    pub fn new(setup: &Setup, motor: u8, full_steps: f64) -> Result<Self, SlipError> {
        let motors = setup.machine.motors();
        if !motors.contains(&motor) {
            return Err(SlipError::NoMotor(motor, motors));
        }
        let elastic = setup.elastic();
        let belt_mm = full_steps * setup.params.full_step_mm(setup.machine.index_of(motor));
        let balance = balance(&elastic, &setup.params, [0.0; 3], &[(motor, belt_mm)]).map_err(SlipError::NotHeld)?;
        Ok(Self { at: setup.at(), motor, full_steps, belt_mm, strain: Strain::new(setup, &elastic, &balance) })
    }
}

impl std::fmt::Display for Slip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { at, motor, full_steps, belt_mm, strain } = self;
        write!(f, "{at}, motor {motor} slipped by {full_steps} full steps ({belt_mm:.5} mm of belt)\n{strain}")
    }
}
