//! Outside: what acts on a machine besides the steps of its motors.
//!
//! Power, the phase at which it finds each motor, a force on the tool, and what rubs on a rotor. The default is a machine that
//! is let alone: all motors have power, and their magnetic zeros lie where the belt is free of strain.

/// What acts from outside. Motors are counted as those of the plant; what is not listed has the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outside {
    /// Strength of each motor's field: 1 holds the holding torque, 0 is a motor without power. 1 where it is not listed.
    pub strengths: Vec<f64>,
    /// Where the detents of each motor lie against the belt at the start, in mm. 0 where it is not listed.
    pub zeros_mm: Vec<f64>,
    /// Force on the tool in x and y, in N.
    pub push_n: [f64; 2],
    /// What the tool runs into: dry friction against its motion, in N.
    pub obstacle_n: f64,
    /// Dry friction of something that rubs on each rotor, in N at the belt. 0 where it is not listed.
    pub brakes_n: Vec<f64>,
}

impl Outside {
    /// Strength of a motor's field.
    #[must_use]
    pub fn strength(&self, motor: usize) -> f64 {
        self.strengths.get(motor).copied().unwrap_or(1.0)
    }

    /// Where a motor's detents lie, in mm.
    #[must_use]
    pub fn zero_mm(&self, motor: usize) -> f64 {
        self.zeros_mm.get(motor).copied().unwrap_or(0.0)
    }
}
