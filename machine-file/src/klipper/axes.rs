//! Axes: their reach, their limits, their switches, and how they home.

use super::config::Config;
use super::defaults::of;
use super::probe::has_probe;
use super::work::{Work, is_true};
use crate::translation::draft::rounded;
use crate::translation::{Kind, Verdict};
use crate::value::float_toml;
use corehbot::settings::ranges::STEP_RATE;
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
        let z = format!("axes.z.{axis_key}");
        let of_z = work.number("printer", z_key);
        if let Some((entry, most)) = of_z {
            work.take_number(entry, &z, most);
        }
        let Some((entry, most)) = work.number("printer", key) else {
            let text = format!("[printer] {key} is missing or no number: the prototype's limits count");
            work.notes.push(Verdict::new(Kind::Decide, text));
            continue;
        };
        for path in [format!("axes.x.{axis_key}"), format!("axes.y.{axis_key}")] {
            work.take_number(entry, &path, most);
        }
        work.take_number(entry, motor_key, most * DIAGONAL);
        also.iter().for_each(|path| work.take_number(entry, path, most));
        work.say(entry, Kind::Approximated, format!("a limit of each axis: {faster}"));
        // Klipper lets Z be as fast as X.
        if of_z.is_none() {
            work.set_default(&z, most);
        }
    }
    let most = work.number("printer", "max_accel").map(|(_, most)| most);
    if let (Some((entry, decelerate)), Some(most)) = (work.number("printer", "max_accel_to_decel"), most) {
        let ratio = if most > 0.0 { (1.0 - decelerate / most).clamp(0.0, 0.9) } else { 0.5 };
        work.take_number(entry, "minimum_cruise_ratio", ratio);
    }
}

/// What counts for the extruder alone if its keys are missing: the tool's limits, by the ratio of a square of four
/// nozzles' area to the filament's (`kinematics/extruder.py`).
pub(super) fn extruder(work: &mut Work<'_>) {
    let mut of = |key: &str| work.number("extruder", key).map(|(_, number)| number);
    let (Some(nozzle), Some(filament)) = (of("nozzle_diameter"), of("filament_diameter")) else { return };
    let ratio = 4.0 * nozzle * nozzle / (core::f64::consts::PI * filament * filament / 4.0);
    let rows: [(&str, &[&str]); 2] =
        [("max_velocity", &["axes.e.max_speed"]), ("max_accel", &["axes.e.max_acceleration", "retract_acceleration"])];
    for (key, paths) in rows {
        let Some((_, most)) = work.number("printer", key).filter(|_| ratio.is_finite() && ratio > 0.0) else {
            continue;
        };
        for path in paths.iter().filter(|path| work.lines.get(path).is_none()).collect::<Vec<_>>() {
            work.set_default(path, most * ratio);
        }
    }
}

/// Speeds that no motor makes, down to the speed at which it makes as many steps as it may: Klipper's limits may lie
/// far above any speed that a print asks for.
pub(super) fn step_rates(work: &mut Work<'_>) {
    let number = |work: &Work<'_>, path: String| work.lines.number(&path).filter(|number| *number > 0.0);
    let mut finest: f64 = 0.0;
    for axis in ["x", "y", "z", "e"] {
        let group = match axis {
            "x" | "y" => "drivers.belt",
            "z" => "drivers.z",
            _ => "drivers.e",
        };
        let of = |leaf: &str| number(work, format!("axes.{axis}.{leaf}"));
        let turns = of("rotation_distance").zip(number(work, format!("{group}.microsteps")));
        let steps = turns.map(|(distance, micro)| of("full_steps").unwrap_or(FULL_STEPS) * micro / distance);
        let Some(steps) = steps.or_else(|| of("steps_per_mm")) else { continue };
        if group == "drivers.belt" {
            finest = finest.max(steps);
        }
        slow_down(work, &format!("axes.{axis}.max_speed"), steps);
    }
    slow_down(work, "motor_max_speed", finest);
}

/// Full steps of a turn (`stepper.py`, full_steps_per_rotation).
pub(super) const FULL_STEPS: f64 = 200.0;

