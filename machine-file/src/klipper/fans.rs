//! Fans: their outputs, roles and duties.

use super::board::FAN;
use super::defaults::of;
use super::pin::PinText;
use super::work::Work;
use crate::pattern::matches;
use crate::translation::draft::rounded;
use crate::translation::{Kind, Verdict};
use corehbot_wiring::Circuit;

/// Kinds of fans, by their sections, and their roles.
const FANS: [(&str, &str); 4] =
    [("fan", "part"), ("heater_fan *", "hotend"), ("controller_fan *", "controller"), ("fan_generic *", "commanded")];

/// Translates all fans: first the fans at outputs of the board, then the others, which get outputs that are left.
pub(super) fn fans(work: &mut Work<'_>) {
    let config = work.config;
    let names = config.sections.iter().map(|section| section.name.as_str());
    let of = |section: &'_ str| FANS.iter().find(|(pattern, _)| matches(pattern, section)).map(|(_, role)| *role);
    let all: Vec<(&str, &str)> = names.filter_map(|section| Some((section, of(section)?))).collect();
    let number = |work: &Work<'_>, pin: &PinText| work.pins.fan(pin);
    let mut free: Vec<usize> = (0..work.pins.connectors.fans.len()).collect();
    let mut foreign = Vec::new();
    for (section, role) in all {
        let Some((entry, pin)) = work.pin(section, "pin") else { continue };
        match number(work, &pin) {
            Some(output) => {
                free.retain(|other| *other != output);
                fan(work, section, role, output, (entry, &pin));
            }
            None => foreign.push((section, role, entry, pin)),
        }
    }
    for (section, role, entry, pin) in foreign {
        let place = work.pins.elsewhere(&pin, FAN);
        if free.is_empty() {
            work.say(entry, Kind::Decide, format!("{place}, and none is left for it"));
            of_heater(work, section, role);
            continue;
        }
        let output = free.remove(0);
        fan(work, section, role, output, (entry, &pin));
        work.say(
            entry,
            Kind::Decide,
            format!("{place}: plug it in at fan{output}, or move its lines to another output"),
        );
    }
    usual(work);
    for number in free {
        work.lines.set(&format!("fans.fan{number}.role"), "commanded".into(), "no section has it");
    }
}

/// A fan at an output.
fn fan(work: &mut Work<'_>, section: &str, role: &str, output: usize, (entry, pin): (usize, &PinText)) {
    let fan = format!("fans.fan{output}");
    let role = of_heater(work, section, role);
    work.take(entry, &format!("{fan}.role"), role);
    if pin.is_inverted {
        work.say(entry, Kind::Decide, "an output blows while it is high: another fan, or an inverter, has to be there");
    }
    if let Some((entry, seconds)) = work.number(section, "kick_start_time") {
        work.take_number(entry, &format!("{fan}.kick_ms"), seconds * 1000.0);
    }
    most(work, section, &format!("{fan}.most"));
    if let Some((entry, least)) = work.number(section, "off_below") {
        lowest(work, section, entry, least, &fan);
    }
    frequency(work, section, output);
    tachometer(work, section, &fan);
}

/// Klipper's speed is a part of `max_power` (`extras/fan.py`, `set_speed`).
fn most(work: &mut Work<'_>, section: &str, path: &str) {
    let (power, speed) = (work.number(section, "max_power"), work.number(section, "fan_speed"));
    match (power, speed) {
        (Some((entry, power)), Some((other, speed))) => {
            work.take_number(entry, path, power * speed);
            work.say(entry, Kind::Taken, "times fan_speed");
            work.say(other, Kind::Taken, format!("{path} is max_power times it"));
        }
        (Some((entry, number)), None) | (None, Some((entry, number))) => work.take_number(entry, path, number),
        (None, None) => {}
    }
}

/// Klipper's `off_below` is a part of `max_power` too (`extras/fan.py`, `_apply_speed`).
fn lowest(work: &mut Work<'_>, section: &str, entry: usize, least: f64, fan: &str) {
    let power = work.number(section, "max_power").map_or(1.0, |(_, power)| power);
    if work.number(section, "fan_speed").is_some_and(|(_, speed)| speed < least) {
        return work.say(entry, Kind::Decide, "above fan_speed, so Klipper never runs the fan: correct it");
    }
    work.take_number(entry, &format!("{fan}.least"), rounded(least * power));
    if power != 1.0 {
        work.say(entry, Kind::Taken, "times max_power");
    }
    work.say(entry, Kind::Approximated, "the lowest speed has that duty; Klipper switches the fan off below it");
}

