//! The values of a motor driver that G-code shows and sets: M569, M906, M913, M914.

use crate::gcode::Number;
use crate::machine::numbers::exact;
use crate::settings::DriverSettings;

/// A setting that a command reports or changes for each axis.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::machine) enum DriverValue {
    /// M906.
    Current,
    /// M913.
    HybridThreshold,
    /// M914.
    StallThreshold,
    /// M569.
    Mode,
}

impl DriverValue {
    pub const fn code(self) -> &'static str {
        match self {
            Self::Current => "M906",
            Self::HybridThreshold => "M913",
            Self::StallThreshold => "M914",
            Self::Mode => "M569",
        }
    }

    /// The number that its command takes.
    pub fn number(self, group: &DriverSettings) -> Number {
        match self {
            Self::Current => exact(i32::from(group.current_ma)),
            Self::HybridThreshold => exact(group.hybrid_threshold),
            Self::StallThreshold => exact(i32::from(group.stall_threshold)),
            Self::Mode => exact(i32::from(group.stealth)),
        }
    }
}
