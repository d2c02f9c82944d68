//! The room around the machine.

use crate::units::Celsius;

/// The room temperature that models assume; another temperature shows as a drift.
pub const ROOM: Celsius = Celsius::const_from_int(25);
