//! A motor of a configuration.

/// A motor.
pub(super) struct Stepper {
    pub section: String,
    pub name: String,
    /// The axis that its resolution belongs to: 0 to 3.
    pub axis: usize,
    pub row: [i64; 4],
}

impl Stepper {
    /// The group of driver settings that holds for it.
    pub const fn group(&self) -> &'static str {
        match self.row {
            [0, 0, 0, _] => "drivers.e",
            [0, 0, _, _] => "drivers.z",
            _ => "drivers.belt",
        }
    }
}
