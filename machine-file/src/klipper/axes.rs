//! Axes: their reach, their limits, their switches, and how they home.

use super::probe::has_probe;
use super::work::{Work, is_true};
use crate::translation::draft::rounded;
use crate::translation::{Kind, Verdict};
use crate::value::float_toml;
use corehbot_wiring::Circuit;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Translates all axes.
pub(super) fn axes(work: &mut Work<'_>) {
    limits(work);
    for axis in AXES {
        let section = format!("stepper_{axis}");
        if work.config.section(&section).is_none() {
            let text = format!("[{section}] is missing: write axes.{axis}, homing.{axis} and endstops.{axis} yourself");
            work.notes.push(Verdict::new(Kind::Decide, text));
            continue;
        }
        let reach = reach(work, axis, &section);
        homing(work, axis, &section, reach);
        switch(work, axis, &section);
    }
}

/// In a diagonal move a belt motor is faster than the tool by the root of 2.
const DIAGONAL: f64 = 1.4143;

/// Speed and acceleration. Klipper limits the tool; here an axis has a limit, and a belt motor.
fn limits(work: &mut Work<'_>) {
    let is_core = work.value("printer", "kinematics").is_some_and(|(_, name)| name == "corexy");
    let faster = if is_core { "a slanted move may be 8 % above it" } else { "a diagonal may be 41 % above it" };
    for (key, axis_key, motor_key, also, z_key) in [
        ("max_velocity", "max_speed", "motor_max_speed", &[][..], "max_z_velocity"),
        (
            "max_accel",
            "max_acceleration",
            "motor_max_acceleration",
            &["print_acceleration", "travel_acceleration"][..],
            "max_z_accel",
        ),
    ] {
        let Some((entry, most)) = work.number("printer", key) else {
            let text = format!("[printer] {key} is missing: the prototype's limits count");
            work.notes.push(Verdict::new(Kind::Decide, text));
            continue;
        };
        for path in [format!("axes.x.{axis_key}"), format!("axes.y.{axis_key}")] {
            work.take_number(entry, &path, most);
        }
        work.take_number(entry, motor_key, most * DIAGONAL);
        also.iter().for_each(|path| work.take_number(entry, path, most));
        work.say(entry, Kind::Approximated, format!("a limit of each axis: {faster}"));
        let z = format!("axes.z.{axis_key}");
        match work.number("printer", z_key) {
            Some((entry, most)) => work.take_number(entry, &z, most),
            None => {
                // Klipper would let Z be as fast as X.
                let text = format!("[printer] {z_key} is missing: {z} is the prototype's");
                work.notes.push(Verdict::new(Kind::Approximated, text));
            }
        }
    }
    let most = work.number("printer", "max_accel").map(|(_, most)| most);
    if let (Some((entry, decelerate)), Some(most)) = (work.number("printer", "max_accel_to_decel"), most) {
        let ratio = if most > 0.0 { (1.0 - decelerate / most).clamp(0.0, 0.9) } else { 0.5 };
        work.take_number(entry, "minimum_cruise_ratio", ratio);
    }
}

/// The least and the greatest position of an axis; the second as far as it is known.
fn reach(work: &mut Work<'_>, axis: &str, section: &str) -> (f64, Option<f64>) {
    let (min, length) = (format!("axes.{axis}.min"), format!("axes.{axis}.length"));
    let least = match work.number(section, "position_min") {
        Some((entry, least)) => {
            work.take_number(entry, &min, least);
            least
        }
        None => 0.0,
    };
    let Some((entry, most)) = work.number(section, "position_max") else {
        work.leave_open(&length);
        let text = format!("[{section}] has no position_max: write {length}");
        work.notes.push(Verdict::new(Kind::Decide, text));
        return (least, None);
    };
    work.take_number(entry, &length, most - least);
    if least < 0.0 {
        bed(work, axis, least, most);
    }
    (least, Some(most))
}

/// Klipper does not know the bed. Where an axis goes below 0, a switch or a place to wipe is beside the bed, which
/// begins at 0.
fn bed(work: &mut Work<'_>, axis: &str, least: f64, most: f64) {
    let (from, size) = match axis {
        "x" => ("bed.left", "bed.width"),
        "y" => ("bed.front", "bed.depth"),
        _ => return,
    };
    for (path, value) in [(from, 0.0), (size, most)] {
        work.lines.set(path, float_toml(rounded(value)), "from 0 to position_max: correct it if the bed is smaller");
    }
    let text = format!("{axis} reaches from {least}: {from} and {size} are 0 to position_max, as beds begin at 0");
    work.notes.push(Verdict::new(Kind::Approximated, text));
}

