//! Defines of drivers, fans and pauses, and switches that have their numbers in other defines.

use super::look::Look;
use crate::translation::Kind;
use corehbot::connectors::BoardConnectors;

/// What stands before the words of Marlin.
pub(super) fn before(look: &mut Look<'_, '_, '_>, board: Option<&'static BoardConnectors>) {
    drivers(look);
    fans(look, board.is_none_or(|board| !board.fans.is_empty()));
    pause(look);
    for (name, path) in [
        ("NO_MOTION_BEFORE_HOMING", "require_homing"),
        ("ADVANCED_OK", "advanced_ok"),
        ("MIN_SOFTWARE_ENDSTOPS", "soft_endstops"),
        ("MAX_SOFTWARE_ENDSTOPS", "soft_endstops"),
        ("ENABLE_LEVELING_AFTER_G28", "mesh.is_on"),
        ("PROBING_HEATERS_OFF", "probe.bed_heater_off"),
    ] {
        if let Some(entry) = look.on(name) {
            look.work.take(entry, path, true);
        }
    }
    look.say("ENABLE_LEVELING_AFTER_G28", Kind::Approximated, "from the start, not from G28 on");
    look.say("PROBING_HEATERS_OFF", Kind::Approximated, "the bed's heater alone");
    if look.on("HOTEND_IDLE_TIMEOUT").is_some() {
        look.take("HOTEND_IDLE_TIMEOUT_SEC", "thermal.idle_min", 1.0 / 60.0);
        look.say("HOTEND_IDLE_TIMEOUT", Kind::Approximated, "thermal.idle_min: all heaters go off");
    }
}

/// The group of the drivers of each axis.
const GROUPS: [(&str, &str); 4] =
    [("X", "drivers.belt"), ("Y", "drivers.belt"), ("Z", "drivers.z"), ("E0", "drivers.e")];

/// Current at rest as a part of the running one, and interpolation: both are for TMC drivers (`tmc_init` in
/// `Marlin/src/module/stepper/trinamic.cpp`), and an axis may have its own.
fn drivers(look: &mut Look<'_, '_, '_>) {
    let is_tmc = |motor: &str| look.defines.driver(motor).is_some_and(|driver| driver.starts_with("TMC"));
    let groups: Vec<_> = GROUPS.into_iter().filter(|(motor, _)| is_tmc(motor)).collect();
    for all in ["HOLD_MULTIPLIER", "INTERPOLATE"] {
        for (motor, group) in &groups {
            let own = format!("{motor}_{all}");
            let name = if look.entry(&own).is_some() { own.as_str() } else { all };
            if all == "HOLD_MULTIPLIER" {
                look.take(name, &format!("{group}.hold_percent"), 100.0);
            } else if let Some(entry) = look.entry(name) {
                let is_on = look.defines.has(name);
                look.work.take(entry, &format!("{group}.interpolate"), is_on);
            }
        }
        if groups.is_empty() {
            look.say(all, Kind::NotNeeded, "no driver of Trinamic has it");
        }
    }
}

/// Fans of M106: its 1 to 255 become FAN_MIN_PWM to FAN_MAX_PWM (`CALC_FAN_SPEED` in `Marlin/src/module/planner.cpp`).
/// Which outputs these are stays to be filled in; the first one is the usual.
fn fans(look: &mut Look<'_, '_, '_>, has_fans: bool) {
    let has_frequency = look.on("FAST_PWM_FAN").is_some();
    for (name, leaf, times) in [
        ("FAN_KICKSTART_TIME", "kick_ms", 1.0),
        ("FAN_MIN_PWM", "least", 1.0 / 255.0),
        ("FAN_MAX_PWM", "most", 1.0 / 255.0),
        ("FAST_PWM_FAN_FREQUENCY", "frequency", 1.0),
    ] {
        if !has_fans {
            look.say(name, Kind::NotNeeded, "the board has no fans");
        } else if leaf == "frequency" && !has_frequency {
            look.say(name, Kind::NotNeeded, "FAST_PWM_FAN is off");
        } else if look.take(name, &format!("fans.fan0.{leaf}"), times).is_some() {
            look.say(name, Kind::Approximated, "of the first fan: write it for other fans of M106 too");
        }
    }
    for name in ["FAN_KICKSTART_POWER", "EXTRUDER_AUTO_FAN_SPEED", "CONTROLLERFAN_SPEED_ACTIVE", "CONTROLLERFAN_SPEED"]
    {
        match look.number(name) {
            Some((entry, number)) if number >= 255.0 => look.work.say(entry, Kind::NotNeeded, "full power"),
            Some((entry, _)) if name == "FAN_KICKSTART_POWER" => {
                look.work.say(entry, Kind::Approximated, "a fan starts at full power");
            }
            Some((entry, number)) => {
                let text = format!("write most = {:.2} into [fans.fan1], or wherever that fan is", number / 255.0);
                look.work.say(entry, Kind::Approximated, text);
            }
            None => {}
        }
    }
}

