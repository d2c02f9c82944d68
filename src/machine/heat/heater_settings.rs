//! Words that several commands about heaters have.

use crate::connectors::Heater;
use crate::gcode::{Number, TableCommand};

/// The heater of E: 0 or none is the hotend, -1 the bed, -2 the chamber.
pub(in crate::machine) fn heater_of(command: &TableCommand<'_>) -> Option<Heater> {
    match command.number(b'E').map_or(0, Number::to_int) {
        0 => Some(Heater::Hotend),
        -1 => Some(Heater::Bed),
        -2 => Some(Heater::Chamber),
        _ => None,
    }
}
