//! Steps a millimetre of an axis: given directly, or by the movement per turn of its motor.

use super::MachineFileError;
use super::keys::{FULL_STEPS, ROTATION_DISTANCE, bits_of, shortest};
use super::reader::Given;
use corehbot::settings::{Settings, ranges};
use corehbot::units::StepsPerMm;

/// Full steps of a motor of 1.8 degrees, as most printers have.
const USUAL_FULL_STEPS: f64 = 200.0;

/// The steps a millimetre of the axis with that number, if the file says anything of them. Drivers and mechanism have
/// been read: their microsteps count.
///
/// # Errors
/// Keys that do not go together, or a distance that gives no legal resolution.
pub(super) fn resolution(s: &mut Settings, number: usize, given: &Given) -> Result<(), MachineFileError> {
    let name = ["x", "y", "z"].get(number).copied().unwrap_or("e");
    let key = |key: &str| format!("axes.{name}.{key}");
    let wrong = |at: &str, why| Err(MachineFileError::Resolution { key: key(at), why });
    let full_steps = given.number(name, FULL_STEPS);
    let Some(distance) = given.number(name, ROTATION_DISTANCE) else {
        return match full_steps {
            Some(_) => wrong(FULL_STEPS, "it counts with rotation_distance alone"),
            None => Ok(()),
        };
    };
    if given.has(&key("steps_per_mm")) {
        return wrong(ROTATION_DISTANCE, "steps_per_mm is given as well, and one follows from the other");
    }
    let Some(microsteps) = microsteps(s, number) else {
        return wrong(ROTATION_DISTANCE, "its motors have different microsteps, so say steps_per_mm instead");
    };
    let steps_a_turn = full_steps.unwrap_or(USUAL_FULL_STEPS) * f64::from(microsteps);
    let steps_per_mm = turned(&key(ROTATION_DISTANCE), distance, steps_a_turn)?;
    match number {
        0 => s.axes.x.steps_per_mm = steps_per_mm,
        1 => s.axes.y.steps_per_mm = steps_per_mm,
        2 => s.axes.z.steps_per_mm = steps_per_mm,
        _ => s.axes.e.steps_per_mm = steps_per_mm,
    }
    Ok(())
}

/// The microsteps of the drivers that move an axis, if they have the same.
fn microsteps(s: &Settings, axis: usize) -> Option<u16> {
    let mut of_axis = s.mechanism.motors_of(axis).iter().map(|motor| s.driver_of(motor).microsteps);
    let first = of_axis.next()?;
    of_axis.all(|other| other == first).then_some(first)
}

/// Steps a millimetre if `steps_a_turn` steps turn the motor once.
fn turned(key: &str, distance: f64, steps_a_turn: f64) -> Result<StepsPerMm, MachineFileError> {
    let (legal, fraction) = (ranges::STEPS_PER_MM.spec().legal, StepsPerMm::FRAC_NBITS);
    match bits_of(steps_a_turn / distance, fraction) {
        Some(bits) if legal.holds(bits) => Ok(StepsPerMm::from_bits(bits as u32)),
        _ => {
            // The resolution has the legal range; the error names the distance, which is the key in the file.
            let [least, most] = [legal.most, legal.least].map(|bits| steps_a_turn / shortest(bits, fraction));
            Err(MachineFileError::Range { key: key.to_owned(), value: distance, legal: format!("{least} to {most}") })
        }
    }
}