/// The tool in a pause. Marlin rises to at least the height of its place (`Nozzle::park` in
/// `Marlin/src/libs/nozzle.cpp`).
fn pause(look: &mut Look<'_, '_, '_>) {
    if look.on("NOZZLE_PARK_FEATURE").is_some() {
        look.say("NOZZLE_PARK_FEATURE", Kind::Taken, "pause.x and pause.y");
        let place = look.defines.list("NOZZLE_PARK_POINT");
        for (at, path) in place.into_iter().zip(["pause.x", "pause.y", "pause.lift"]) {
            let Some(entry) = look.entry("NOZZLE_PARK_POINT") else { continue };
            match at {
                Some(at) => look.work.take_number(entry, path, at),
                None => look.work.say(entry, Kind::Decide, format!("its value is not known here: write {path}")),
            }
        }
        look.say("NOZZLE_PARK_POINT", Kind::Approximated, "Z rises by its height, not to it");
        look.take("NOZZLE_PARK_XY_FEEDRATE", "pause.travel_speed", 1.0);
    }
    if look.on("ADVANCED_PAUSE_FEATURE").is_some() {
        look.say("ADVANCED_PAUSE_FEATURE", Kind::NotNeeded, "built in (M125, M600)");
        look.take("PAUSE_PARK_RETRACT_LENGTH", "pause.retract", 1.0);
        look.take("PAUSE_PARK_RETRACT_FEEDRATE", "pause.retract_speed", 1.0);
        look.take("PAUSE_PARK_NOZZLE_TIMEOUT", "pause.heat_off_min", 1.0 / 60.0);
    }
}

/// Switches, and a key of which their numbers are: told only when the numbers are known.
const SWITCHES: [(&str, &[&str]); 11] = [
    ("PIDTEMP", &["heaters.hotend.pid.p"]),
    ("PIDTEMPBED", &["heaters.bed.pid.p"]),
    ("PIDTEMPCHAMBER", &["heaters.chamber.pid.p"]),
    ("MPCTEMP", &["heaters.hotend.model.capacity"]),
    ("LIN_ADVANCE", &["advance.time"]),
    ("INPUT_SHAPING_X", &["shaper.x.frequency"]),
    ("INPUT_SHAPING_Y", &["shaper.y.frequency"]),
    ("FAST_PWM_FAN", &["fans.fan0.frequency"]),
    ("PREVENT_COLD_EXTRUSION", &["thermal.min_extrude"]),
    ("ENABLE_LEVELING_FADE_HEIGHT", &["mesh.fade"]),
    (
        "HYBRID_THRESHOLD",
        &["drivers.belt.hybrid_threshold", "drivers.z.hybrid_threshold", "drivers.e.hybrid_threshold"],
    ),
];

/// What needs the numbers of other defines.
pub(super) fn after(look: &mut Look<'_, '_, '_>) {
    for (name, paths) in SWITCHES {
        let Some(entry) = look.on(name) else { continue };
        match paths.iter().find(|path| look.work.lines.get(path).is_some()) {
            Some(path) => look.work.say(entry, Kind::Taken, format!("its numbers are: {path}")),
            None => look.work.say(entry, Kind::NotYet, "no number of it is here"),
        }
    }
    if look.work.lines.get("screws.1.x").is_some() {
        look.say("Z_STEPPER_AUTO_ALIGN", Kind::Taken, "[screws.1] and so on");
        if look.entry("Z_STEPPER_ALIGN_STEPPER_XY").is_none() {
            let text = "places of the screws are not said: these points stand for them";
            look.say("Z_STEPPER_ALIGN_XY", Kind::Approximated, text);
        }
    }
}
