//! The probe, the input of a filament sensor, and input shapers.

use super::defaults::of;
use super::work::{DEFAULT, Work};
use crate::translation::Kind;
use corehbot_wiring::Circuit;

/// Sections of probes with an input, and its key.
const PROBES: [(&str, &str); 3] = [("probe", "pin"), ("bltouch", "sensor_pin"), ("smart_effector", "pin")];

/// Numbers of a probe, ours, and how ours counts.
const NUMBERS: [(&str, &str, f64); 8] = [
    ("x_offset", "probe.offset.x", 1.0),
    ("y_offset", "probe.offset.y", 1.0),
    ("z_offset", "probe.offset.z", -1.0),
    ("speed", "probe.slow", 1.0),
    ("speed", "probe.fast", 1.0),
    ("samples", "probe.samples", 1.0),
    ("samples_tolerance", "probe.tolerance", 1.0),
    ("samples_tolerance_retries", "probe.retries", 1.0),
];

/// Whether a section is a probe.
pub(super) fn is_probe(section: &str) -> bool {
    PROBES.iter().any(|(probe, _)| *probe == section)
}

/// The probe's place minus the nozzle's, in x and y, wherever its pin is.
pub(super) fn offset(work: &Work<'_>) -> [f64; 2] {
    let section = PROBES.iter().find(|(section, _)| work.config.section(section).is_some());
    ["x_offset", "y_offset"].map(|key| {
        let value = section.and_then(|(section, _)| work.value(section, key));
        value.and_then(|(_, text)| text.parse().ok()).unwrap_or(0.0)
    })
}

/// Whether the configuration has a probe with a contact, wherever its pin is.
pub(super) fn has_probe(work: &Work<'_>) -> bool {
    PROBES.into_iter().any(|(section, key)| work.value(section, key).is_some())
}

/// Translates the probe.
pub(super) fn probe(work: &mut Work<'_>) {
    for (section, key) in PROBES {
        let Some((entry, pin)) = work.pin(section, key) else { continue };
        let kind = match section {
            "bltouch" => "bltouch",
            "smart_effector" => "nozzle",
            _ => "switch",
        };
        // A BLTouch has a header of its own, without the optocoupler of the header for other sensors.
        let usual = if section == "bltouch" { Circuit::Plain } else { Circuit::Optocoupler };
        match work.pins.input(&pin, usual) {
            Some(input) => {
                work.take(entry, "endstops.probe", input.plug(&pin));
                work.take(entry, "probe.kind", kind);
                if let Some((kind, text)) = input.of_pull(&pin) {
                    work.say(entry, kind, text);
                }
            }
            None => {
                // What is not the pin is kept.
                work.take(entry, "probe.kind", kind);
                work.foreign_input(entry, &pin, "endstops.probe");
            }
        }
        for (key, to, times) in NUMBERS {
            if let Some((entry, number)) = work.number(section, key) {
                work.take_number(entry, to, number * times);
            }
        }
        clearance(work, section);
        result(work, section);
    }
}

/// Sections in which Klipper's probe goes from point to point at a height of its own.
const LEVELLING: [&str; 5] = ["bed_mesh", "z_tilt", "z_tilt_ng", "quad_gantry_level", "screws_tilt_adjust"];

/// One distance is between touches and from place to place here: the greatest of Klipper's.
fn clearance(work: &mut Work<'_>, section: &str) {
    const PATH: &str = "probe.clearance";
    let retract = work.number(section, "sample_retract_dist");
    let mut distances = vec![retract];
    for section in LEVELLING.into_iter().filter(|section| work.config.section(section).is_some()) {
        distances.push(work.number(section, "horizontal_move_z"));
    }
    let defaults = [of("probe", "sample_retract_dist"), of("bed_mesh", "horizontal_move_z")];
    let each = distances.iter().enumerate().map(|(at, found)| found.map_or(defaults[at.min(1)], |(_, number)| number));
    let most = each.fold(0.0, f64::max);
    work.set_default(PATH, most);
    let is_alone = distances.len() == 1;
    for (entry, number) in distances.into_iter().flatten() {
        if number == most && is_alone {
            work.take_number(entry, PATH, number);
        } else {
            work.say(entry, Kind::Approximated, format!("{PATH} = {most}, the greatest height between two touches"));
        }
    }
}

/// How touches become a height.
fn result(work: &mut Work<'_>, section: &str) {
    match work.value(section, "samples_result") {
        Some((entry, "average")) => work.say(entry, Kind::Taken, "the mean counts"),
        Some((entry, _)) => work.say(entry, Kind::Approximated, "the mean counts, not the median"),
        None => {}
    }
}

/// Translates a filament sensor with a switch: so far its input is reported, and nothing more.
pub(super) fn filament(work: &mut Work<'_>) {
    let sections = work.config.sections.iter().map(|section| section.name.as_str());
    for section in sections.filter(|name| name.starts_with("filament_switch_sensor ")) {
        let Some((entry, pin)) = work.pin(section, "switch_pin") else { continue };
        let is_first = work.lines.get("endstops.filament").is_none();
        let input = work.pins.input(&pin, Circuit::Plain).filter(|_| is_first);
        let Some(input) = input else {
            let text = format!("no input of the {}, or a second sensor", work.pins.connectors.name);
            work.say(entry, Kind::NotYet, text);
            continue;
        };
        work.take(entry, "endstops.filament", input.plug(&pin));
        work.say(entry, Kind::Approximated, "M119 reports it, and nothing stops at the end of the filament so far");
        if let Some((kind, text)) = input.of_pull(&pin) {
            work.say(entry, kind, text);
        }
    }
}

/// Klipper's shapers and ours.
const SHAPERS: [(&str, &str); 6] =
    [("zv", "zv"), ("mzv", "mzv"), ("zvd", "zvd"), ("ei", "ei"), ("2hump_ei", "2hump_ei"), ("3hump_ei", "2hump_ei")];

/// Translates input shapers.
pub(super) fn shapers(work: &mut Work<'_>) {
    const SECTION: &str = "input_shaper";
    for axis in ["x", "y"] {
        let path = format!("shaper.{axis}.kind");
        match work.number(SECTION, &format!("shaper_freq_{axis}")) {
            Some((entry, frequency)) if frequency > 0.0 => {
                work.take_number(entry, &format!("shaper.{axis}.frequency"), frequency);
            }
            Some((entry, _)) => {
                work.take(entry, &path, "none");
                continue;
            }
            None => continue,
        }
        let own = work.value(SECTION, &format!("shaper_type_{axis}"));
        match own.or_else(|| work.value(SECTION, "shaper_type")) {
            Some((entry, name)) => match SHAPERS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
                Some((_, ours)) => {
                    work.take(entry, &path, *ours);
                    if !ours.eq_ignore_ascii_case(name) {
                        work.say(entry, Kind::Approximated, "the nearest there is");
                    }
                }
                None => {
                    // A frequency without a kind would shape with another one.
                    work.lines.set(&path, "none".into(), "to decide");
                    work.say(entry, Kind::Decide, "no such shaper: choose one of M593");
                }
            },
            None => work.lines.set(&path, "mzv".into(), DEFAULT),
        }
        if let Some((entry, ratio)) = work.number(SECTION, &format!("damping_ratio_{axis}")) {
            work.take_number(entry, &format!("shaper.{axis}.damping"), ratio);
        }
    }
}
