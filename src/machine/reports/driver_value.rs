//! The values of a motor driver that G-code shows and sets: M569, M906, M913, M914.

use crate::gcode::Number;
use crate::machine::numbers::exact;
use crate::port::Motor;
use crate::settings::{DriverSettings, Settings};

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

    /// The numbers of the fitted motors that have their own.
    pub fn of_motors(self, s: &Settings) -> impl Iterator<Item = (Motor, Number)> {
        let own = move |motor: Motor| {
            let own = s.drivers.own(motor);
            let number = match self {
                Self::Current => own.current_ma,
                Self::StallThreshold => own.stall_threshold.into(),
                Self::HybridThreshold | Self::Mode => 0,
            };
            (number != 0).then(|| (motor, Number::from(i32::from(number))))
        };
        s.mechanism.fitted().iter().filter_map(own)
    }
}
