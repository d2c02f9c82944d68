//! Words that several commands about heaters have.

use crate::connectors::Heater;
use crate::gcode::{Number, OwnCommand};

/// The heater of E: 0 or none is the hotend, -1 the bed, -2 the chamber.
pub(super) fn heater_of(command: &OwnCommand<'_>) -> Option<Heater> {
    match command.number(b'E').map_or(0, Number::to_int) {
        0 => Some(Heater::Hotend),
        -1 => Some(Heater::Bed),
        -2 => Some(Heater::Chamber),
        _ => None,
    }
}
