//! Where motors and switches of a machine file are plugged in: the name of a connector, with `!` before it for the less usual
//! way round.

use super::MachineFileError;
use super::form::{EndstopsToml, MotorsToml, PlugToml};
use corehbot::connectors::ConnectorName;
use corehbot::motors::Motor;
use corehbot::settings::Settings;

/// Puts what the file says of connectors in the place of the defaults.
pub(super) fn wiring(s: &mut Settings, motors: MotorsToml, endstops: EndstopsToml) -> Result<(), MachineFileError> {
    let w = &mut s.wiring;
    let MotorsToml { m1, m4, m8, m11, z1, z2, e0 } = motors;
    for ((motor, slot), text) in Motor::ALL.into_iter().zip(&mut w.motors).zip([m1, m4, m8, m11, z1, z2, e0]) {
        if let Some(PlugToml(text)) = text {
            (slot.is_reversed, slot.connector) = plug(format!("motors.{}", motor.name()), text)?;
        }
    }
    let EndstopsToml { x, y, z, probe } = endstops;
    let axes = &mut w.endstops;
    let inputs = [("x", &mut axes.x, x), ("y", &mut axes.y, y), ("z", &mut axes.z, z), ("probe", &mut s.probe, probe)];
    for (key, slot, text) in inputs {
        if let Some(PlugToml(text)) = text {
            (slot.is_normally_open, slot.connector) = plug(format!("endstops.{key}"), text)?;
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
