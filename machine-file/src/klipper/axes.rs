//! Axes: their reach, their limits, their switches, and how they home.

use super::work::Work;
use crate::translation::draft::rounded;
use crate::translation::{Kind, Verdict};
use crate::value::float_toml;

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
        reach(work, axis, &section);
        homing(work, axis, &section);
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

/// An axis reaches from 0 to its length.
fn reach(work: &mut Work<'_>, axis: &str, section: &str) {
    match work.number(section, "position_max") {
        Some((entry, most)) => work.take_number(entry, &format!("axes.{axis}.length"), most),
        None => {
            let path = format!("axes.{axis}.length");
            work.leave_open(&path);
            let text = format!("[{section}] has no position_max: write {path}");
            work.notes.push(Verdict::new(Kind::Decide, text));
        }
    }
    if let Some((entry, least)) = work.number(section, "position_min") {
        if least < 0.0 {
            work.say(entry, Kind::NotYet, format!("an axis reaches from 0: {least} to 0 cannot be reached"));
        } else if least > 0.0 {
            work.say(
                entry,
                Kind::NotYet,
                format!("an axis reaches from 0: nothing keeps the tool out of 0 to {least}"),
            );
        } else {
            work.say(entry, Kind::Taken, "an axis reaches from 0");
        }
    }
}

/// Klipper's speed of homing, and its way back.
const HOMING_SPEED: f64 = 5.0;
const RETRACT: f64 = 5.0;

fn homing(work: &mut Work<'_>, axis: &str, section: &str) {
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
    let (place, most) = (work.number(section, "position_endstop"), work.number(section, "position_max"));
    let positive = work.value(section, "homing_positive_dir");
    let is_max = match (positive, place, most) {
        (Some((_, text)), ..) => ["true", "1", "yes", "on"].contains(&text.to_lowercase().as_str()),
        (None, Some((_, place)), Some((_, most))) => place > most / 2.0,
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
    let length = most.map_or(place, |(_, most)| most);
    let (least, most) = if is_max { (length / 2.0, length + OUTSIDE) } else { (-OUTSIDE, length / 2.0) };
    if (least..=most).contains(&place) {
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
        ("probe", _) => {
            let text = format!("homing by a probe is not there yet: plug in a switch and write its input into {path}");
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
    match pins.input(&pin.name) {
        Some((name, false)) => work.take(entry, &path, format!("{}{name}", if pin.is_inverted { "!" } else { "" })),
        Some((name, true)) => {
            let text =
                format!("{name} is the probe's connector: plug the switch into another input, write it into {path}");
            return work.say(entry, Kind::Decide, text);
        }
        None => {
            let text = format!(
                "{} is no input of the {}: write the switch's input into {path}",
                pin.name, pins.connectors.name
            );
            return work.say(entry, Kind::Decide, text);
        }
    }
    if pin.is_pulled_down {
        work.say(entry, Kind::NotYet, "inputs are pulled up");
    }
}