/// The role of a fan by its heaters, and the numbers that all fans of a role share.
fn of_heater<'r>(work: &mut Work<'_>, section: &str, role: &'r str) -> &'r str {
    let mut role = role;
    if role == "hotend" {
        if let Some((entry, text)) = work.value(section, "heater") {
            let heaters: Vec<_> = text.split(',').map(str::trim).collect();
            match heaters[..] {
                ["extruder"] => work.say(entry, Kind::Taken, "the role hotend"),
                _ if heaters.contains(&"extruder") => {
                    work.say(entry, Kind::Approximated, "the role hotend follows the hotend, and no other heater");
                }
                _ => {
                    role = "commanded";
                    work.say(entry, Kind::NotYet, "no fan follows this heater: it is commanded (M106 P)");
                }
            }
        }
        match work.number(section, "heater_temp") {
            Some((entry, above)) if role == "hotend" => work.take_number(entry, "thermal.hotend_fan_above", above),
            Some((entry, _)) => work.say(entry, Kind::NotYet, "no fan follows this heater"),
            None => {}
        }
    }
    if role == "controller" {
        if let Some((entry, seconds)) = work.number(section, "idle_timeout") {
            work.take_number(entry, "thermal.fan_run_on_s", seconds);
        }
        for key in ["heater", "stepper"] {
            if let Some((entry, _)) = work.value(section, key) {
                work.say(entry, Kind::Approximated, "it runs with any motor or heater");
            }
        }
    }
    role
}

/// Numbers that all fans of a role share: one without the key has Klipper's default.
fn usual(work: &mut Work<'_>) {
    for (pattern, key, path) in [
        ("heater_fan *", "heater_temp", "thermal.hotend_fan_above"),
        ("controller_fan *", "idle_timeout", "thermal.fan_run_on_s"),
    ] {
        let Some(known) = work.lines.number(path).filter(|known| *known != of(pattern, key)) else { continue };
        let follows = |work: &Work<'_>, section: &str| {
            let heaters = work.value(section, "heater").filter(|_| key == "heater_temp");
            heaters.is_none_or(|(_, heaters)| heaters.split(',').any(|heater| heater.trim() == "extruder"))
        };
        let names = work.config.sections.iter().map(|section| section.name.as_str());
        let silent = names.filter(|name| matches(pattern, name) && work.value(name, key).is_none());
        for section in silent.filter(|name| follows(work, name)).collect::<Vec<_>>() {
            let text = format!(
                "[{section}] has no {key}, so {}, but {path} = {known} from another section, and it is one for both",
                of(pattern, key)
            );
            work.notes.push(Verdict::new(Kind::Decide, text));
        }
    }
}

/// The frequency of a fan, if its output has a timer; of fans on one timer the first one's.
fn frequency(work: &mut Work<'_>, section: &str, number: usize) {
    let Some((entry, seconds)) = work.number(section, "cycle_time").filter(|(_, seconds)| *seconds > 0.0) else {
        return;
    };
    let timers = work.pins.connectors.fans;
    let timer = timers.get(number).copied().flatten();
    if timer.is_none() {
        return work.say(entry, Kind::NotYet, "the frequency of this output is fixed");
    }
    let path = |fan: usize| format!("fans.fan{fan}.frequency");
    let hertz = (1.0 / seconds).round();
    let mut others = timers.iter().enumerate().filter(|(fan, other)| *fan != number && **other == timer);
    let other = others.find_map(|(fan, _)| Some((fan, work.lines.number(&path(fan))?)));
    match other.filter(|(_, its)| *its != hertz) {
        Some((fan, its)) => {
            let text =
                format!("it shares a timer with fan{fan}, and so its {its} Hz: plug it in elsewhere to have another");
            work.say(entry, Kind::Decide, text);
        }
        None => work.take_number(entry, &path(number), hertz),
    }
}

/// The key of all tachometers.
const PULSES: &str = "fans.pulses";

/// The tachometer of a fan.
fn tachometer(work: &mut Work<'_>, section: &str, fan: &str) {
    let Some((entry, pin)) = work.pin(section, "tachometer_pin") else { return };
    if !work.is_here(entry, &pin) {
        return;
    }
    let Some(input) = work.pins.input(&pin, Circuit::Plain) else {
        let text = work.pins.elsewhere(&pin, "input");
        return work.say(entry, Kind::Decide, text);
    };
    work.take(entry, &format!("{fan}.tachometer"), input.name.to_string());
    if let Some((entry, pulses)) = work.number(section, "tachometer_ppr") {
        match work.lines.number(PULSES).filter(|others| *others != pulses) {
            Some(others) => {
                work.say(entry, Kind::Decide, format!("all fans have the same, and an earlier one {others}"))
            }
            None => work.take_number(entry, PULSES, pulses),
        }
    }
    if let Some((entry, _)) = work.value(section, "tachometer_poll_interval") {
        work.say(entry, Kind::NotNeeded, "an input is looked at every 0.5 ms");
    }
}
