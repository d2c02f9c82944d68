//! Defines as words of Marlin: what M503, M115, M211, M119 and M122 would say of them.

use super::defines::{Define, Defines};
use super::expression::Names;
use crate::marlin::source::{Item, Source};

/// Lists of numbers for x, y, z and e, and the command that reports them.
const LISTS: [(&str, &str); 3] =
    [("DEFAULT_AXIS_STEPS_PER_UNIT", "M92"), ("DEFAULT_MAX_FEEDRATE", "M203"), ("DEFAULT_MAX_ACCELERATION", "M201")];

/// Single numbers, the define that switches them on (or `!` and one that switches them off), and their words.
const NUMBERS: [(&str, &str, &str, &str); 49] = [
    ("DEFAULT_ACCELERATION", "", "M204", "P"),
    ("DEFAULT_RETRACT_ACCELERATION", "", "M204", "R"),
    ("DEFAULT_TRAVEL_ACCELERATION", "", "M204", "T"),
    ("DEFAULT_MINIMUMFEEDRATE", "", "M205", "S"),
    ("DEFAULT_MINTRAVELFEEDRATE", "", "M205", "T"),
    ("DEFAULT_MINSEGMENTTIME", "", "M205", "B"),
    ("JUNCTION_DEVIATION_MM", "!CLASSIC_JERK", "M205", "J"),
    ("DEFAULT_XJERK", "CLASSIC_JERK", "M205", "X"),
    ("DEFAULT_YJERK", "CLASSIC_JERK", "M205", "Y"),
    ("DEFAULT_ZJERK", "CLASSIC_JERK", "M205", "Z"),
    ("DEFAULT_EJERK", "", "M205", "E"),
    ("DEFAULT_Kp", "PIDTEMP", "M301", "P"),
    ("DEFAULT_Ki", "PIDTEMP", "M301", "I"),
    ("DEFAULT_Kd", "PIDTEMP", "M301", "D"),
    ("DEFAULT_Kp_LIST", "PID_PARAMS_PER_HOTEND", "M301", "P"),
    ("DEFAULT_Ki_LIST", "PID_PARAMS_PER_HOTEND", "M301", "I"),
    ("DEFAULT_Kd_LIST", "PID_PARAMS_PER_HOTEND", "M301", "D"),
    ("DEFAULT_KP_LIST", "PID_PARAMS_PER_HOTEND", "M301", "P"),
    ("DEFAULT_KI_LIST", "PID_PARAMS_PER_HOTEND", "M301", "I"),
    ("DEFAULT_KD_LIST", "PID_PARAMS_PER_HOTEND", "M301", "D"),
    ("DEFAULT_bedKp", "PIDTEMPBED", "M304", "P"),
    ("DEFAULT_bedKi", "PIDTEMPBED", "M304", "I"),
    ("DEFAULT_bedKd", "PIDTEMPBED", "M304", "D"),
    ("DEFAULT_chamberKp", "PIDTEMPCHAMBER", "M309", "P"),
    ("DEFAULT_chamberKi", "PIDTEMPCHAMBER", "M309", "I"),
    ("DEFAULT_chamberKd", "PIDTEMPCHAMBER", "M309", "D"),
    ("DEFAULT_KP", "PIDTEMP", "M301", "P"),
    ("DEFAULT_KI", "PIDTEMP", "M301", "I"),
    ("DEFAULT_KD", "PIDTEMP", "M301", "D"),
    ("DEFAULT_BED_KP", "PIDTEMPBED", "M304", "P"),
    ("DEFAULT_BED_KI", "PIDTEMPBED", "M304", "I"),
    ("DEFAULT_BED_KD", "PIDTEMPBED", "M304", "D"),
    ("MPC_HEATER_POWER", "MPCTEMP", "M306", "P"),
    ("MPC_BLOCK_HEAT_CAPACITY", "MPCTEMP", "M306", "C"),
    ("MPC_SENSOR_RESPONSIVENESS", "MPCTEMP", "M306", "R"),
    ("MPC_AMBIENT_XFER_COEFF", "MPCTEMP", "M306", "A"),
    ("MPC_AMBIENT_XFER_COEFF_FAN255", "MPCTEMP", "M306", "F"),
    ("FILAMENT_HEAT_CAPACITY_PERMM", "MPCTEMP", "M306", "H"),
    ("EXTRUDE_MINTEMP", "PREVENT_COLD_EXTRUSION", "M302", "S"),
    ("LIN_ADVANCE_K", "LIN_ADVANCE", "M900", "K"),
    ("ADVANCE_K", "LIN_ADVANCE", "M900", "K"),
    ("SHAPING_FREQ_X", "INPUT_SHAPING_X", "M593", "X F"),
    ("SHAPING_ZETA_X", "INPUT_SHAPING_X", "M593", "X D"),
    ("SHAPING_FREQ_Y", "INPUT_SHAPING_Y", "M593", "Y F"),
    ("SHAPING_ZETA_Y", "INPUT_SHAPING_Y", "M593", "Y D"),
    ("X_PROBE_OFFSET_FROM_EXTRUDER", "", "M851", "X"),
    ("Y_PROBE_OFFSET_FROM_EXTRUDER", "", "M851", "Y"),
    ("Z_PROBE_OFFSET_FROM_EXTRUDER", "", "M851", "Z"),
    ("DEFAULT_KEEPALIVE_INTERVAL", "HOST_KEEPALIVE_FEATURE", "M113", "S"),
];

