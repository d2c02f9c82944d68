//! Heat: heaters with their outputs and sensors.

use super::found::printed;
use super::work::Work;
use crate::translation::{Kind, Verdict};
use corehbot::settings::PLACES;
use corehbot_twin::math::{exp, ln};
use toml::Value as Toml;

/// Klipper's names of sensors, and ours. Those without a row of data of ours are an NTC by resistance and B.
enum Sensor {
    Sheet(&'static str),
    /// B in K of 100 kOhm at 25 C, and how far off it is.
    Beta(i64, &'static str),
}

/// Klipper's sensors (klippy/extras/temperature_sensors.cfg). Those with a row of ours have the same points there. B of
/// the EPCOS follows from its points at 25 and 150 C, B of the TDK from those at 25 and 125 C.
const SENSORS: [(&str, Sensor); 10] = [
    ("ATC Semitec 104GT-2", Sensor::Sheet("104gt2")),
    ("ATC Semitec 104NT-4-R025H42G", Sensor::Sheet("104nt4")),
    ("Generic 3950", Sensor::Sheet("ntc_3950")),
    ("SliceEngineering 450", Sensor::Sheet("slice_450")),
    ("PT1000", Sensor::Sheet("pt1000")),
    ("EPCOS 100K B57560G104F", Sensor::Beta(4148, "right at 25 and 150 C, 7 K high at 250 C")),
    ("TDK NTCG104LH104JT1", Sensor::Beta(4605, "right at 25 and 125 C, 1 K low at 50 C")),
    ("Honeywell 100K 135-104LAG-J01", Sensor::Beta(3974, "")),
    ("NTC 100K beta 3950", Sensor::Beta(3950, "")),
    ("NTC 100K MGB18-104F39050L32", Sensor::Beta(4100, "")),
];

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
        let known = work.value(&section, "sensor_type").is_some_and(|(_, kind)| {
            SENSORS.iter().any(|(known, _)| *known == kind) || config.section(&format!("thermistor {kind}")).is_some()
        });
        if !pin.is_on_board() || work.pins.sensor(&pin.name).is_none() || !known {
            let text = format!("no thermistor of a known kind at an input of the {}", work.pins.connectors.name);
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
    match pins.output(&pin.name) {
        Some(output) => {
            work.take(entry, path, output.name());
            if pin.is_inverted {
                work.say(entry, Kind::Decide, "an output heats while it is high");
            }
            !pin.is_inverted
        }
        None => {
            let (board, offered) = (pins.connectors.name, pins.outputs());
            let text = match printed(pins.connectors, &pin) {
                Some(name) => format!("{name} is not there yet: use one of {offered}, and write it into {path}"),
                None => format!(
                    "{} is no heater output of the {board}: use one of {offered}, and write it into {path}",
                    pin.name
                ),
            };
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
    match pins.sensor(&pin.name) {
        Some(sensor) => {
            work.take(entry, path, sensor.name());
            true
        }
        None => {
            let board = pins.connectors.name;
            let text = match printed(pins.connectors, &pin) {
                Some(name) => format!("{name} is not there yet: use another input, and write it into {path}"),
                None => format!(
                    "{} is no input for a sensor of the {board}: use another, and write it into {path}",
                    pin.name
                ),
            };
            work.say(entry, Kind::Decide, text);
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
            Sensor::Beta(beta, how) => {
                work.take(entry, path, ntc(100_000, *beta));
                if !how.is_empty() {
                    work.say(entry, Kind::Approximated, *how);
                }
            }
        }
        return true;
    }
    match own_thermistor(work, &format!("thermistor {name}")) {
        Some((ohms, beta)) => {
            work.take(entry, path, ntc(ohms, beta));
            work.say(entry, Kind::Approximated, "an NTC by its resistance at 25 C and its B");
            true
        }
        None => {
            let text = format!("not there yet: write a sensor that comes near it into {path}");
            work.say(entry, Kind::Decide, text);
            false
        }
    }
}

fn ntc(ohms: i64, beta: i64) -> Toml {
    Toml::Table(
        [("ohms", ohms), ("beta", beta)].map(|(key, number)| (key.to_owned(), number.into())).into_iter().collect(),
    )
}

/// 0 C in K, and 25 C.
const ZERO: f64 = 273.15;
const ROOM: f64 = ZERO + 25.0;

/// An owner's thermistor as resistance at 25 C and B: by B, or by its first and last point.
fn own_thermistor(work: &mut Work<'_>, section: &str) -> Option<(i64, i64)> {
    work.config.section(section)?;
    let point = |work: &mut Work<'_>, number: usize| {
        let (temperature, c) = work.number(section, &format!("temperature{number}"))?;
        let (resistance, ohms) = work.number(section, &format!("resistance{number}"))?;
        for entry in [temperature, resistance] {
            work.say(entry, Kind::Taken, "the thermistor of a heater");
        }
        Some((1.0 / (c + ZERO), ohms)).filter(|(inverse, ohms)| inverse.is_finite() && *ohms > 0.0)
    };
    let (inverse, ohms) = point(work, 1)?;
    let beta = match work.number(section, "beta") {
        Some((entry, beta)) => {
            work.say(entry, Kind::Taken, "the thermistor of a heater");
            beta
        }
        None => {
            let points = [point(work, 3), point(work, 2)];
            let (other, other_ohms) = points.into_iter().flatten().next()?;
            ln(other_ohms / ohms) / (other - inverse)
        }
    };
    let at_room = ohms * exp(beta * (1.0 / ROOM - inverse));
    let is_one = (1.0..1e8).contains(&at_room) && (1.0..1e5).contains(&beta);
    is_one.then_some((at_room.round() as i64, beta.round() as i64))
}
