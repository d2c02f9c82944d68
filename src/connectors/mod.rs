//! Connectors: a board's motors, switches, heaters, temperature sensors and fans, by the names printed next to them.
//!
//! A [`Heater`] is a part with a temperature target; settings give its output and its sensor. [`BoardConnectors`] lists
//! a board's connectors. Which pin is behind a name is in `wiring.rs` of the board.

mod board;
mod name;

pub use board::BoardConnectors;
#[cfg(test)]
pub(crate) use board::samples;
pub use name::{ConnectorName, OfConnector};

use serde::{Deserialize, Serialize};

/// A heated part, with its letter in the host protocol.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Heater {
    /// The hotend: T.
    Hotend,
    /// The bed: B.
    Bed,
    /// The chamber: C.
    Chamber,
}

/// Heaters that a machine may have.
pub const HEATERS: usize = 3;

impl Heater {
    /// Every heater.
    pub const ALL: [Self; HEATERS] = [Self::Hotend, Self::Bed, Self::Chamber];

    /// The name that reports print.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hotend => "hotend",
            Self::Bed => "bed",
            Self::Chamber => "chamber",
        }
    }
}

/// A heater output of a board.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Output {
    /// The bed's.
    Bed,
    /// HE0.
    He0,
    /// HE1.
    He1,
    /// HE2.
    He2,
    /// HE3.
    He3,
}

/// Heater outputs that a board may have.
pub const OUTPUTS: usize = 5;

impl Output {
    /// Every output, with the name that reports print.
    pub const ALL: [(Self, &'static str); OUTPUTS] =
        [(Self::Bed, "bed"), (Self::He0, "he0"), (Self::He1, "he1"), (Self::He2, "he2"), (Self::He3, "he3")];

    /// The name that reports print.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(output, _)| *output == self).map_or("", |(_, name)| name)
    }
}

/// A set of heater outputs, one bit each.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutputSet(pub u8);

impl OutputSet {
    /// No output.
    pub const NONE: Self = Self(0);

    /// This set and one output more.
    #[must_use]
    pub const fn with(self, output: Output) -> Self {
        Self(self.0 | 1 << output as u8)
    }

    /// Whether the output is in it.
    #[must_use]
    pub const fn has(self, output: Output) -> bool {
        self.0 & 1 << output as u8 != 0
    }
}

/// A temperature sensor. A new one is a variant, a row of [`ALL`](Self::ALL), and a thermistor in the wiring of a
/// board. The chip limits their number (`MOST_THERMISTORS` in `chips/wiring/src/lib.rs`).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Sensor {
    /// The bed's.
    Bed,
    /// The first hotend's.
    Hotend0,
    /// The second hotend's, or a spare.
    Hotend1,
    /// The third hotend's, or a spare.
    Hotend2,
    /// The fourth hotend's, or a spare.
    Hotend3,
}

/// Temperature sensors that a board may have.
pub const SENSORS: usize = 5;

impl Sensor {
    /// Every sensor, with the name that reports print.
    pub const ALL: [(Self, &'static str); SENSORS] = [
        (Self::Bed, "bed"),
        (Self::Hotend0, "hotend0"),
        (Self::Hotend1, "hotend1"),
        (Self::Hotend2, "hotend2"),
        (Self::Hotend3, "hotend3"),
    ];

    /// The name that reports print.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(sensor, _)| *sensor == self).map_or("", |(_, name)| name)
    }
}

/// Fan outputs that a board may have, FAN0 and so on: the P of M106.
pub const FANS: usize = 6;
