//! Outside: actions on a machine other than the steps of its motors.
//!
//! Power, the phase of each motor at power-up, a force on the tool, and friction on a rotor or idler. By default all
//! motors have power, and their magnetic zeros lie where the belt is free of strain.

/// Outside actions. Motors are numbered as in the plant; values that are not listed have the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outside {
    /// Strength of each motor's field: 1 gives the holding torque, 0 is a motor without power. Default 1.
    pub strengths: Vec<f64>,
    /// Detent positions of each motor relative to the belt at the start, in mm. Default 0.
    pub zeros_mm: Vec<f64>,
    /// Force on the tool in x and y, in N.
    pub push_n: [f64; 2],
    /// An obstacle to the tool: dry friction against its motion, in N.
    pub obstacle_n: f64,
    /// Dry friction on each rotor, in N at the belt. Default 0.
    pub brakes_n: Vec<f64>,
    /// The same on each idler that the plant has, in the order of its stops.
    pub idler_brakes_n: Vec<f64>,
    /// Screws of motors' pulleys that do not hold whatever pulls. Default none.
    pub screws: Vec<Screw>,
}

/// The loose screw of a motor's pulley.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw {
    /// The motor's index.
    pub motor: usize,
    /// Pull of the belt in N, clockwise and counter-clockwise, up to which the pulley does not slip.
    pub most_n: [f64; 2],
}

impl Outside {
    /// Strength of a motor's field.
    #[must_use]
    pub fn strength(&self, motor: usize) -> f64 {
        self.strengths.get(motor).copied().unwrap_or(1.0)
    }

    /// Detent position of a motor, in mm.
    #[must_use]
    pub fn zero_mm(&self, motor: usize) -> f64 {
        self.zeros_mm.get(motor).copied().unwrap_or(0.0)
    }
}