/// Motors, and their words in M906.
const MOTORS: [(&str, &str); 12] = [
    ("X", "X"),
    ("X2", "I1 X"),
    ("Y", "Y"),
    ("Y2", "I1 Y"),
    ("Z", "Z"),
    ("Z2", "I1 Z"),
    ("Z3", "I2 Z"),
    ("Z4", "I3 Z"),
    ("E0", "E"),
    ("E1", "T1 E"),
    ("E2", "T2 E"),
    ("E3", "T3 E"),
];

/// Kinematics that a define switches on; nothing here has the last ones.
const KINEMATICS: [&str; 14] = [
    "COREXY",
    "COREXZ",
    "COREYZ",
    "COREYX",
    "COREZX",
    "COREZY",
    "MARKFORGED_XY",
    "MARKFORGED_YX",
    "DELTA",
    "MORGAN_SCARA",
    "MP_SCARA",
    "AXEL_TPARA",
    "POLARGRAPH",
    "POLAR",
];

/// Sections of the report are the files.
pub(super) fn words(defines: &Defines, source: &mut Source) {
    let mut is_cartesian = true;
    for define in &defines.all {
        let section = source.files.get(define.file).cloned().unwrap_or_default();
        let (key, value) = (define.name.clone(), define.value.clone());
        let item = source.item(Item { section, key, value, file: define.file, line: define.line });
        if defines.find(&define.name).is_some_and(|found| found.line == define.line && found.file == define.file) {
            is_cartesian &= !of_define(defines, source, item, define);
        }
    }
    // A Cartesian machine has no define of its own, so the first one says it.
    if is_cartesian && !source.items.is_empty() {
        source.word(0, "M115", "KINEMATICS", "Cartesian");
    }
}

/// The words of a define; whether it is the kinematics.
fn of_define(defines: &Defines, source: &mut Source, item: usize, define: &Define) -> bool {
    let name = define.name.as_str();
    if let Some((_, code)) = LISTS.iter().find(|(known, _)| *known == name) {
        for (axis, number) in ["X", "Y", "Z", "E"].into_iter().zip(axes_of(defines, name)) {
            number_or_text(source, item, (code, axis), number, &define.value);
        }
    }
    let is_on = |switch: &str| match switch.strip_prefix('!') {
        Some(other) => !defines.has(other),
        None => switch.is_empty() || defines.has(switch),
    };
    for (_, _, code, word) in NUMBERS.iter().filter(|(known, switch, ..)| *known == name && is_on(switch)) {
        number_or_text(source, item, (code, word), defines.list(name).first().copied().flatten(), &define.value);
    }
    of_motor(defines, source, item, name);
    more_motors(defines, source, item, name);
    of_axis(defines, source, item, name);
    match name {
        "EXTRUDERS" => {
            let count = defines.of(name).unwrap_or(1.0);
            source.number(item, "M115", "EXTRUDER_COUNT", count);
        }
        "CUSTOM_MACHINE_NAME" => source.word(item, "M115", "MACHINE_TYPE", define.value.trim_matches('"')),
        "DEFAULT_LEVELING_FADE_HEIGHT" if defines.has("ENABLE_LEVELING_FADE_HEIGHT") => {
            source.number(item, "M420", "Z", defines.of(name).unwrap_or_default());
        }
        "NOZZLE_TO_PROBE_OFFSET" => {
            for (axis, number) in ["X", "Y", "Z"].into_iter().zip(defines.list(name)) {
                number_or_text(source, item, ("M851", axis), number, &define.value);
            }
        }
        "Z_STEPPER_ALIGN_XY" | "Z_STEPPER_ALIGN_STEPPER_XY" if defines.has("Z_STEPPER_AUTO_ALIGN") => {
            screws(defines, source, item, name);
        }
        _ if KINEMATICS.contains(&name) && defines.has(name) => {
            source.word(item, "M115", "KINEMATICS", name);
            return true;
        }
        _ => {}
    }
    false
}

/// Places of the screws of z, and of the points where the probe measures for them (`GcodeSuite::G34` in
/// `Marlin/src/gcode/calibrate/G34_M422.cpp`). Without places of their own the points stand for the screws.
fn screws(defines: &Defines, source: &mut Source, item: usize, name: &str) {
    let own = if name == "Z_STEPPER_ALIGN_XY" { "S" } else { "W" };
    let is_both = own == "S" && defines.find("Z_STEPPER_ALIGN_STEPPER_XY").is_none();
    for (screw, place) in defines.pairs(name).into_iter().enumerate() {
        for letter in [own, "W"].into_iter().take(if is_both { 2 } else { 1 }) {
            for (axis, at) in ["X", "Y"].into_iter().zip(&place) {
                number_or_text(source, item, ("M422", &format!("{letter}{} {axis}", screw + 1)), *at, name);
            }
        }
    }
}

