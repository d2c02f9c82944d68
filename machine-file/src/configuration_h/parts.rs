//! Defines that no answer of a printer says: homing, the bed, directions, sensors, the probe.

use super::defines::Defines;
use super::look::Look;
use super::{homing, others};
use crate::marlin::source::ITEM;
use crate::marlin::work::Work;
use crate::thermistor::{points, written};
use crate::translation::Kind;
use corehbot::connectors::BoardConnectors;
use toml::Value as Toml;

/// Marlin's boards (`Marlin/src/core/boards.h`) that are here.
const BOARDS: [(&str, &str); 6] = [
    ("BOARD_BTT_OCTOPUS_V1_0", "octopus"),
    ("BOARD_BTT_OCTOPUS_V1_1", "octopus"),
    ("BOARD_BTT_OCTOPUS_PRO_V1_0", "octopus-pro"),
    ("BOARD_FYSETC_SPIDER", "spider-v1"),
    ("BOARD_FYSETC_SPIDER_V2_1", "spider-v1"),
    ("BOARD_FYSETC_SPIDER_V2_2", "spider"),
];

/// The board that a configuration names.
pub(super) fn board(defines: &Defines) -> Option<&'static BoardConnectors> {
    let name = defines.find("MOTHERBOARD")?.value.as_str();
    let (_, key) = BOARDS.iter().find(|(known, _)| *known == name)?;
    corehbot_boards::called(key)
}

/// What stands before the words of Marlin, which only fill in what is left.
pub(super) fn before(work: &mut Work<'_>, defines: &Defines, board: Option<&'static BoardConnectors>) {
    let mut look = Look { work, defines };
    conflicts(&mut look);
    homing::homing(&mut look);
    bed(&mut look);
    heat(&mut look);
    other_sensors(&mut look);
    homing::probe(&mut look);
    others::before(&mut look, board);
    if look.defines.has("PREVENT_LENGTHY_EXTRUDE") {
        look.take("EXTRUDE_MAXLENGTH", "axes.e.length", 1.0);
        look.say("PREVENT_LENGTHY_EXTRUDE", Kind::Taken, "axes.e.length");
    } else {
        look.say("EXTRUDE_MAXLENGTH", Kind::NotNeeded, "PREVENT_LENGTHY_EXTRUDE is off");
    }
    look.say("CLASSIC_JERK", Kind::Taken, "the jerks below are the rule for corners");
    for (name, path, times) in [
        ("BAUDRATE", "baud", 1.0),
        ("EXTRUDER_AUTO_FAN_TEMPERATURE", "thermal.hotend_fan_above", 1.0),
        ("CONTROLLERFAN_IDLE_TIME", "thermal.fan_run_on_s", 1.0),
        ("CONTROLLERFAN_SECS", "thermal.fan_run_on_s", 1.0),
        ("GRID_MAX_POINTS_X", "mesh.columns", 1.0),
        ("GRID_MAX_POINTS_Y", "mesh.rows", 1.0),
        ("MULTIPLE_PROBING", "probe.samples", 1.0),
        ("Z_CLEARANCE_DEPLOY_PROBE", "probe.deploy_clearance", 1.0),
        ("Z_CLEARANCE_BETWEEN_PROBES", "probe.clearance", 1.0),
        ("DELAY_BEFORE_PROBING", "probe.quiet", 1.0 / 1000.0),
        ("XY_PROBE_FEEDRATE", "probe.travel", 1.0 / 60.0),
        ("XY_PROBE_SPEED", "probe.travel", 1.0 / 60.0),
        ("Z_PROBE_FEEDRATE_FAST", "probe.fast", 1.0 / 60.0),
        ("Z_PROBE_FEEDRATE_SLOW", "probe.slow", 1.0 / 60.0),
        ("Z_PROBE_SPEED_FAST", "probe.fast", 1.0 / 60.0),
        ("Z_PROBE_SPEED_SLOW", "probe.slow", 1.0 / 60.0),
    ] {
        look.take(name, path, times);
    }
}

/// Two values of one name: neither is taken. One that was taken back does not count.
fn conflicts(look: &mut Look<'_, '_, '_>) {
    for (number, define) in look.defines.all.iter().enumerate() {
        let (kind, text) = match (look.defines.undone(number), look.defines.rival(define)) {
            (Some(line), _) => (Kind::NotNeeded, format!("line {line} takes it back")),
            (None, Some(rival)) => {
                (Kind::Decide, format!("line {} says {}: decide", rival.line, crate::short::short(&rival.value)))
            }
            (None, None) => continue,
        };
        // The base word of an item is found by its place among the items.
        let mut words = look.work.said.words.iter().enumerate();
        let entry = words.find(|(_, word)| word.code == ITEM && word.line == number).map(|(entry, _)| entry);
        if let Some(entry) = entry {
            look.work.say(entry, kind, text);
        }
    }
}

