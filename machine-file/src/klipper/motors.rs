//! Motors: Klipper's steppers as rows of the mechanism, with their sockets, drivers and resolutions.

use super::axes::FULL_STEPS;
use super::drivers::{driver, driver_section};
use super::stepper::Stepper;
use super::work::Work;
use crate::translation::draft::rounded;
use crate::translation::{Kind, Verdict};
use corehbot::motors::{MOTORS, MotorName};
use toml::Value as Toml;

/// A kind of kinematics: for each of Klipper's steppers, which axes it moves.
pub(super) struct Kinematics {
    pub name: &'static str,
    /// The rows of `stepper_x`, `stepper_y` and `stepper_z`.
    rows: [[i64; 3]; 3],
}

/// The ones that have a matrix. Klipper's signs: in a CoreXY `stepper_x` is x + y, and `stepper_y` x - y.
pub(super) const KINEMATICS: [Kinematics; 5] = [
    Kinematics { name: "cartesian", rows: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] },
    Kinematics { name: "corexy", rows: [[1, 1, 0], [1, -1, 0], [0, 0, 1]] },
    Kinematics { name: "corexz", rows: [[1, 0, 1], [0, 1, 0], [1, 0, -1]] },
    Kinematics { name: "hybrid_corexy", rows: [[1, -1, 0], [0, 1, 0], [0, 0, 1]] },
    Kinematics { name: "hybrid_corexz", rows: [[1, 0, -1], [0, 1, 0], [0, 0, 1]] },
];

const AXES: [&str; 4] = ["x", "y", "z", "e"];

/// Translates all motors.
pub(super) fn motors(work: &mut Work<'_>) {
    let Some(kinematics) = kinematics(work) else {
        // Without the table the prototype's mechanism would count.
        return work.lines.set("mechanism", Toml::Table(toml::Table::new()), "to decide");
    };
    let steppers = steppers(work, kinematics);
    if steppers.len() > MOTORS {
        // All stay in the file, which is no machine: one screw of four that stands still would bend a gantry.
        let text = format!("{} motors: the firmware drives {MOTORS}", steppers.len());
        work.notes.push(Verdict::new(Kind::Decide, text));
    }
    for (name, stepper) in work.names.iter_mut().zip(&steppers) {
        *name = MotorName::new(&stepper.name).unwrap_or(MotorName::NONE);
    }
    let names: Vec<Toml> = steppers.iter().map(|stepper| stepper.name.as_str().into()).collect();
    work.lines.set("motors.names", Toml::Array(names), "");
    for stepper in &steppers {
        let used = if stepper.row[3] == 0 { 3 } else { 4 };
        let row: Vec<Toml> = stepper.row[..used].iter().map(|times| (*times).into()).collect();
        work.lines.set(&format!("mechanism.{}", stepper.name), Toml::Array(row), &format!("[{}]", stepper.section));
        socket(work, stepper);
        resolution(work, &steppers, stepper);
        driver(work, &steppers, stepper);
    }
}