/// The numbers of x, y, z and e: lists may have axes between z and e, which no machine here has.
fn axes_of(defines: &Defines, name: &str) -> Vec<Option<f64>> {
    let mut numbers = defines.list(name);
    numbers.truncate(4);
    numbers
}

/// A number as a word; text that is no number is told as such.
fn number_or_text(source: &mut Source, item: usize, (code, word): (&str, &str), number: Option<f64>, text: &str) {
    match number {
        Some(number) => source.number(item, code, word, number),
        None => source.word(item, code, word, text),
    }
}

/// Currents, microsteps and modes of drivers.
fn of_motor(defines: &Defines, source: &mut Source, item: usize, name: &str) {
    let is_tmc = |motor: &str| defines.driver(motor).is_some_and(|driver| driver.starts_with("TMC"));
    for (motor, word) in MOTORS {
        let Some(leaf) = name.strip_prefix(motor).and_then(|rest| rest.strip_prefix('_')) else { continue };
        match leaf {
            // Without a number of its own a second motor is known by its driver.
            "DRIVER_TYPE" if motor.len() > 1 && !motor.starts_with('E') => {
                let (first, part) = motor.split_at(1);
                if part.parse().is_ok_and(|part: usize| part > most_motors(defines, first)) {
                    continue;
                }
                let own = defines.of(&format!("{motor}_MICROSTEPS"));
                let microsteps = own.or_else(|| defines.of(&format!("{first}_MICROSTEPS"))).unwrap_or(16.0);
                source.number(item, "M122", word, microsteps);
            }
            "CURRENT" if is_tmc(motor) => source.number(item, "M906", word, defines.of(name).unwrap_or_default()),
            "MICROSTEPS" if is_tmc(motor) => {
                number_or_text(source, item, ("M122", word), defines.of(name), name);
            }
            "HYBRID_THRESHOLD" if is_tmc(motor) && defines.has("HYBRID_THRESHOLD") => {
                source.number(item, "M913", word, defines.of(name).unwrap_or_default());
            }
            _ => {}
        }
    }
    for (switch, axes) in [("STEALTHCHOP_XY", &["X", "Y"][..]), ("STEALTHCHOP_Z", &["Z"]), ("STEALTHCHOP_E", &["E"])] {
        let is_here = |axis: &&&str| is_tmc(if **axis == "E" { "E0" } else { axis });
        if name == switch && defines.has(switch) {
            axes.iter().filter(is_here).for_each(|axis| source.word(item, "M569", axis, "1"));
        }
    }
}

/// Motors that an axis may have: before Marlin 2.1 a number or a switch says it beside the types of drivers. The X2 of
/// a second carriage is no motor of x (`HAS_SYNCED_X_STEPPERS` in `Marlin/src/inc/Conditionals-4-adv.h`).
fn most_motors(defines: &Defines, axis: &str) -> usize {
    if axis == "X" && defines.has("DUAL_X_CARRIAGE") {
        return 1;
    }
    if let Some(number) = defines.of("NUM_Z_STEPPER_DRIVERS").filter(|_| axis == "Z") {
        return number as usize;
    }
    let is = |times: &str| defines.is_enabled(&format!("{axis}_{times}_STEPPER_DRIVERS"));
    match (is("TRIPLE"), is("DUAL")) {
        (Some(true), _) => 3,
        (_, Some(true)) => 2,
        (_, Some(false)) => 1,
        (_, None) => 4,
    }
}

/// Motors of an axis that such a switch says.
fn more_motors(defines: &Defines, source: &mut Source, item: usize, name: &str) {
    let Some((axis, _)) = name.split_once("_DUAL_").or_else(|| name.split_once("_TRIPLE_")) else {
        if name == "NUM_Z_STEPPER_DRIVERS" {
            (1..most_motors(defines, "Z").min(4)).for_each(|part| source.word(item, "M584", &format!("I{part} Z"), ""));
        }
        return;
    };
    if name.ends_with("_STEPPER_DRIVERS") && defines.has(name) {
        (1..most_motors(defines, axis)).for_each(|part| source.word(item, "M584", &format!("I{part} {axis}"), ""));
    }
}

/// Ends of axes, and their switches.
fn of_axis(defines: &Defines, source: &mut Source, item: usize, name: &str) {
    for axis in ["X", "Y", "Z"] {
        let Some(leaf) = name.strip_prefix(axis).and_then(|rest| rest.strip_prefix('_')) else { continue };
        match (leaf, defines.of(name)) {
            ("MIN_POS", Some(number)) => source.number(item, "M211", &format!("Min {axis}"), number),
            ("MAX_POS", Some(number)) => source.number(item, "M211", &format!("Max {axis}"), number),
            ("HOME_DIR", Some(number)) => {
                let end = if number > 0.0 { "max" } else { "min" };
                source.word(item, "M119", &format!("{}_{end}", axis.to_ascii_lowercase()), "open");
            }
            _ => {}
        }
    }
}
