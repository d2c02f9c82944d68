//! The room around the machine.

use crate::units::Celsius;

/// The room temperature that models assume; another temperature shows as a drift.
pub const ROOM: Celsius = Celsius::const_from_int(25);

/// The coldest room in which a machine heats: the default of Marlin's HEATER_0_MINTEMP (Configuration.h, 2.1).
pub const COLDEST_ROOM: Celsius = Celsius::const_from_int(5);
