//! The values of a motor driver that G-code shows and sets: M569, M906, M913, M914.

use crate::gcode::Number;
use crate::machine::numbers::exact;
use crate::settings::DriverSettings;
use core::fmt;

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

/// The value of one axis in Marlin's words.
pub(in crate::machine) struct DriverValueLine<'g>(pub char, pub DriverValue, pub &'g DriverSettings);

impl fmt::Display for DriverValueLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(axis, value, group) = *self;
        let what = match value {
            DriverValue::Current => "driver current",
            DriverValue::HybridThreshold => "stealthChop max speed",
            DriverValue::StallThreshold => "homing sensitivity",
            DriverValue::Mode if group.stealth => return write!(f, "{axis} driver mode: stealthChop"),
            DriverValue::Mode => return write!(f, "{axis} driver mode: spreadCycle"),
        };
        write!(f, "{axis} {what}: {}", value.number(group))
    }
}
