//! Where motors and switches of a machine file are plugged in: the name of a connector, with `!` before it for the less usual
//! way round.

use super::MachineFileError;
use super::form::{EndstopsToml, MotorsToml, PlugToml};
use corehbot::connectors::ConnectorName;
use corehbot::motors::Motor;
use corehbot::settings::Wiring;

/// Puts what the file says of connectors in the place of the defaults.
pub(super) fn wiring(w: &mut Wiring, motors: MotorsToml, endstops: EndstopsToml) -> Result<(), MachineFileError> {
    let MotorsToml { m1, m4, m8, m11, z1, z2, e0 } = motors;
    for ((motor, slot), text) in Motor::ALL.into_iter().zip(&mut w.motors).zip([m1, m4, m8, m11, z1, z2, e0]) {
        if let Some(PlugToml(text)) = text {
            (slot.is_reversed, slot.connector) = plug(format!("motors.{}", motor.name()), text)?;
        }
    }
    let EndstopsToml { x, y, z } = endstops;
    let axes = [("x", &mut w.endstops.x, x), ("y", &mut w.endstops.y, y), ("z", &mut w.endstops.z, z)];
    for (axis, slot, text) in axes {
        if let Some(PlugToml(text)) = text {
            (slot.is_normally_open, slot.connector) = plug(format!("endstops.{axis}"), text)?;
        }
    }
    Ok(())
}

/// Whether it is the other way round, and the connector.
fn plug(key: String, text: String) -> Result<(bool, ConnectorName), MachineFileError> {
    let (is_other_way, name) = text.strip_prefix('!').map_or((false, &*text), |name| (true, name));
    match ConnectorName::new(name) {
        Some(name) if !(is_other_way && name.is_none()) => Ok((is_other_way, name)),
        _ => Err(MachineFileError::Connector { key, value: text }),
    }
}
