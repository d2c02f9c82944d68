//! Heat: heaters with their outputs and sensors.

use super::work::Work;
use crate::amplified;
use crate::thermistor::{of_slope, points, through, written};
use crate::translation::{Kind, Verdict};
use corehbot::settings::{PLACES, Thermistor};
use toml::Value as Toml;

/// Klipper's names of sensors, and ours.
enum Sensor {
    /// A sensor of ours with the same points.
    Sheet(&'static str),
    /// Three points of its data sheet, in C and Ohm.
    Points([(f64, f64); 3]),
    /// B in K of 100 kOhm at 25 C.
    Beta(u16),
}

/// Klipper's sensors (klippy/extras/temperature_sensors.cfg), with its points.
const SENSORS: [(&str, Sensor); 10] = [
    ("ATC Semitec 104GT-2", Sensor::Sheet("104gt2")),
    ("ATC Semitec 104NT-4-R025H42G", Sensor::Sheet("104nt4")),
    ("Generic 3950", Sensor::Sheet("ntc_3950")),
    ("SliceEngineering 450", Sensor::Sheet("slice_450")),
    ("PT1000", Sensor::Sheet("pt1000")),
    ("EPCOS 100K B57560G104F", Sensor::Points([(25.0, 100_000.0), (150.0, 1641.9), (250.0, 226.15)])),
    ("TDK NTCG104LH104JT1", Sensor::Points([(25.0, 100_000.0), (50.0, 31_230.0), (125.0, 2066.0)])),
    ("Honeywell 100K 135-104LAG-J01", Sensor::Beta(3974)),
    ("NTC 100K beta 3950", Sensor::Beta(3950)),
    ("NTC 100K MGB18-104F39050L32", Sensor::Beta(4100)),
];

/// Ohm of the sensors with a B.
const OHMS: u32 = 100_000;

/// Translates heaters and fans.
pub(super) fn heat(work: &mut Work<'_>) {
    heater(work, "hotend", "extruder");
    heater(work, "bed", "heater_bed");
    let is_chamber = |name: &&str| name.starts_with("heater_generic ") && name.to_lowercase().contains("chamber");
    let names = work.config.sections.iter().map(|section| section.name.as_str());
    if let Some(section) = names.into_iter().find(is_chamber) {
        heater(work, "chamber", section);
    }
    extra_sensors(work);
}

/// Klipper's type of the sensor in a processor.
const OF_MCU: &str = "temperature_mcu";

/// Sensors without a heater, in the places that there are: by their names, or else in the first that is left; the main
/// processor's in `board` if no other has that name. One that is neither that nor a thermistor at an input of the board
/// is not reported, which breaks nothing.
fn extra_sensors(work: &mut Work<'_>) {
    let config = work.config;
    let names = config.sections.iter().filter_map(|section| section.name.strip_prefix("temperature_sensor "));
    let mut free: Vec<&str> = PLACES.iter().map(|(place, _)| *place).collect();
    // The chamber's heater has a sensor, which is reported.
    free.retain(|place| *place != "chamber" || work.lines.get("heaters.chamber.is_fitted").is_none());
    let by_name = |name: &str, free: &[&str]| free.iter().position(|place| name.to_lowercase().contains(place));
    let is_mcu = |work: &Work<'_>, section: &str| {
        let of = |key| work.value(section, key).map(|(_, value)| value);
        of("sensor_type") == Some(OF_MCU) && of("sensor_mcu").is_none_or(|mcu| mcu == "mcu")
    };
    // Those with a name of a place first, then the processor's.
    let mut named: Vec<(u8, &str)> = names
        .map(|name| match by_name(name, &free) {
            Some(_) => (0, name),
            None => (if is_mcu(work, &format!("temperature_sensor {name}")) { 1 } else { 2 }, name),
        })
        .collect();
    named.sort_by_key(|(order, _)| *order);
    for (_, name) in named {
        let section = format!("temperature_sensor {name}");
        if is_mcu(work, &section) {
            if !work.pins.connectors.has_mcu_sensor() || free.is_empty() {
                continue;
            }
            let board = free.iter().position(|place| *place == "board");
            let place = free.remove(by_name(name, &free).or(board).unwrap_or(0));
            if let Some((entry, _)) = work.value(&section, "sensor_type") {
                work.take(entry, &format!("sensors.{place}.sensor"), "mcu");
            }
            if let Some((entry, _)) = work.value(&section, "sensor_mcu") {
                work.say(entry, Kind::Taken, "the main board");
            }
            work.lines.set(&format!("sensors.{place}.is_fitted"), true.into(), &section);
            continue;
        }
        let Some((entry, pin)) = work.pin(&section, "sensor_pin") else { continue };
        let kind = work.value(&section, "sensor_type").map(|(_, kind)| kind);
        let known = kind.is_some_and(|kind| {
            SENSORS.iter().any(|(known, _)| *known == kind) || config.section(&format!("thermistor {kind}")).is_some()
        });
        if work.pins.sensor(&pin).is_none() || !known {
            let text = if kind.is_some_and(amplified::is_behind_a_chip) {
                amplified::ABSENT.to_owned()
            } else {
                format!("no thermistor of a known kind at an input of the {}", work.pins.connectors.name)
            };
            work.say(entry, Kind::NotYet, text);
            continue;
        }
        if free.is_empty() {
            continue;
        }
        let place = free.remove(by_name(name, &free).unwrap_or(0));
        let key = |leaf: &str| format!("sensors.{place}.{leaf}");
        let parts = [
            input(work, &key("sensor"), &section),
            sensor_type(work, &key("thermistor"), &section),
            pullup(work, &section),
        ];
        work.lines.set(&key("is_fitted"), parts.into_iter().all(|is_right| is_right).into(), &section);
    }
}