fn slow_down(work: &mut Work<'_>, path: &str, steps_per_mm: f64) {
    let Some(speed) = work.lines.number(path).filter(|_| steps_per_mm > 0.0) else { return };
    let most = (STEP_RATE.whole() as f64 / steps_per_mm).floor();
    if speed > most {
        work.set_number(path, most, "a motor makes no more steps a second");
        let text = format!("{path} = {most} instead of {speed}: a motor makes {} steps/s at most", STEP_RATE.whole());
        work.notes.push(Verdict::new(Kind::Approximated, text));
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

/// Klipper refuses two places of a switch: outside of its axis, and near no end while nothing says which end. A quarter
/// of the axis is near (`GenericPrinterRail` in `klippy/stepper.py`). The place of a probe is its own.
pub(super) fn refused(config: &Config) -> Option<String> {
    AXES.iter().find_map(|axis| {
        let section = format!("stepper_{axis}");
        let value = |key: &str| config.entries.get(config.find(&section, key)?);
        let number = |key: &str| value(key)?.value.parse::<f64>().ok().filter(|number| number.is_finite());
        let is_probe = value("endstop_pin").is_some_and(|pin| pin.value.contains("probe:"));
        let (place, most) = (number("position_endstop").filter(|_| !is_probe)?, number("position_max")?);
        let least = number("position_min").unwrap_or(0.0);
        let near = (most - least) / 4.0;
        let is_max = value("homing_positive_dir").map(|entry| is_true(&entry.value));
        let why = match is_max {
            _ if place < least || place > most => format!("it is not from {least} to {most}"),
            None if place > least + near && place < most - near => {
                "it is near neither end of the axis: say homing_positive_dir".to_owned()
            }
            Some(true) if place == least => "it is the low end, and homing_positive_dir says the high one".to_owned(),
            Some(false) if place == most => "it is the high end, and homing_positive_dir says the low one".to_owned(),
            _ => return None,
        };
        let at = config.place(value("position_endstop")?.at);
        Some(format!("{at}: error: [{section}] position_endstop = {place}: {why}"))
    })
}

fn homing(work: &mut Work<'_>, axis: &str, section: &str, (least, most): (f64, Option<f64>)) {
    let key = |leaf: &str| format!("homing.{axis}.{leaf}");
    let fast = work.number(section, "homing_speed");
    match fast {
        Some((entry, speed)) => work.take_number(entry, &key("fast"), speed),
        None => work.set_default(&key("fast"), of(section, "homing_speed")),
    }
    match work.number(section, "second_homing_speed") {
        Some((entry, speed)) => work.take_number(entry, &key("slow"), speed),
        None => work.set_default(&key("slow"), fast.map_or(of(section, "homing_speed"), |(_, speed)| speed) / 2.0),
    }
    match work.number(section, "homing_retract_dist") {
        Some((entry, 0.0)) => {
            work.take_number(entry, &key("back_off"), 1.0);
            work.say(entry, Kind::Approximated, "every axis meets its switch twice");
        }
        Some((entry, distance)) => work.take_number(entry, &key("back_off"), distance),
        None => work.set_default(&key("back_off"), of(section, "homing_retract_dist")),
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
            for (key, ours) in [("homing_speed", "probe.fast"), ("second_homing_speed", "probe.slow")] {
                if let Some((entry, _)) = work.value(section, key) {
                    let text = format!("{ours} is the speed of the probe's touches, from its own key");
                    work.say(entry, Kind::Approximated, text);
                }
            }
            work.lines.set(&path, "".into(), "Z is homed by the probe");
            return work.take(entry, "probe.z_home", true);
        }
        ("probe", _) => {
            let text = format!("there is no probe with a contact: plug in a switch and write its input into {path}");
            return work.say(entry, Kind::Decide, text);
        }
        (chip, "virtual_endstop") if chip.starts_with("tmc") => {
            let text =
                format!("homing by StallGuard is not there yet: plug in a switch and write its input into {path}");
            return work.say(entry, Kind::Decide, text);
        }
        _ => {}
    }
    match work.pins.input(&pin, Circuit::Plain) {
        Some(input) => {
            work.take(entry, &path, input.plug(&pin));
            if let Some((kind, text)) = input.of_pull(&pin) {
                work.say(entry, kind, text);
            }
        }
        None => work.foreign_input(entry, &pin, &path),
    }
}
