//! The answer to STEPPER_BUZZ.

use crate::motors::{Motor, MotorName, MotorSet};

/// What became of a buzz.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum BuzzAnswer {
    /// There is no motor of that name.
    NoMotor(MotorName),
    /// The motor would strain the belt against these.
    Strains(Motor, MotorSet),
    /// It has moved.
    Done {
        motor: Motor,
        /// The way to and fro, in its steps.
        steps: i32,
        /// Motors that had power and stood still.
        held: MotorSet,
        /// Motors of the same axes that turned freely.
        free: MotorSet,
    },
}