fn heater(work: &mut Work<'_>, name: &str, section: &str) {
    if work.config.section(section).is_none() {
        return;
    }
    let key = |leaf: &str| format!("heaters.{name}.{leaf}");
    let parts = [
        output(work, &key("output"), section),
        input(work, &key("sensor"), section),
        sensor_type(work, &key("thermistor"), section),
        pullup(work, section),
    ];
    // A heater with wrong temperatures must not heat.
    let is_fitted = parts.into_iter().all(|is_right| is_right);
    let why = if is_fitted { section } else { "until its output and its sensor are right" };
    work.lines.set(&key("is_fitted"), is_fitted.into(), why);
    for (from, to) in [("max_temp", "most"), ("max_power", "max_duty")] {
        if let Some((entry, number)) = work.number(section, from) {
            work.take_number(entry, &key(to), number);
        }
    }
    match work.value(section, "control") {
        Some((entry, "pid")) => {
            work.take(entry, &key("control"), "pid");
            for (from, to) in [("pid_kp", "pid.p"), ("pid_ki", "pid.i"), ("pid_kd", "pid.d")] {
                if let Some((entry, number)) = work.number(section, from) {
                    work.take_number(entry, &key(to), number);
                }
            }
        }
        Some((entry, _)) => work.say(entry, Kind::Approximated, "its model controls it: M303 finds out the model"),
        None => {}
    }
    if is_fitted {
        let power = key("power");
        let text = format!("{power}: Klipper has no key for it, so the prototype's counts: set it, then run M303");
        work.notes.push(Verdict::new(Kind::Approximated, text));
    }
}

/// Under the thermistors of every board (boards/*/wiring.rs), and Klipper's default.
const PULLUP_OHMS: f64 = 4700.0;

/// Whether the sensor's temperatures are computed with its resistors.
fn pullup(work: &mut Work<'_>, section: &str) -> bool {
    let mut is_right = true;
    for (key, expected) in [("pullup_resistor", PULLUP_OHMS), ("inline_resistor", 0.0)] {
        let Some((entry, ohms)) = work.number(section, key) else { continue };
        if (ohms - expected).abs() < 1.0 {
            work.say(entry, Kind::Taken, "as on the board");
        } else {
            is_right = false;
            let text =
                format!("temperatures are computed with {expected} Ohm there: use an input of the board as it is");
            work.say(entry, Kind::Decide, text);
        }
    }
    is_right
}