fn kinematics(work: &mut Work<'_>) -> Option<&'static Kinematics> {
    let Some((entry, name)) = work.value("printer", "kinematics") else {
        let text = "[printer] kinematics is missing: without it there is no mechanism";
        work.notes.push(Verdict::new(Kind::Decide, text));
        return None;
    };
    let found = KINEMATICS.iter().find(|known| known.name == name);
    match found {
        Some(_) => work.say(entry, Kind::Taken, "rows of [mechanism]"),
        None => {
            let names = KINEMATICS.map(|known| known.name).join(", ");
            work.say(entry, Kind::Decide, format!("not there yet; there are {names}"));
        }
    }
    found
}

/// All motors of the axes, then the extruder's.
fn steppers(work: &Work<'_>, kinematics: &Kinematics) -> Vec<Stepper> {
    let mut found = Vec::new();
    for (axis, [x, y, z]) in kinematics.rows.into_iter().enumerate() {
        let first = format!("stepper_{}", AXES[axis]);
        let is_of =
            |name: &&str| name.strip_prefix(&first).is_some_and(|rest| rest.parse::<u8>().is_ok() || rest.is_empty());
        let mut sections: Vec<&str> =
            work.config.sections.iter().map(|section| section.name.as_str()).filter(is_of).collect();
        sections.sort_by_key(|name| (name.len(), *name));
        found.extend(sections.into_iter().map(|section| Stepper {
            section: section.to_owned(),
            name: section.replacen("stepper_", "", 1),
            axis,
            row: [x, y, z, 0],
        }));
    }
    found.push(Stepper { section: "extruder".to_owned(), name: "e0".to_owned(), axis: 3, row: [0, 0, 0, 1] });
    found
}

/// The socket by its pins.
fn socket(work: &mut Work<'_>, stepper: &Stepper) {
    let path = format!("motors.{}", stepper.name);
    let Some((entry, step)) = work.pin(&stepper.section, "step_pin") else {
        let text = format!("[{}] has no step_pin: write the motor's socket into {path}", stepper.section);
        work.notes.push(Verdict::new(Kind::Decide, text));
        work.lines.set(&path, "".into(), "no step_pin");
        return;
    };
    let direction = work.pin(&stepper.section, "dir_pin");
    let sign = if direction.as_ref().is_some_and(|(_, pin)| pin.is_inverted) { "!" } else { "" };
    // What is not the pin is kept: a `!` alone is no socket, so the owner has to decide.
    work.lines.set(&path, sign.into(), "no socket");
    let pins = work.pins;
    let Some(socket) = pins.socket(&step) else {
        let place = pins.elsewhere(&step, "step pin");
        let how = if sign.is_empty() { "" } else { ", behind the `!`, because it turns the other way" };
        work.say(entry, Kind::Decide, format!("{place}: write the motor's socket into {path}{how}"));
        return foreign(work, stepper, &path, sign);
    };
    let driver = driver_section(work, &stepper.section).map(|(section, _)| section);
    let others = [
        (Some(stepper.section.clone()), "dir_pin"),
        (Some(stepper.section.clone()), "enable_pin"),
        (driver, "uart_pin"),
    ];
    let mut is_whole = true;
    for ((section, key), expected) in others.into_iter().zip(&socket.pins[1..]) {
        let Some((entry, pin)) = section.and_then(|section| work.pin(&section, key)) else { continue };
        if expected.as_ref() == Some(&pin.name) && pin.is_on_board() {
            work.say(entry, Kind::Taken, format!("of {}", socket.name));
        } else {
            let expected = expected.as_deref().unwrap_or("no pin");
            let text =
                format!("{} has {expected} there, not {}: is the motor in another socket?", socket.name, pin.name);
            work.say(entry, Kind::Decide, text);
            is_whole = false;
        }
        if key == "enable_pin" && !pin.is_inverted {
            work.say(entry, Kind::NotYet, "drivers are enabled by a low level; one that needs a high one stays off");
        }
    }
    if is_whole {
        work.take(entry, &path, format!("{sign}{}", socket.name));
    } else {
        let text =
            format!("it is the step pin of {}, and other pins are not: write the socket into {path}", socket.name);
        work.say(entry, Kind::Decide, text);
    }
    if step.is_inverted {
        work.say(entry, Kind::Approximated, "a step is the rising edge");
    }
}

/// The other pins of a motor on another board.
fn foreign(work: &mut Work<'_>, stepper: &Stepper, path: &str, sign: &str) {
    if let Some((entry, _)) = work.pin(&stepper.section, "dir_pin") {
        let turns = if sign.is_empty() { "without" } else { "with" };
        work.say(entry, Kind::Taken, format!("{path} is {turns} `!`"));
    }
    let driver = driver_section(work, &stepper.section).map(|(section, _)| section);
    for (section, key) in [(Some(stepper.section.clone()), "enable_pin"), (driver, "uart_pin")] {
        if let Some((entry, _)) = section.and_then(|section| work.pin(&section, key)) {
            work.say(entry, Kind::NotNeeded, "the socket has it");
        }
    }
}

/// Steps a millimetre of its axis, by the movement of a turn, or of a step in older configurations.
fn resolution(work: &mut Work<'_>, steppers: &[Stepper], stepper: &Stepper) {
    let axis = format!("axes.{}", AXES[stepper.axis]);
    let path = format!("{axis}.rotation_distance");
    let gears = work.value(&stepper.section, "gear_ratio").map(|(entry, text)| (entry, ratio(text)));
    match gears {
        Some((entry, Some(_))) => work.say(entry, Kind::Taken, format!("{path} counts it")),
        Some((entry, None)) => work.say(entry, Kind::Decide, "no ratio such as 80:16, 2:1"),
        None => {}
    }
    let gears = gears.map_or(Some(1.0), |(_, ratio)| ratio);
    let (turn, step) =
        (work.number(&stepper.section, "rotation_distance"), work.number(&stepper.section, "step_distance"));
    match (turn, step, gears) {
        (Some((entry, distance)), _, Some(gears)) => {
            same_or_take(work, entry, &path, rounded(distance / gears));
        }
        (None, Some((entry, distance)), _) if distance > 0.0 => {
            same_or_take(work, entry, &format!("{axis}.steps_per_mm"), rounded(1.0 / distance));
        }
        _ => {
            work.leave_open(&path);
            let text = format!("[{}] has no rotation_distance with gears: write {path}", stepper.section);
            work.notes.push(Verdict::new(Kind::Decide, text));
        }
    }
    full_steps(work, steppers, stepper, &format!("{axis}.full_steps"));
    let path = format!("{}.microsteps", stepper.group());
    // Older configurations have it with the driver.
    let of_driver = driver_section(work, &stepper.section).and_then(|(driver, _)| work.number(&driver, "microsteps"));
    match work.number(&stepper.section, "microsteps").or(of_driver) {
        Some((entry, microsteps)) => same_or_take(work, entry, &path, microsteps),
        None => {
            work.leave_open(&path);
            let text = format!("[{}] has no microsteps: write {path}", stepper.section);
            work.notes.push(Verdict::new(Kind::Decide, text));
        }
    }
}

/// Full steps of a turn. Motors of an axis have one number of them, so a motor without the key counts too.
fn full_steps(work: &mut Work<'_>, steppers: &[Stepper], stepper: &Stepper, path: &str) {
    const KEY: &str = "full_steps_per_rotation";
    if let Some((entry, number)) = work.number(&stepper.section, KEY) {
        return same_or_take(work, entry, path, number);
    }
    let mut others = steppers.iter().filter(|other| other.axis == stepper.axis);
    if !others.any(|other| work.value(&other.section, KEY).is_some()) {
        return;
    }
    match work.lines.number(path) {
        None => work.set_default(path, FULL_STEPS),
        Some(FULL_STEPS) => {}
        Some(first) => {
            let text = format!(
                "[{}] has no {KEY}, so {FULL_STEPS}, but another motor has {first}, and {path} holds for both",
                stepper.section
            );
            work.notes.push(Verdict::new(Kind::Decide, text));
            work.leave_open(path);
        }
    }
}

/// Takes a number that all motors of an axis or a group have to share: otherwise they would pull against each other.
fn same_or_take(work: &mut Work<'_>, entry: usize, path: &str, number: f64) {
    match work.lines.number(path) {
        Some(first) if (first - number).abs() > 1e-6 * first.abs() => {
            work.say(entry, Kind::Decide, format!("{path} holds for several motors, and another one has {first}"));
            work.leave_open(path);
        }
        Some(_) => work.say(entry, Kind::Taken, path),
        None => work.take_number(entry, path, number),
    }
}

/// Revolutions of the motor for one of the axis: `80:16, 2:1` is 10.
pub(super) fn ratio(text: &str) -> Option<f64> {
    let pair = |pair: &str| {
        let (a, b) = pair.split_once(':')?;
        let (a, b): (f64, f64) = (a.trim().parse().ok()?, b.trim().parse().ok()?);
        Some(a / b).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
    };
    text.split(',').map(pair).product::<Option<f64>>().filter(|ratio| ratio.is_finite())
}
