//! Steps a millimetre of an axis: as they are, or from what a turn of its motor moves.

use super::MachineFileError;
use super::form::AxisToml;
use super::quantity::{RESOLUTION, put, put_whole, quantity};
use corehbot::motors::MotorSet;
use corehbot::settings::{Range, Settings};
use corehbot::units::StepsPerMm;

/// Full steps a turn: from tin-can motors of 18 degrees to motors of 0.45 degrees.
pub(super) const FULL_STEPS: Range<u16> = Range { least: 20, most: 800 };

/// Full steps of a motor of 1.8 degrees, as most printers have.
const USUAL_FULL_STEPS: u16 = 200;

/// The steps a millimetre of the axis with that number, if the file says anything of them. Drivers and mechanism have been
/// read: their microsteps count.
pub(super) fn resolution(s: &mut Settings, number: usize, file: &AxisToml) -> Result<(), MachineFileError> {
    let (name, now) = match number {
        0 => ("x", s.axes.x.steps_per_mm),
        1 => ("y", s.axes.y.steps_per_mm),
        2 => ("z", s.axes.z.steps_per_mm),
        _ => ("e", s.axes.e.steps_per_mm),
    };
    let key = |key: &str| format!("axes.{name}.{key}");
    let wrong = |at: &str, why| Err(MachineFileError::Resolution { key: key(at), why });
    let mut steps_per_mm = now;
    put(&mut steps_per_mm, &key("steps_per_mm"), file.steps_per_mm, &RESOLUTION)?;
    match (file.rotation_distance, file.steps_per_mm) {
        (None, _) if file.full_steps.is_some() => return wrong("full_steps", "it counts with rotation_distance alone"),
        (None, _) => {}
        (Some(_), Some(_)) => {
            return wrong("rotation_distance", "steps_per_mm is given as well, and one follows from the other");
        }
        (Some(distance), None) => {
            let mut full_steps = USUAL_FULL_STEPS;
            put_whole(&mut full_steps, &key("full_steps"), file.full_steps, FULL_STEPS)?;
            let Some(microsteps) = microsteps(s, number) else {
                return wrong("rotation_distance", "its motors have different microsteps, so say steps_per_mm instead");
            };
            steps_per_mm = turned(&key("rotation_distance"), distance, f64::from(full_steps) * f64::from(microsteps))?;
        }
    }
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
    let motors = s.mechanism.motors_of(axis);
    let groups = [(MotorSet::BELT, s.drivers.belt), (MotorSet::Z, s.drivers.z), (MotorSet::E, s.drivers.e)];
    let mut of_axis = groups.into_iter().filter(|(group, _)| group.intersects(motors)).map(|(_, d)| d.microsteps);
    let first = of_axis.next()?;
    of_axis.all(|other| other == first).then_some(first)
}

/// Steps a millimetre if so many steps turn the motor once.
fn turned(key: &str, distance: f64, steps_a_turn: f64) -> Result<StepsPerMm, MachineFileError> {
    // What is legal is the resolution; the error names the distance, which is what the file has.
    quantity(key, steps_a_turn / distance, &RESOLUTION).map_err(|_| {
        let [least, most] = [RESOLUTION.range.most, RESOLUTION.range.least].map(|r| steps_a_turn / r.to_num::<f64>());
        MachineFileError::Range { key: key.to_owned(), value: distance, legal: format!("{least} to {most}") }
    })
}
