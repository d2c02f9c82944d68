//! Axes: their steps, their reach, their switches, and how they home.

use super::motors::Motors;
use super::toml_of;
use super::work::Work;
use crate::translation::draft::rounded;
use crate::translation::{Kind, Verdict};
use corehbot::settings::ranges::STEP_RATE;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Translates all axes.
pub(super) fn axes(work: &mut Work<'_>, motors: &Motors) {
    for axis in AXES.into_iter().chain(motors.has_extruder.then_some("e")) {
        steps(work, axis, motors);
    }
    for axis in AXES.into_iter().chain(["e"]) {
        speed(work, axis);
    }
    for axis in AXES {
        let end = end(work, axis);
        reach(work, axis, end);
    }
    homing(work);
}

fn steps(work: &mut Work<'_>, axis: &str, motors: &Motors) {
    let (path, word) = (format!("axes.{axis}.steps_per_mm"), axis.to_ascii_uppercase());
    // In inches Marlin divides this number too, although steps an inch are more.
    match work.length("M92", &word).filter(|(_, steps)| *steps > 0.0) {
        Some((entry, steps)) => match shared(work, axis, motors) {
            Some((other, first)) if (first - steps).abs() > 1e-9 * first => {
                let how = format!(", because {other} and {axis} share motors");
                work.approximate(entry, &path, toml_of(first), &how);
            }
            _ => work.take_number(entry, &path, steps),
        },
        None => {
            // The prototype's number would move the machine by wrong distances.
            work.leave_open(&path);
            let text = format!("M92 does not say the steps of {word}: write {path}");
            work.notes.push(Verdict::new(Kind::Decide, text));
        }
    }
}

/// An earlier axis that shares a motor with this one, and its steps: axes that share motors have one resolution.
fn shared(work: &Work<'_>, axis: &str, motors: &Motors) -> Option<(&'static str, f64)> {
    let place = AXES.iter().position(|known| *known == axis)?;
    let other = (0..place).find(|other| motors.share(*other, place))?;
    Some((AXES[other], work.lines.number(&format!("axes.{}.steps_per_mm", AXES[other]))?))
}

/// The speed limit of an axis. Printers may have one that no motor reaches, because nothing asks for it.
fn speed(work: &mut Work<'_>, axis: &str) {
    let (path, steps) = (format!("axes.{axis}.max_speed"), work.lines.number(&format!("axes.{axis}.steps_per_mm")));
    let Some((entry, speed)) = work.length("M203", &axis.to_ascii_uppercase()) else { return };
    let most = steps.map_or(f64::INFINITY, fastest);
    work.take_number(entry, &path, speed.min(most));
    if speed > most {
        work.say(entry, Kind::Approximated, format!("a motor makes {} steps/s at most", STEP_RATE.whole()));
    }
}

/// The speed at which a motor makes as many steps as it may.
fn fastest(steps_per_mm: f64) -> f64 {
    if steps_per_mm > 0.0 { (STEP_RATE.whole() as f64 / steps_per_mm).floor() } else { f64::INFINITY }
}

/// Marlin holds each motor to the limit of its axis, and so does this. One limit is for the motors of x and y.
pub(super) fn motor_limits(work: &mut Work<'_>) {
    for (leaf, path) in [("max_speed", "motor_max_speed"), ("max_acceleration", "motor_max_acceleration")] {
        let numbers = |key: &str| ["x", "y"].map(|axis| work.lines.number(&format!("axes.{axis}.{key}")));
        let most = numbers(leaf).into_iter().flatten().fold(0.0, f64::max);
        let steps = numbers("steps_per_mm").into_iter().flatten().fold(0.0, f64::max);
        let most = if leaf == "max_speed" { most.min(fastest(steps)) } else { most };
        if most > 0.0 {
            work.set_number(path, most, "the higher one of x and y");
        }
    }
}