/// The bed: its size, and where it begins.
fn bed(look: &mut Look<'_, '_, '_>) {
    let centred = look.defines.has("BED_CENTER_AT_0_0");
    for (name, size, from) in [("X_BED_SIZE", "bed.width", "bed.left"), ("Y_BED_SIZE", "bed.depth", "bed.front")] {
        let Some(number) = look.take(name, size, 1.0) else { continue };
        let begin = if centred { -number / 2.0 } else { 0.0 };
        look.work.set_number(from, begin, if centred { "BED_CENTER_AT_0_0" } else { "Marlin's beds begin at 0" });
    }
    look.say("BED_CENTER_AT_0_0", Kind::Taken, "bed.left and bed.front");
}

/// Marlin's thermistors that are here (`Marlin/src/module/thermistor`, comments of `Configuration.h`).
fn sensor(number: f64) -> Option<(Toml, &'static str)> {
    Some(match number {
        1.0 => (points([(25.0, 100_000.0), (150.0, 1641.9), (250.0, 226.15)]), "EPCOS 100K"),
        5.0 => ("104gt2".into(), "ATC Semitec 104GT-2"),
        11.0 => ("ntc_3950".into(), "Keenovo, B 3950"),
        67.0 => ("slice_450".into(), "Slice Engineering 450"),
        75.0 => (written(100_000, 4100, 0), "Generic silicone heat pad, B 4100"),
        1047.0 => ("pt1000".into(), "PT1000 under 4.7 kOhm"),
        _ => return None,
    })
}

/// Heaters: their sensors and highest temperatures. `HOTEND_OVERSHOOT` lies between the greatest target and the
/// temperature at which Marlin stops (`Configuration.h`).
fn heat(look: &mut Look<'_, '_, '_>) {
    for (heater, of, most, overshoot, usual) in [
        ("hotend", "TEMP_SENSOR_0", "HEATER_0_MAXTEMP", "HOTEND_OVERSHOOT", 15.0),
        ("bed", "TEMP_SENSOR_BED", "BED_MAXTEMP", "BED_OVERSHOOT", 10.0),
        ("chamber", "TEMP_SENSOR_CHAMBER", "CHAMBER_MAXTEMP", "CHAMBER_OVERSHOOT", 10.0),
    ] {
        let Some((entry, number)) = look.number(of) else { continue };
        let path = format!("heaters.{heater}.thermistor");
        if number == 0.0 {
            look.work.say(entry, Kind::NotNeeded, format!("no {heater}"));
            continue;
        }
        match sensor(number) {
            Some((value, name)) => {
                look.work.take(entry, &path, value);
                look.work.say(entry, Kind::Taken, name);
            }
            // Marlin's numbers of amplifiers are below 0 (`Configuration.h`).
            None if number < 0.0 => look.work.say(entry, Kind::Decide, crate::amplified::advice(&path)),
            None => look.work.say(entry, Kind::Decide, format!("not there yet: write a sensor near it into {path}")),
        }
        if let Some((entry, most)) = look.number(most) {
            let path = format!("heaters.{heater}.most");
            look.say(overshoot, Kind::Taken, format!("{path} is less by it"));
            let overshoot = look.defines.of(overshoot).unwrap_or(usual);
            look.work.take_number(entry, &path, most - overshoot);
            look.work.say(entry, Kind::Taken, format!("less its overshoot of {overshoot}"));
        }
    }
    for (name, path) in [
        ("BANG_MAX", ""),
        ("PID_MAX", ""),
        ("MAX_BED_POWER", "heaters.bed.max_duty"),
        ("MAX_CHAMBER_POWER", "heaters.chamber.max_duty"),
    ] {
        match look.number(name) {
            Some((entry, number)) if !path.is_empty() => look.work.take_number(entry, path, number / 255.0),
            Some((entry, 255.0)) => look.work.say(entry, Kind::NotNeeded, "full power"),
            Some((entry, number)) => look.work.take_number(entry, "heaters.hotend.max_duty", number / 255.0),
            None => {}
        }
    }
}

/// Sensors without a heater, and hotends beside the first.
fn other_sensors(look: &mut Look<'_, '_, '_>) {
    for (name, place) in [("TEMP_SENSOR_PROBE", "probe"), ("TEMP_SENSOR_BOARD", "board")] {
        let path = format!("sensors.{place}");
        match look.number(name).map(|(entry, number)| (entry, number, sensor(number))) {
            Some((entry, 0.0, _)) => look.work.say(entry, Kind::NotNeeded, "no such sensor"),
            Some((entry, _, Some((value, text)))) => {
                look.work.take(entry, &format!("{path}.thermistor"), value);
                look.work.say(entry, Kind::Taken, text);
                let keys = [(format!("{path}.is_fitted"), false.into())];
                look.work.fill_in(&keys, &format!("true when {path}.sensor is filled in"));
            }
            Some((entry, ..)) => {
                look.work.say(entry, Kind::NotYet, format!("write a sensor near it into {path}.thermistor"));
            }
            None => {}
        }
    }
    for hotend in 1..8 {
        if let Some((entry, 0.0)) = look.number(&format!("TEMP_SENSOR_{hotend}")) {
            look.work.say(entry, Kind::NotNeeded, "no other hotend");
        }
    }
}
