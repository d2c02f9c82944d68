//! The room that the machine stands in.

use crate::units::Celsius;

/// The room's temperature that models assume; what a warmer or colder room makes of it is a drift.
pub const ROOM: Celsius = Celsius::const_from_int(25);