/// The end at which the switch of an axis sits, and whether the printer said it.
fn end(work: &mut Work<'_>, axis: &str) -> &'static str {
    let switch = |end: &str| work.value("M119", &format!("{axis}_{end}"));
    let (least, most) = (switch("min"), switch("max"));
    let path = format!("homing.{axis}.end");
    let (end, entry) = match (least, most) {
        (Some((entry, _)), None) => ("min", entry),
        (None, Some((entry, _))) => ("max", entry),
        (Some((entry, _)), Some((other, _))) => {
            work.say(entry, Kind::Approximated, "both ends have a switch");
            work.say(other, Kind::Approximated, "both ends have a switch");
            work.fill_in(&[(path, "min".into())], "the end at which the axis homes: it has two switches");
            return "min";
        }
        (None, None) => {
            work.fill_in(&[(path, "min".into())], "the end at which its switch sits");
            return "min";
        }
    };
    work.take(entry, &path, end);
    end
}

/// A length that no printer lacks: nothing runs into an end before the owner fills in the real one.
const SHORT: f64 = 100.0;

/// Where an axis begins and how far it reaches.
fn reach(work: &mut Work<'_>, axis: &str, end: &str) {
    let (min, length) = (format!("axes.{axis}.min"), format!("axes.{axis}.length"));
    let [least, most] = ["Min", "Max"].map(|end| {
        let key = format!("{end} {}", axis.to_ascii_uppercase());
        // M115 says the frame of the machine, and M211 the reach of the moment.
        let all = [work.number("M115", &key), work.number("M211", &key)];
        if let [Some(_), Some((entry, _))] = all {
            work.say(entry, Kind::NotNeeded, "M115 says it");
        }
        all.into_iter().flatten().next()
    });
    let begin = least.map_or(0.0, |(_, least)| least);
    if let Some((entry, least)) = least {
        work.take_number(entry, &min, least);
    }
    match most.filter(|(_, most)| *most > begin) {
        Some((entry, most)) => {
            work.take_number(entry, &length, rounded(most - begin));
            bed(work, axis, begin, most);
        }
        None => work.fill_in(&[(length, toml_of(SHORT))], "how far the axis reaches, in mm: measure it"),
    }
    // Marlin homes to an end of its reach, unless MANUAL_X_HOME_POS and the like say another place.
    if let Some((entry, _)) = if end == "max" { most } else { least } {
        work.say(entry, Kind::Approximated, format!("if the switch sits elsewhere, write homing.{axis}.position"));
    }
}

/// Marlin does not say its bed. Where an axis goes below 0, a switch or a place to wipe is beside the bed, which begins
/// at 0.
fn bed(work: &mut Work<'_>, axis: &str, least: f64, most: f64) {
    let (from, size) = match axis {
        "x" => ("bed.left", "bed.width"),
        "y" => ("bed.front", "bed.depth"),
        _ => return,
    };
    if least < 0.0 && most > 0.0 {
        let keys = [(from.to_owned(), toml_of(0.0)), (size.to_owned(), toml_of(most))];
        work.fill_in(&keys, "the bed, which begins at 0 as a rule");
    }
}

/// Speeds of homing, and the way back in mm: slow, so that a switch which is not noticed costs little.
const HOMING: [(&str, [f64; 3]); 3] = [("x", [20.0, 5.0, 5.0]), ("y", [20.0, 5.0, 5.0]), ("z", [4.0, 1.0, 2.0])];

fn homing(work: &mut Work<'_>) {
    for (axis, [fast, slow, back_off]) in HOMING {
        let key = |leaf: &str, number: f64| (format!("homing.{axis}.{leaf}"), toml_of(number));
        let keys = [key("fast", fast), key("slow", slow), key("back_off", back_off)];
        work.fill_in(&keys, "speeds of homing and the way back: HOMING_FEEDRATE_MM_M / 60, HOMING_BUMP_MM");
    }
}