/// Klipper's speed of homing, and its way back.
const HOMING_SPEED: f64 = 5.0;
const RETRACT: f64 = 5.0;

fn homing(work: &mut Work<'_>, axis: &str, section: &str, (least, most): (f64, Option<f64>)) {
    let key = |leaf: &str| format!("homing.{axis}.{leaf}");
    let fast = work.number(section, "homing_speed");
    match fast {
        Some((entry, speed)) => work.take_number(entry, &key("fast"), speed),
        None => work.set_default(&key("fast"), HOMING_SPEED),
    }
    match work.number(section, "second_homing_speed") {
        Some((entry, speed)) => work.take_number(entry, &key("slow"), speed),
        None => work.set_default(&key("slow"), fast.map_or(HOMING_SPEED, |(_, speed)| speed) / 2.0),
    }
    match work.number(section, "homing_retract_dist") {
        Some((entry, 0.0)) => {
            work.take_number(entry, &key("back_off"), 1.0);
            work.say(entry, Kind::Approximated, "every axis meets its switch twice");
        }
        Some((entry, distance)) => work.take_number(entry, &key("back_off"), distance),
        None => work.set_default(&key("back_off"), RETRACT),
    }
    let place = work.number(section, "position_endstop");
    let positive = work.value(section, "homing_positive_dir");
    let is_max = match (positive, place, most) {
        (Some((_, text)), ..) => is_true(text),
        (None, Some((_, place)), Some(most)) => place > (least + most) / 2.0,
        (None, ..) => false,
    };
    let end = if is_max { "max" } else { "min" };
    match positive {
        Some((entry, _)) => work.take(entry, &key("end"), end),
        None => work.lines.set(&key("end"), end.into(), "nearest to position_endstop"),
    }
    let Some((entry, place)) = place else {
        let text = format!("[{section}] has no position_endstop: {} is the {end} end of the axis", key("position"));
        return work.notes.push(Verdict::new(Kind::Approximated, text));
    };
    let most = most.unwrap_or(place);
    let middle = (least + most) / 2.0;
    let (from, to) = if is_max { (middle, most + OUTSIDE) } else { (least - OUTSIDE, middle) };
    if (from..=to).contains(&place) {
        work.take_number(entry, &key("position"), place);
    } else {
        let text = format!("{place} is not in the {end} half of the axis, nor up to {OUTSIDE} mm outside");
        work.say(entry, Kind::Decide, text);
        // At its end by default, the tool would be elsewhere than it believes.
        let from = work.from(entry);
        work.lines.set(&key("position"), float_toml(rounded(place)), &from);
    }
}

/// How far outside of its axis a switch may sit, in mm (docs/reference/machines.md, `homing.x.position`).
const OUTSIDE: f64 = 50.0;

fn switch(work: &mut Work<'_>, axis: &str, section: &str) {
    let path = format!("endstops.{axis}");
    let Some((entry, pin)) = work.pin(section, "endstop_pin") else {
        work.lines.set(&path, "".into(), "no endstop_pin");
        let text = format!("[{section}] has no endstop_pin: write the input of its switch into {path}");
        return work.notes.push(Verdict::new(Kind::Decide, text));
    };
    // The usual input must not count for a switch that is elsewhere.
    work.lines.set(&path, "".into(), "to decide");
    match (pin.chip.as_str(), pin.name.as_str()) {
        ("probe", _) if axis == "z" && has_probe(work) => {
            work.lines.set(&path, "".into(), "Z is homed by the probe");
            return work.take(entry, "probe.z_home", true);
        }
        ("probe", _) => {
            let text =
                format!("there is no probe at an input of the board: plug in a switch and write its input into {path}");
            return work.say(entry, Kind::Decide, text);
        }
        (chip, "virtual_endstop") if chip.starts_with("tmc") => {
            let text =
                format!("homing by StallGuard is not there yet: plug in a switch and write its input into {path}");
            return work.say(entry, Kind::Decide, text);
        }
        _ => {}
    }
    if !work.is_here(entry, &pin) {
        return;
    }
    let pins = work.pins;
    match pins.input(&pin, Circuit::Plain) {
        Some(input) => {
            work.take(entry, &path, input.plug(&pin));
            if let Some((kind, text)) = input.of_pull(&pin) {
                work.say(entry, kind, text);
            }
        }
        None => {
            let text = format!(
                "{} is no input of the {}: write the switch's input into {path}",
                pin.name, pins.connectors.name
            );
            work.say(entry, Kind::Decide, text);
        }
    }
}
