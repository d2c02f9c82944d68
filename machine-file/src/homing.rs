//! Homing in a machine file: speeds, where the switches sit, and the order of the axes.

use super::MachineFileError;
use super::form::{EndToml, HomedAxisToml, HomingToml, HomingsToml};
use super::quantity::{BACK_OFF, SPEED, endstop_position, put};
use corehbot::settings::{AxisEnd, Endstop, HomedAxis, Homing, Settings};
use corehbot::units::Mm;

/// Takes in the table `[homing]`, after the lengths of the axes.
pub(super) fn homing(s: &mut Settings, file: &HomingsToml) -> Result<(), MachineFileError> {
    let lengths = s.axes.map(|axis| axis.length);
    let (h, e) = (&mut s.homing, &mut s.endstops);
    axis(&mut h.x, &mut e.x, "homing.x", lengths.x, &file.x)?;
    axis(&mut h.y, &mut e.y, "homing.y", lengths.y, &file.y)?;
    axis(&mut h.z, &mut e.z, "homing.z", lengths.z, &file.z)?;
    if let Some(order) = file.order {
        s.homing_order = order.map(|axis| match axis {
            HomedAxisToml::X => HomedAxis::X,
            HomedAxisToml::Y => HomedAxis::Y,
            HomedAxisToml::Z => HomedAxis::Z,
        });
    }
    Ok(())
}

fn axis(
    h: &mut Homing,
    endstop: &mut Endstop,
    table: &str,
    length: Mm,
    file: &HomingToml,
) -> Result<(), MachineFileError> {
    put(&mut h.fast, &format!("{table}.fast"), file.fast, &SPEED)?;
    put(&mut h.slow, &format!("{table}.slow"), file.slow, &SPEED)?;
    put(&mut h.back_off, &format!("{table}.back_off"), file.back_off, &BACK_OFF)?;
    match file.end {
        Some(EndToml::Min) => *endstop = Endstop { end: AxisEnd::Min, position: Mm::ZERO },
        Some(EndToml::Max) => *endstop = Endstop { end: AxisEnd::Max, position: length },
        None => {}
    }
    let legal = endstop_position(endstop.end, length);
    put(&mut endstop.position, &format!("{table}.position"), file.position, &legal)
}
