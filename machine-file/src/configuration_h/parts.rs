//! Defines that no answer of a printer says: homing, the bed, directions, sensors, the probe.

use super::defines::Defines;
use crate::marlin::Given;
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

/// The work on one define: its entry, and its numbers.
struct Look<'w, 'd, 's> {
    work: &'w mut Work<'s>,
    defines: &'d Defines,
}

impl Look<'_, '_, '_> {
    fn entry(&self, name: &str) -> Option<usize> {
        self.defines.find(name)?;
        self.work.said.find(ITEM, name)
    }

    fn number(&mut self, name: &str) -> Option<(usize, f64)> {
        let entry = self.entry(name)?;
        match self.defines.of(name) {
            Some(number) => Some((entry, number)),
            None => {
                self.work.say(entry, Kind::Decide, "its value is not known here: write it yourself");
                None
            }
        }
    }

    fn take(&mut self, name: &str, path: &str, times: f64) -> Option<f64> {
        let (entry, number) = self.number(name)?;
        self.work.take_number(entry, path, number * times);
        Some(number)
    }

    fn say(&mut self, name: &str, kind: Kind, text: impl Into<String>) {
        if let Some(entry) = self.entry(name) {
            self.work.say(entry, kind, text);
        }
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// What stands before the words of Marlin, which only fill in what is left.
pub(super) fn before(work: &mut Work<'_>, defines: &Defines) {
    let mut look = Look { work, defines };
    conflicts(&mut look);
    homing(&mut look);
    bed(&mut look);
    heat(&mut look);
    probe(&mut look);
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
        ("GRID_MAX_POINTS_X", "mesh.columns", 1.0),
        ("GRID_MAX_POINTS_Y", "mesh.rows", 1.0),
        ("MULTIPLE_PROBING", "probe.samples", 1.0),
        ("Z_CLEARANCE_DEPLOY_PROBE", "probe.deploy_clearance", 1.0),
        ("Z_CLEARANCE_BETWEEN_PROBES", "probe.clearance", 1.0),
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

/// Speeds of homing, the way back, and where a switch sits.
fn homing(look: &mut Look<'_, '_, '_>) {
    let of = |look: &Look<'_, '_, '_>, name: &str, axis: usize| look.defines.list(name).get(axis).copied().flatten();
    for (axis, name) in AXES.into_iter().enumerate() {
        let key = |leaf: &str| format!("homing.{name}.{leaf}");
        let fast = of(look, "HOMING_FEEDRATE_MM_M", axis).map(|speed| speed / 60.0).or_else(|| {
            let old = if axis == 2 { "HOMING_FEEDRATE_Z" } else { "HOMING_FEEDRATE_XY" };
            look.defines.of(old).map(|speed| speed / 60.0)
        });
        let source = ["HOMING_FEEDRATE_MM_M", if axis == 2 { "HOMING_FEEDRATE_Z" } else { "HOMING_FEEDRATE_XY" }];
        let source = source.into_iter().find_map(|name| look.entry(name));
        if let (Some(entry), Some(fast)) = (source, fast) {
            look.work.take_number(entry, &key("fast"), fast);
            if let (Some(entry), Some(divisor)) =
                (look.entry("HOMING_BUMP_DIVISOR"), of(look, "HOMING_BUMP_DIVISOR", axis).filter(|by| *by > 0.0))
            {
                look.work.take_number(entry, &key("slow"), fast / divisor);
            }
        }
        if let (Some(entry), Some(bump)) = (look.entry("HOMING_BUMP_MM"), of(look, "HOMING_BUMP_MM", axis)) {
            if bump > 0.0 {
                look.work.take_number(entry, &key("back_off"), bump);
            } else {
                look.work.say(entry, Kind::Approximated, format!("{name} meets its switch twice"));
            }
        }
        let manual = format!("MANUAL_{}_HOME_POS", name.to_ascii_uppercase());
        look.take(&manual, &key("position"), 1.0);
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
    for (name, path) in [("BANG_MAX", ""), ("PID_MAX", ""), ("MAX_BED_POWER", "heaters.bed.max_duty")] {
        match look.number(name) {
            Some((entry, number)) if !path.is_empty() => look.work.take_number(entry, path, number / 255.0),
            Some((entry, 255.0)) => look.work.say(entry, Kind::NotNeeded, "full power"),
            Some((entry, number)) => look.work.take_number(entry, "heaters.hotend.max_duty", number / 255.0),
            None => {}
        }
    }
}

/// Kinds of probes.
const PROBES: [(&str, &str); 4] = [
    ("BLTOUCH", "bltouch"),
    ("FIX_MOUNTED_PROBE", "switch"),
    ("Z_PROBE_SERVO_NR", "switch"),
    ("NOZZLE_AS_PROBE", "nozzle"),
];

/// The probe, and the place where Z is homed by it.
fn probe(look: &mut Look<'_, '_, '_>) {
    for (name, kind) in PROBES {
        // A number of a servo is no switch.
        let is_on = look.defines.has(name) || (name == "Z_PROBE_SERVO_NR" && look.defines.find(name).is_some());
        if let Some(entry) = look.entry(name).filter(|_| is_on) {
            if look.work.lines.get("probe.kind").is_none() {
                look.work.take(entry, "probe.kind", kind);
                let keys = [("endstops.probe".to_owned(), "".into())];
                look.work.fill_in(&keys, "the input of the probe");
            }
            if name == "Z_PROBE_SERVO_NR" {
                look.work.say(entry, Kind::NotYet, "no servo but a BLTouch's");
            }
        }
    }
    let has_probe = look.work.lines.get("probe.kind").is_some();
    for name in ["USE_PROBE_FOR_Z_HOMING", "Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN"] {
        if let Some(entry) = look.entry(name).filter(|_| has_probe && look.defines.has(name)) {
            look.work.take(entry, "probe.z_home", true);
        }
    }
    let by_probe = look.work.lines.get("probe.z_home").is_some();
    for (name, axis, [from, size]) in [
        ("Z_SAFE_HOMING_X_POINT", "x", ["bed.left", "bed.width"]),
        ("Z_SAFE_HOMING_Y_POINT", "y", ["bed.front", "bed.depth"]),
    ] {
        let (path, switch) = (format!("probe.home.{axis}"), format!("safe_z_home.{axis}"));
        if !look.defines.has("Z_SAFE_HOMING") {
            continue;
        }
        let is_centre = look.defines.find(name).is_some_and(|define| define.value.contains("_CENTER"));
        match look.entry(name) {
            Some(entry) if is_centre && by_probe => {
                look.work.take(entry, &path, "auto");
                look.work.say(entry, Kind::Taken, "the middle of the bed");
            }
            // Marlin takes the probe there (`Marlin/src/gcode/calibrate/G28.cpp`, home_z_safely).
            Some(_) if by_probe => drop(look.take(name, &path, 1.0)),
            Some(entry) if is_centre => match [from, size].map(|key| look.work.lines.number(key)) {
                [begin, Some(size)] => {
                    look.work.take_number(entry, &switch, begin.unwrap_or(0.0) + size / 2.0);
                    look.work.say(entry, Kind::Taken, "the middle of the bed");
                }
                [_, None] => look.work.say(entry, Kind::Decide, "the middle of a bed without a size: correct it"),
            },
            Some(_) => drop(look.take(name, &switch, 1.0)),
            None => {}
        }
    }
    look.say("Z_SAFE_HOMING", Kind::Taken, "Z homes at its place");
}

/// What needs the names and plugs of motors and switches.
pub(super) fn after(work: &mut Work<'_>, defines: &Defines, given: Given) {
    let mut look = Look { work, defines };
    if let Some(entry) = look.entry("MOTHERBOARD") {
        let name = look.defines.find("MOTHERBOARD").map_or("", |define| define.value.as_str());
        let of_file = board(look.defines).map(|board| board.key);
        match (of_file, given.board) {
            (Some(key), Some(board)) if key == board.key => {
                look.work.say(entry, Kind::Taken, format!("board = {key:?}"))
            }
            (_, Some(board)) => look.work.say(entry, Kind::NotNeeded, format!("--board names the {}", board.name)),
            (_, None) => {
                let text = format!("{name} is not supported: --board names the board that the machine gets");
                look.work.say(entry, Kind::Decide, text);
            }
        }
    }
    for motor in ["X", "Y", "Z", "E0"] {
        let (name, path) = (format!("INVERT_{motor}_DIR"), format!("motors.{}", motor.to_ascii_lowercase()));
        turned(&mut look, &name, &path);
        drivers(&mut look, motor);
    }
    for axis in ["X", "Y", "Z"] {
        let end = if look.defines.of(&format!("{axis}_HOME_DIR")).is_some_and(|dir| dir > 0.0) { "MAX" } else { "MIN" };
        let path = format!("endstops.{}", axis.to_ascii_lowercase());
        for other in ["MIN", "MAX"] {
            for leaf in ["ENDSTOP_INVERTING", "ENDSTOP_HIT_STATE"] {
                let name = format!("{axis}_{other}_{leaf}");
                if other == end {
                    contact(&mut look, &name, &path);
                } else {
                    look.say(&name, Kind::NotNeeded, "no switch there homes the axis");
                }
            }
        }
    }
    for name in ["Z_MIN_PROBE_ENDSTOP_INVERTING", "Z_MIN_PROBE_ENDSTOP_HIT_STATE"] {
        contact(&mut look, name, "endstops.probe");
    }
}

/// A direction: `!` in front of the socket.
fn turned(look: &mut Look<'_, '_, '_>, name: &str, path: &str) {
    if look.defines.find(name).is_none() || look.work.lines.get(path).is_none() {
        return;
    }
    mark(look, name, path, look.defines.has(name));
}

/// A contact: Marlin's level of a switch that has triggered. With `inverting`, or a low one, it closes to ground.
fn contact(look: &mut Look<'_, '_, '_>, name: &str, path: &str) {
    let Some(define) = look.defines.find(name) else { return };
    let closes = define.value == "LOW" || look.defines.has(name);
    let closes = if name.ends_with("HIT_STATE") { define.value == "LOW" } else { closes };
    if look.work.lines.get(path).is_some() {
        mark(look, name, path, closes);
    }
}

/// Puts `!` in front of a connector, or of the place for it.
fn mark(look: &mut Look<'_, '_, '_>, name: &str, path: &str, is_marked: bool) {
    let plug = look.work.lines.get(path).and_then(Toml::as_str).unwrap_or_default().to_owned();
    let Some(entry) = look.entry(name) else { return };
    let is_open = plug.is_empty();
    let how = match (is_marked, is_open) {
        (false, _) => format!("{path} is without `!`"),
        (true, false) => format!("{path} has `!`"),
        (true, true) => format!("write `!` before the connector in {path}"),
    };
    if is_marked && !is_open {
        look.work.plug(path, &format!("!{plug}"), &format!("to be filled in; `!`: {name}"));
    }
    look.work.say(entry, if is_marked && is_open { Kind::Approximated } else { Kind::Taken }, how);
}

/// The kind of a motor's driver.
fn drivers(look: &mut Look<'_, '_, '_>, motor: &str) {
    let name = format!("{motor}_DRIVER_TYPE");
    let Some(driver) = look.defines.find(&name).map(|define| define.value.clone()) else { return };
    match driver.as_str() {
        "TMC2209" => look.say(&name, Kind::Taken, "the driver there is"),
        _ => {
            let text = format!("{driver}: the motor needs a TMC2209, with a current of its own");
            look.say(&name, Kind::Approximated, text);
        }
    }
}