/// The output of a heater; whether the board has it.
fn output(work: &mut Work<'_>, path: &str, section: &str) -> bool {
    let Some((entry, pin)) = work.pin(section, "heater_pin") else { return false };
    if !work.is_here(entry, &pin) {
        return false;
    }
    let pins = work.pins;
    match pins.output(&pin) {
        Some(output) => {
            work.take(entry, path, output.name());
            if pin.is_inverted {
                work.say(entry, Kind::Decide, "an output heats while it is high");
            }
            !pin.is_inverted
        }
        None => {
            let place = match pins.printed(&pin) {
                Some(name) => format!("{name} is not there yet"),
                None => pins.elsewhere(&pin, "heater output"),
            };
            let text = format!("{place}: use one of {}, and write it into {path}", pins.outputs());
            work.say(entry, Kind::Decide, text);
            false
        }
    }
}

/// The input of its sensor; whether the board has it.
fn input(work: &mut Work<'_>, path: &str, section: &str) -> bool {
    let Some((entry, pin)) = work.pin(section, "sensor_pin") else { return false };
    if !work.is_here(entry, &pin) {
        return false;
    }
    let pins = work.pins;
    match pins.sensor(&pin) {
        Some(sensor) => {
            work.take(entry, path, sensor.name());
            true
        }
        None => {
            let place = match pins.printed(&pin) {
                Some(name) => format!("{name} is not there yet"),
                None => pins.elsewhere(&pin, "input for a sensor"),
            };
            work.say(entry, Kind::Decide, format!("{place}: use another input, and write it into {path}"));
            false
        }
    }
}

/// The kind of its sensor; whether it is known.
fn sensor_type(work: &mut Work<'_>, path: &str, section: &str) -> bool {
    let Some((entry, name)) = work.value(section, "sensor_type") else {
        let text = format!("[{section}] has no sensor_type: write the sensor into {path}");
        work.notes.push(Verdict::new(Kind::Decide, text));
        return false;
    };
    if let Some((_, sensor)) = SENSORS.iter().find(|(known, _)| *known == name) {
        match sensor {
            Sensor::Sheet(sheet) => work.take(entry, path, *sheet),
            Sensor::Points(three) => work.take(entry, path, points(*three)),
            Sensor::Beta(beta) => work.take(entry, path, written(OHMS, *beta, 0)),
        }
        return true;
    }
    match own_thermistor(work, &format!("thermistor {name}")) {
        Some(value) => {
            work.take(entry, path, value);
            true
        }
        None => {
            let text = if amplified::is_behind_a_chip(name) {
                amplified::advice(path)
            } else {
                format!("not there yet: write a sensor that comes near it into {path}")
            };
            work.say(entry, Kind::Decide, text);
            false
        }
    }
}

/// An owner's thermistor: by B, or by its three points.
fn own_thermistor(work: &mut Work<'_>, section: &str) -> Option<Toml> {
    work.config.section(section)?;
    let mut entries = Vec::new();
    let mut number = |work: &mut Work<'_>, key: &str| {
        let (entry, number) = work.number(section, key)?;
        entries.push(entry);
        Some(number)
    };
    let mut point = |work: &mut Work<'_>, at: usize| {
        Some((number(work, &format!("temperature{at}"))?, number(work, &format!("resistance{at}"))?))
    };
    let first = point(work, 1)?;
    let value = if work.value(section, "beta").is_some() {
        let (entry, beta) = work.number(section, "beta")?;
        entries.push(entry);
        match of_slope(first, 1.0 / beta)? {
            Thermistor::Beta { ohms, beta, cubic } => written(ohms, beta, cubic),
            Thermistor::Sheet(_) => return None,
        }
    } else {
        let three = [first, point(work, 2)?, point(work, 3)?];
        through(&three)?;
        points(three)
    };
    for entry in entries {
        work.say(entry, Kind::Taken, "the thermistor of a heater");
    }
    Some(value)
}
