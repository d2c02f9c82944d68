//! Drivers of motors: their section, and its keys as settings of a group or of one motor.

use super::stepper::Stepper;
use super::work::{DEFAULT, Work, is_true};
use crate::translation::{Kind, Verdict};
use toml::Value as Toml;

/// The section of a motor's driver, and the driver's name.
pub(super) fn driver_section(work: &Work<'_>, stepper: &str) -> Option<(String, String)> {
    work.config.sections.iter().find_map(|section| {
        let (driver, of) = section.name.split_once(' ')?;
        (driver.starts_with("tmc") && of.trim() == stepper).then(|| (section.name.clone(), driver.to_owned()))
    })
}

/// The driver's settings.
pub(super) fn driver(work: &mut Work<'_>, steppers: &[Stepper], stepper: &Stepper) {
    let Some((section, name)) = driver_section(work, &stepper.section) else {
        let text = format!(
            "[{}] has no [tmc2209 {0}]: its driver must be one, with the current of {}",
            stepper.section,
            stepper.group()
        );
        return work.notes.push(Verdict::new(Kind::Approximated, text));
    };
    if name != "tmc2209" {
        let text = format!("[{section}]: a {} is not there yet: the motor needs a TMC2209", name.to_uppercase());
        return work.notes.push(Verdict::new(Kind::Decide, text));
    }
    let run = work.number(&section, "run_current");
    if let Some((entry, amperes)) = run {
        group(work, entry, stepper, "current_ma", amperes * 1000.0);
    }
    match (work.number(&section, "hold_current"), run) {
        (Some((entry, hold)), Some((_, run))) if run > 0.0 => {
            group(work, entry, stepper, "hold_percent", (100.0 * hold / run).clamp(0.0, 100.0));
        }
        // Without the key it holds with the running current.
        (None, _) => usual(work, &section, stepper, ("hold_current", "hold_percent", 100.0)),
        _ => {}
    }
    let is_said = |work: &Work<'_>, key: &str| {
        let mut others = steppers.iter().filter(|other| other.group() == stepper.group());
        others.any(|other| {
            driver_section(work, &other.section).is_some_and(|(driver, _)| work.value(&driver, key).is_some())
        })
    };
    let threshold = work.number(&section, "stealthchop_threshold");
    if let Some((entry, threshold)) = threshold {
        group_switch(work, entry, stepper, ("stealth", threshold > 0.0), Kind::Decide);
        // Above the fastest move it is stealthChop for ever.
        let limit = if threshold > FASTEST { 0.0 } else { threshold };
        group(work, entry, stepper, "hybrid_threshold", limit);
    } else if is_said(work, "stealthchop_threshold") {
        usual_mode(work, &section, stepper);
    }
    match work.number(&section, "driver_sgthrs") {
        Some((entry, threshold)) => group(work, entry, stepper, "stall_threshold", threshold),
        None if is_said(work, "driver_sgthrs") => {
            usual(work, &section, stepper, ("driver_sgthrs", "stall_threshold", 0.0));
        }
        None => {}
    }
    if let Some((entry, ohms)) = work.number(&section, "sense_resistor") {
        if (ohms - SENSE_OHMS).abs() < 0.0005 {
            work.say(entry, Kind::Taken, "currents are computed for it");
        } else {
            work.say(
                entry,
                Kind::NotYet,
                format!("currents are computed for {SENSE_OHMS} Ohm: scale the current yourself"),
            );
        }
    }
    interpolation(work, &section, stepper);
}

/// Klipper's default for a motor without a key, which another motor of its group may have.
fn usual(work: &mut Work<'_>, section: &str, stepper: &Stepper, (key, leaf, number): (&str, &str, f64)) {
    let path = format!("{}.{leaf}", stepper.group());
    let own = format!("drivers.{}.{leaf}", stepper.name);
    match work.lines.number(&path) {
        None => work.set_default(&path, number),
        Some(_) if work.is_same(&path, number) => {}
        // 0 of a motor alone is its group's.
        Some(_) if number >= 1.0 && work.is_legal(&own, number) => work.set_default(&own, number),
        Some(first) => {
            let text = format!("[{section}] has no {key}, so {number}, but {path} = {first} holds for its group");
            work.notes.push(Verdict::new(Kind::Decide, text));
        }
    }
}

/// Klipper's drivers are in spreadCycle unless they are told a threshold.
fn usual_mode(work: &mut Work<'_>, section: &str, stepper: &Stepper) {
    let path = format!("{}.stealth", stepper.group());
    match work.lines.get(&path).and_then(Toml::as_bool) {
        None => work.lines.set(&path, false.into(), DEFAULT),
        Some(false) => {}
        Some(true) => {
            let text = format!("[{section}] has no stealthchop_threshold, but {path} = true holds for its group");
            work.notes.push(Verdict::new(Kind::Decide, text));
        }
    }
}

/// Klipper's drivers interpolate unless they are told not to.
fn interpolation(work: &mut Work<'_>, section: &str, stepper: &Stepper) {
    let path = format!("{}.interpolate", stepper.group());
    if let Some((entry, text)) = work.value(section, "interpolate") {
        return group_switch(work, entry, stepper, ("interpolate", is_true(text)), Kind::Approximated);
    }
    match work.lines.get(&path).and_then(Toml::as_bool) {
        None => work.lines.set(&path, true.into(), DEFAULT),
        Some(true) => {}
        Some(false) => {
            let text = format!("[{section}] has no interpolate, but {path} = false holds for its group");
            work.notes.push(Verdict::new(Kind::Approximated, text));
        }
    }
}

/// Sense resistors of common modules, in Ohm (docs/explanation/drivers.md).
const SENSE_OHMS: f64 = 0.11;

/// The highest speed of any setting, in mm/s.
const FASTEST: f64 = 3000.0;

/// Takes a number for the drivers of a motor's group, or for the motor alone if another one has set the group's.
fn group(work: &mut Work<'_>, entry: usize, stepper: &Stepper, leaf: &str, number: f64) {
    let path = format!("{}.{leaf}", stepper.group());
    let own = format!("drivers.{}.{leaf}", stepper.name);
    match work.lines.number(&path) {
        Some(_) if work.is_same(&path, number) => work.say(entry, Kind::Taken, path),
        Some(_) if number >= 1.0 && work.is_key(&own) => work.take_number(entry, &own, number),
        Some(first) => {
            let text = format!("{path} = {first} holds for all of these motors, and another one set it");
            work.say(entry, Kind::Decide, text);
        }
        None => work.take_number(entry, &path, number),
    }
}

/// The same with a switch, and how grave it is that the group has another.
fn group_switch(work: &mut Work<'_>, entry: usize, stepper: &Stepper, (leaf, is_on): (&str, bool), other: Kind) {
    let path = format!("{}.{leaf}", stepper.group());
    match work.lines.get(&path).and_then(Toml::as_bool) {
        Some(first) if first != is_on => {
            let text = format!("{path} = {first} holds for all of these motors, and another one set it");
            work.say(entry, other, text);
        }
        Some(_) => work.say(entry, Kind::Taken, path),
        None => work.take(entry, &path, is_on),
    }
}
