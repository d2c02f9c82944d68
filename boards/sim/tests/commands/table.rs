//! The table: a line, and the answer before its `ok`.

use super::asker::{answers, answers_of};
use super::plain_lines::plain_lines;
use corehbot::gcode::{Command, names, parse};
use corehbot::protocol::BUSY_PAUSED;
use corehbot_machine_file as machine_file;
use std::collections::BTreeSet;

/// Answers in front of the `ok`; an asterisk at the end stands for anything.
type Row = (&'static str, &'static [&'static str]);

const SILENCE: &[&str] = &[];
const HEATERS: &[&str] = &["echo:no heaters configured"];
const UNTUNED: &[&str] = &["echo:no heaters configured, ignored"];
const NO_PROBE: &[&str] = &["echo:no probe configured, ignored"];
const NO_MESH: &[&str] = &["echo:Invalid mesh. G29 measures one"];
const PAUSED: &[&str] = &[
    "//action:paused",
    "//action:prompt_begin Paused",
    "//action:prompt_button Continue",
    "//action:prompt_show",
    BUSY_PAUSED,
    "//action:prompt_end",
    "//action:resumed",
];

const ROWS: &[Row] = &[
    // Motion.
    ("G0 X1 F6000", SILENCE),
    ("G1 X10 Y20 E.5 F1800", SILENCE),
    ("G1 F1800", SILENCE),
    ("G1 E-.8 F2100", SILENCE),
    ("G2 X110 I5", SILENCE),
    ("G3 Z50.76 I.194 J1.201 P1  F30000", SILENCE),
    ("G2 X1", &["echo:arc ignored: *"]),
    ("G4 P10", SILENCE),
    ("G4 ; wait", SILENCE),
    ("G10", SILENCE),
    ("G10 S1", SILENCE),
    ("G11", SILENCE),
    ("M207 S2 F1800 Z.2", SILENCE),
    ("M207", &["  M207 S3 F2700 Z0"]),
    ("M208 S.1", SILENCE),
    ("M208", &["  M208 S0 F480"]),
    ("G17", SILENCE),
    ("G18", SILENCE),
    ("G19", SILENCE),
    ("G20", SILENCE),
    ("G21", SILENCE),
    ("G28 X0 Y0", SILENCE),
    ("G90", SILENCE),
    ("G91", SILENCE),
    ("G92 E0", SILENCE),
    ("M400", SILENCE),
    ("M400 U1", SILENCE),
    ("M410", SILENCE),
    ("M108", SILENCE),
    ("M82", SILENCE),
    ("M83", SILENCE),
    ("M220 S90", SILENCE),
    ("M220", &["FR:100%"]),
    ("M220 B", SILENCE),
    ("M220 R", SILENCE),
    ("M221 S95", SILENCE),
    ("M221", &["echo:E0 Flow: 100%"]),
    ("T0", SILENCE),
    ("T1", &["echo:T1 Invalid extruder"]),
    ("M221 T1 S50", &["echo:M221 ignored: there is no extruder 1"]),
    ("Tx", SILENCE),
    // Waiting for the user.
    ("M0", PAUSED),
    ("M0 Press the button", PAUSED),
    ("M1", PAUSED),
    ("M601", PAUSED),
    ("M600 E10", &["//action:paused", "//action:prompt_begin Change the filament", "*", "*", "*", "*", "*"]),
    ("M1 S1", &["//action:paused", "*", "*", "*", "//action:prompt_end", "//action:resumed"]),
    ("M602", SILENCE),
    ("M24", SILENCE),
    ("M25", &["//action:paused"]),
    ("M28 a.gco", &["echo:open failed, File: a.gco. There is no card; *"]),
    ("M29", SILENCE),
    ("M125", &["//action:paused"]),
    ("M125 L1 X20 Z2 P1", &["//action:paused"]),
    ("M600 N9", &["*", "*", "*", "*", "echo:M600 N is not supported by this firmware", "*", "*", "*"]),
    ("M524", SILENCE),
    ("M876 S0", SILENCE),
    ("M876 P1", SILENCE),
    // Limits and settings.
    ("M92 X80 Y80", SILENCE),
    ("M92", &["  M92 X80 Y80 Z800 E400"]),
    ("M201 X4000", SILENCE),
    ("M201", &["  M201 X5000 Y5000 Z200 E5000"]),
    ("M203 Z10", SILENCE),
    ("M203", &["  M203 X300 Y300 Z20 E80"]),
    ("M204 P500 T500", SILENCE),
    ("M204", &["  M204 P3000 R3000 T5000"]),
    ("M205 X8 Y8", SILENCE),
    ("M205", &["  M205 J0.013 E5 S0 T0"]),
    ("M211 S1", SILENCE),
    ("M211", &["Soft endstops: ON  Min:  X0.00 Y0.00 Z0.00   Max:  X390.00 Y417.60 Z335.00"]),
    ("M200 D0", SILENCE),
    ("M593 F40", SILENCE),
    ("M593", &["  M593 X F0", "  M593 Y F0"]),
    ("M593 X F60 T5", &["echo:M593 ignored: T is 0 (ZV), 1 (ZVD), 2 (MZV), 3 (EI) or 4 (2HUMP_EI), *"]),
    ("M593 P\"mzv\" F60", SILENCE),
    ("M593 P\"zvdd\" F60", &["echo:M593 ignored: *"]),
    ("M572 D0 S0.05", SILENCE),
    ("M572", &["echo:Advance K=0"]),
    ("M900 K.05", SILENCE),
    ("M900", &["echo:Advance K=0"]),
    ("SET_PRESSURE_ADVANCE ADVANCE=0.05", SILENCE),
    ("SET_PRESSURE_ADVANCE", &["echo:Advance K=0"]),
    ("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.3", SILENCE),
    ("SET_VELOCITY_LIMIT ACCEL=1000 ACCEL_TO_DECEL=500 SQUARE_CORNER_VELOCITY=5", SILENCE),
    ("SET_VELOCITY_LIMIT VELOCITY=200", &["echo:SET_VELOCITY_LIMIT VELOCITY is not supported by this firmware"]),
    ("SET_VELOCITY_LIMIT", &["  SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.5"]),
    // Values out of range.
    ("M92 E0", &["echo:M92 ignored: E0 is out of range (1 to 25600), stays 400"]),
    ("M201 X0", &["echo:M201 ignored: X0 is out of range (1 to 100000), stays 5000"]),
    (
        "M203 X99999 Y-1",
        &[
            "echo:M203 ignored: X99999 is out of range (0.01 to 3000), stays 300; speeds are in mm/s",
            "echo:M203 ignored: Y-1 is out of range (0.01 to 3000), stays 300",
        ],
    ),
    ("M204 P0 R2 T1e9", &["echo:M204 ignored: P0 is out of range (1 to 100000), stays 3000"]),
    ("M205 J5", &["echo:M205 ignored: J5 is out of range (0.001 to 1), stays 0.013"]),
    ("M205 X0", &["echo:M205 ignored: X0 is out of range (0.01 to 3000)"]),
    (
        "M205 E0 S-1",
        &[
            "echo:M205 ignored: E0 is out of range (0.01 to 3000), stays 5",
            "echo:M205 ignored: S-1 is out of range (0 to 3000), stays 0",
        ],
    ),
    ("M205 X8 Y10 Z.4", &["echo:M205: one value for X and Y*"]),
    (
        "M207 S200 F0",
        &[
            "echo:M207 ignored: S200 is out of range (0 to 100), stays 3",
            "echo:M207 ignored: F0 is out of range (0.6 to 180000), stays 2700",
        ],
    ),
    ("M208 S-1", &["echo:M208 ignored: S-1 is out of range (0 to 100), stays 0"]),
    ("M220 S5", &["echo:M220 S5 is out of range, set to 10"]),
    ("M221 S5000", &["echo:M221 ignored: S5000 is out of range (10 to 999), stays 100"]),
    ("M113 S99", &["echo:M113 S99 is out of range, set to 60"]),
    ("M155 S99", &["echo:M155 S99 is out of range, set to 60"]),
    ("M123 S61", &["echo:M123 S61 is out of range, set to 60"]),
    ("M154 S-1", &["echo:M154 S-1 is out of range, set to 0"]),
    (
        "M593 F5 D2",
        &["echo:M593 ignored: F5 is out of range (10 to 500)", "echo:M593 ignored: D2 is out of range (0 to 0.5)"],
    ),
    (
        "M900 K30",
        &["echo:M900 ignored: K30 is out of range (0 to 4), stays 0; K is in seconds (Linear Advance 1.5); *"],
    ),
    ("M572 W9", &["echo:M572 ignored: W9 is out of range (0.005 to 0.2), stays 0.012"]),
    ("M913 X-5", &["echo:M913 ignored: X-5 is out of range (0 to 3000), stays 0"]),
    ("STEPPER_BUZZ STEPPER=m1", &["echo:m1 moved 1.000 mm to and fro; held: m4 m11; free: m8; home again"]),
    ("STEPPER_BUZZ STEPPER=m4 FREE=m8", &["echo:m4 moved 1.000 mm to and fro; held: m1 m11; free: m8; home again"]),
    ("STEPPER_BUZZ STEPPER=z2", &["echo:z2 moved 1.000 mm to and fro; held: z1; free: none; home again"]),
    ("STEPPER_BUZZ stepper=e0", &["echo:e0 moved 1.000 mm to and fro; held: none; free: none; home again"]),
    ("STEPPER_BUZZ STEPPER=m1 FREE=z1", &["echo:STEPPER_BUZZ ignored: m1 would strain its belt; FREE= is one of m8"]),
    ("STEPPER_BUZZ STEPPER=m1 FREE=m1", &["echo:STEPPER_BUZZ ignored: m1 would strain its belt; FREE= is one of m8"]),
    (
        "STEPPER_BUZZ STEPPER=m9",
        &["echo:STEPPER_BUZZ ignored: there is no motor m9; STEPPER= is one of m1 m4 m8 m11 z1 z2 e0"],
    ),
    ("STEPPER_BUZZ", &["echo:STEPPER_BUZZ ignored: there is no motor ; STEPPER= is one of m1 m4 m8 m11 z1 z2 e0"]),
    ("STEPPER_BUZZ STEPPER=stepper_x", &["echo:STEPPER_BUZZ ignored: there is no motor stepper_x"]),
    ("STEPPER_BUZZ m1", &["echo:line ignored: \"m1\" is not a name with = and a number"]),
    ("M956 S10", &["echo:no accelerometer configured (accelerometer.kind)"]),
    ("M955", &["echo:no accelerometer configured (accelerometer.kind)"]),
    (
        "TEST_RESONANCES AXIS=1,1 FREQ_START=90 FREQ_END=95",
        &[
            "echo:ACCEL_PER_HZ reduced to 48: the machine allows 5000 mm/s2",
            "echo:swept B; no accelerometer configured, nothing was measured",
        ],
    ),
    (
        "SHAPER_CALIBRATE AXIS=X FREQ_START=50 FREQ_END=55 ACCEL_PER_HZ=20",
        &["echo:swept X; no accelerometer configured, nothing was measured"],
    ),
    ("TEST_RESONANCES AXIS=Z", &["echo:line ignored: \"AXIS=Z\" is not a name with = and a number"]),
    (
        "TEST_RESONANCES FREQ_START=1",
        &["echo:TEST_RESONANCES ignored: FREQ_START=1 is out of range (5 to 150), stays 5"],
    ),
    ("M915 D", &["echo:nothing to compare with: align the belt motors first (M915)"]),
    ("M914 X300", &["echo:M914 ignored: X300 is out of range (0 to 255), stays 0"]),
    (
        "SET_VELOCITY_LIMIT ACCEL=0",
        &["echo:SET_VELOCITY_LIMIT ignored: ACCEL=0 is out of range (1 to 100000), stays 3000"],
    ),
    (
        "SET_VELOCITY_LIMIT ACCEL=1000 ACCEL_TO_DECEL=50",
        &["echo:SET_VELOCITY_LIMIT ignored: ACCEL_TO_DECEL=50 is out of range (100*"],
    ),
    ("G1 X110 F0", &["echo:F0 is out of range, stays 3000"]),
    ("G1 X110 F-5", &["echo:F-5 is out of range, stays 3000"]),
    ("G1 X110 F999999", &["echo:F999999 is out of range, set to 180000"]),
    ("G1 X99999999999", &["echo:target out of reach, moved to the edge of the reachable space"]),
    ("G92 X99999999999", &["echo:G92 ignored: X1000000000 is out of range (-10000 to 10000)"]),
    // Lines that are not in order.
    ("G1 Xabc", &["echo:line ignored: X needs a number"]),
    ("G1 X1,5", &["echo:line ignored: \"X1,5\" is not a letter with a number"]),
    ("G1 X1.2.3", &["echo:line ignored: \"X1.2.3\" is not a letter with a number"]),
    ("G1 X10\x01", &["echo:line ignored: \"X10?\" is not a letter with a number"]),
    ("G1 X--5", &["echo:line ignored: \"X--5\" is not a letter with a number"]),
    ("G1 U5", &["echo:line ignored: there is no axis U"]),
    ("G1 C5 Z1", &["echo:line ignored: C goes with X, Y and F alone"]),
    ("G1 X1 C5 F1200", &[]),
    ("G92 C0", &["echo:line ignored: there is no axis C"]),
    ("G90 G1 X10", &["echo:line ignored: G1 is a second command on it"]),
    ("G4 P-5", &["echo:line ignored: P-5 is out of range"]),
    ("SET_VELOCITY_LIMIT ACCEL=fast", &["echo:line ignored: \"ACCEL=fast\" is not a name with = and a number"]),
    // The host's own.
    ("M105", &[]),
    ("M110 N5", SILENCE),
    ("M110", &["Line: 0"]),
    ("M111 S6", SILENCE),
    ("M111", &["echo:DEBUG:off"]),
    ("M113 S2", SILENCE),
    ("M113", &["echo:M113 S2"]),
    ("M114", &["X:100.00 Y:100.00 Z:50.00 E:0.00 C:0.00 Count A:16000 B:0 Z:40000"]),
    ("M114 R", &["X:100.00 Y:100.00 Z:50.00 E:0.00 C:0.00 Count A:16000 B:0 Z:40000"]),
    ("M117 any; text *", SILENCE),
    ("M118 A1 action:notification hi", &["//action:notification hi"]),
    ("M118 E1 hi", &["echo:hi"]),
    ("M118 hi", &["hi"]),
    ("M118 ok", &["echo:ok"]),
    ("M119", &["Reporting endstop status", "x_min: open", "y_min: open", "z_min: open"]),
    ("M123", &["echo:no fan has a tachometer"]),
    ("M123 S5", SILENCE),
    ("M154 S5", SILENCE),
    ("M155 S2", SILENCE),
    ("M73 P5 R10", SILENCE),
    (
        "M73 P500 R-5",
        &["echo:M73 ignored: P500 is out of range (0 to 100)", "echo:M73 ignored: R-5 is out of range (0 to 65535)"],
    ),
    ("M74 W12.5", SILENCE),
    ("M75", SILENCE),
    ("M76", SILENCE),
    ("M77", SILENCE),
    ("M80", SILENCE),
    ("M81", &["echo:M81: heaters and fans are off; this firmware does not switch the power supply"]),
    ("M2", SILENCE),
    ("M20", SILENCE),
    ("M21", SILENCE),
    ("G12", SILENCE),
    ("M150 R255", SILENCE),
    ("M202 X5000", SILENCE),
    ("M217 S10", SILENCE),
    ("M240", SILENCE),
    ("M300 S440 P100", SILENCE),
    ("M355 S1", SILENCE),
    ("M403 E0 F0", SILENCE),
    ("M425 F1", SILENCE),
    ("M530 S1", SILENCE),
    ("M532 X50", SILENCE),
    ("M870", SILENCE),
    ("M413 S0", SILENCE),
    ("M413 S1", &["echo:Power-loss recovery OFF, this firmware cannot do it"]),
    ("M413", &["echo:Power-loss recovery OFF"]),
    ("M486 T3", SILENCE),
    ("M486 S1", SILENCE),
    ("M486 ACube (1)*", SILENCE),
    ("M486 S-1", SILENCE),
    ("M486 P1", &["echo:this firmware cannot leave out objects, ignored"]),
    ("EXCLUDE_OBJECT_START NAME=cube", SILENCE),
    ("EXCLUDE_OBJECT_END NAME=cube", SILENCE),
    ("EXCLUDE_OBJECT NAME=cube", &["echo:this firmware cannot leave out objects, ignored"]),
    ("M555 X1 Y1 W9 H9", SILENCE),
    ("M862.1 P0.4", SILENCE),
    ("M862.3 P \"MK4S\"", SILENCE),
    ("M999", SILENCE),
    // Motors and their drivers.
    ("M17", SILENCE),
    ("M18", SILENCE),
    ("M84 X Y E", SILENCE),
    ("M84 S0", SILENCE),
    ("M569 S1 X", SILENCE),
    ("M906 X800", SILENCE),
    ("M907 E500", SILENCE),
    // Heaters, which this machine lacks.
    ("M104 S200", HEATERS),
    ("M109 S200", HEATERS),
    ("M116", HEATERS),
    ("M140 S60", HEATERS),
    ("M190 S60", HEATERS),
    ("M301", UNTUNED),
    ("M303 E0 S200", UNTUNED),
    ("SELF_TEST", UNTUNED),
    // The machine over the line.
    ("MACHINE_PUT AT=5 HEX=00", &["echo:machine not stored: the next piece belongs at 0"]),
    ("MACHINE_PUT AT=0 HEX=0g", &["echo:machine not stored: HEX needs two hexadecimal digits a byte"]),
    ("MACHINE_PUT AT=x HEX=00", &["echo:line ignored: \"AT=x\" is not a name with = and a number"]),
    ("MACHINE_PUT HEX=00", &["echo:line ignored: \"HEX=00\" is not a name with = and a number"]),
    ("MACHINE_PUT AT=0 HEX=00", SILENCE),
    ("MACHINE_STORE", &["echo:machine not stored: empty"]),
    ("M304", UNTUNED),
    ("M306", UNTUNED),
    ("M306 E-1 A3", UNTUNED),
    ("M306 E5", &["echo:line ignored: E is 0 (hotend), -1 (bed) or -2 (chamber)"]),
    ("M104 Snan", &["echo:line ignored: S needs a number"]),
    ("M140 S1,5", &["echo:line ignored: \"S1,5\" is not a letter with a number"]),
    // Fans.
    ("M106", SILENCE),
    ("M106 S91.8", SILENCE),
    ("M106 P3 S10", SILENCE),
    ("M106 P9 S10", &["echo:M106 ignored: there is no fan 9"]),
    ("M106 P-1", &["echo:M106 ignored: there is no fan of that number"]),
    ("M106 P1", &["echo:fan 1 is not commanded"]),
    ("M106 S300", &["echo:M106 S300 is out of range, set to 255"]),
    ("M106 S-5", &["echo:M106 S-5 is out of range, set to 0"]),
    ("M106 Sinf", &["echo:line ignored: S needs a number"]),
    ("M107", SILENCE),
    ("M107 P2", &["echo:fan 2 is not commanded"]),
    ("M710", &["  M710 S255 D60"]),
    ("M710 S128 D30", SILENCE),
    ("M710 S999 D9999", &["echo:M710 ignored: D9999 is out of range (0 to 3600), stays 60"]),
    ("M710 S999", &["echo:M710 S999 is out of range, set to 255"]),
    ("M710 I1", &["echo:M710 I is not supported by this firmware"]),
    ("M710 R", SILENCE),
    ("M302", &["echo:Cold extrudes are enabled"]),
    ("M302 S170", &["echo:Cold extrudes are enabled, and cannot be forbidden without a heater"]),
    ("M302 P1", &["echo:Cold extrudes are enabled"]),
    ("M141 S40", SILENCE),
    ("M142 S36", SILENCE),
    ("M191 S40", SILENCE),
    // The probe, which this machine lacks.
    ("G30", NO_PROBE),
    ("M48", NO_PROBE),
    ("M280 P0 S90", NO_PROBE),
    ("M401", NO_PROBE),
    ("M402", NO_PROBE),
    ("G29", NO_PROBE),
    ("G29 J", SILENCE),
    ("G29 P9", &["echo:G29 P9 ignored: this firmware does not clean the nozzle"]),
    ("G80 N3", NO_PROBE),
    ("BED_MESH_CALIBRATE ADAPTIVE=1", NO_PROBE),
    ("G34", NO_PROBE),
    ("Z_TILT_ADJUST RETRIES=3", NO_PROBE),
    ("QUAD_GANTRY_LEVEL", NO_PROBE),
    ("G35 S40", NO_PROBE),
    ("G35 S60", &["echo:G35 ignored: S is 30, 31, 40, 41, 50 or 51"]),
    ("M422", &["  M422 S1 X40 Y200", "  M422 W1 X-25 Y200", "  M422 S2 X350 Y200", "  M422 W2 X415 Y200"]),
    ("M422 S2 X300", SILENCE),
    ("M422 R", SILENCE),
    // The mesh, which was not measured.
    ("G42 I1 J1", NO_MESH),
    ("M421 I0 J0 Z0.1", NO_MESH),
    ("BED_MESH_OUTPUT", NO_MESH),
    ("BED_MESH_CLEAR", SILENCE),
    ("BED_MESH_PROFILE SAVE=default", &["echo:Bed Leveling OFF", "echo:Fade Height 10.00"]),
    ("M555 X10 Y10 W100 H80", SILENCE),
    ("EXCLUDE_OBJECT_DEFINE NAME=cube CENTER=10,10 POLYGON=[[5,5],[15,5],[15,15]]", SILENCE),
    ("M420", &["echo:Bed Leveling OFF", "echo:Fade Height 10.00"]),
    ("M420 S1", &["echo:Invalid mesh. G29 measures one", "echo:Bed Leveling OFF", "echo:Fade Height 10.00"]),
    ("M420 Z0", &["echo:Bed Leveling OFF", "echo:Fade Height OFF"]),
    ("M420 Z200", &["echo:M420 ignored: Z200 is out of range (1 to 100), stays 10"]),
    // Offsets.
    ("M206 X1 Y-1 Z.5", SILENCE),
    ("M206", &["  M206 X0 Y0 Z0"]),
    ("M428", &["echo:Too far from reference point"]),
    ("M290 Z0.05", SILENCE),
    ("M290 S-0.05 P0", SILENCE),
    ("M290 Z0.05 R", &["echo:Babystep Z0.00", "echo:Z offset 0"]),
    ("M290", &["echo:Babystep Z0.00", "echo:Z offset 0"]),
    ("M290 Z5", &["echo:M290 Z5 is out of range, set to 2"]),
    ("M290 X0.05", &["echo:M290 X is not supported by this firmware"]),
    ("SET_GCODE_OFFSET Z=-0.1", SILENCE),
    ("SET_GCODE_OFFSET Z_ADJUST=0.1 MOVE=1 MOVE_SPEED=5", SILENCE),
    ("SET_GCODE_OFFSET X=0 Y=0 Z=0", SILENCE),
    ("SET_GCODE_OFFSET", &["echo:Babystep Z0.00", "echo:Z offset 0"]),
    ("SET_GCODE_OFFSET Y_ADJUST=1", &["echo:SET_GCODE_OFFSET Y_ADJUST is not supported by this firmware"]),
    ("SET_GCODE_OFFSET Z=9", &["echo:ignored: the offset of Z would be out of range (-5 to 5 mm)"]),
    ("SET_GCODE_OFFSET Z", &["echo:line ignored: \"Z\" is not a name with = and a number"]),
    // Storage, which this machine lacks.
    ("M500", &["echo:Settings not stored: no storage on this machine"]),
    ("M501", &["echo:Settings unchanged: *"]),
    ("M502", &["echo:Hardcoded Default Settings Loaded"]),
];

/// Codes that one line and its answer do not show, and where they are tested.
const ELSEWHERE: [(&str, &str); 15] = [
    ("M112", "../emergencies.rs"),
    ("M115", "answers.rs"),
    ("M122", "../console/reports.rs"),
    ("M503", "answers.rs"),
    ("M504", "../console/storage.rs"),
    ("M622", "effects.rs"),
    ("M623", "effects.rs"),
    ("MACHINE_GET", "../console/machine_record.rs"),
    ("if", "effects.rs"),
    ("elif", "effects.rs"),
    ("else", "effects.rs"),
    ("while", "effects.rs"),
    ("break", "effects.rs"),
    ("continue", "effects.rs"),
    ("abort", "effects.rs"),
];

fn fits(heard: &str, pattern: &str) -> bool {
    match pattern.strip_suffix('*') {
        Some(begin) => heard.starts_with(begin),
        None => heard == pattern,
    }
}

#[test]
fn every_command_is_answered_as_the_table_says() {
    for (line, expected) in ROWS {
        let heard = answers(&[line]);
        let (oks, said): (Vec<_>, Vec<_>) = heard.iter().partition(|heard| heard.starts_with("ok"));
        // An answer to M108 follows that to the wait which it ended.
        let asked = 1 + usize::from(heard.iter().any(|heard| heard == BUSY_PAUSED));
        assert_eq!(oks.len(), asked, "{line}: {heard:?}");
        assert_eq!(said.len(), expected.len(), "{line}: {heard:?}");
        assert!(said.iter().zip(*expected).all(|(heard, pattern)| fits(heard, pattern)), "{line}: {heard:?}");
        assert!(!heard.iter().any(|heard| heard.contains("Unknown")), "{line}: {heard:?}");
    }
}

/// Whether a line begins with that code.
fn begins(line: &str, code: &str) -> bool {
    line.split(['.', ' ']).next() == Some(code)
}

/// M113 alone has another answer, in its row.
#[test]
fn a_plain_setting_is_set_in_silence_and_reported_as_the_line_that_sets_it() {
    // No two axes share a motor, and there are heaters.
    let axes = "[mechanism]\nm1 = [1, 0, 0]\nm4 = [0, 1, 0]\nz1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n";
    let heaters = ["hotend", "bed"].map(|heater| format!("[heaters.{heater}]\nis_fitted = true\n"));
    let settings = machine_file::load(&(axes.to_owned() + &heaters.concat())).unwrap();
    for line in plain_lines().into_values().filter(|line| !begins(line, "M113")) {
        let (code, word) = line.split_once(' ').unwrap();
        let heard = answers_of(&settings, &[code, &line, code]);
        let [before, _, _, after, _] = heard.as_slice() else { panic!("{line}: {heard:?}") };
        assert!(before.starts_with(&format!("  {code} ")), "{heard:?}");
        let changed: Vec<_> =
            before.split(' ').zip(after.split(' ')).filter(|(before, after)| before != after).collect();
        let [(_, changed)] = changed[..] else { panic!("{line}: {heard:?}") };
        assert_eq!(changed[..1], word[..1], "{line}: {heard:?}");
    }
}

/// Every code and name that stands for a command has a row, is in `ELSEWHERE`, or sets plain settings.
#[test]
fn every_known_code_and_name_has_a_row() {
    let codes = ["G", "M"].into_iter().flat_map(|letter| (0..10_000).map(move |number| format!("{letter}{number}")));
    let codes = codes.filter(|code| !matches!(parse(code.as_bytes()), Command::Unknown(_)));
    let known: Vec<_> = codes.chain(names().map(str::to_owned)).collect();
    let plain: Vec<_> = plain_lines().into_values().collect();
    let lines = || ROWS.iter().map(|(line, _)| *line).chain(plain.iter().map(String::as_str));
    let has_row = |code: &String| lines().any(|line| begins(line, code));
    let without: BTreeSet<_> = known.into_iter().filter(|code| !has_row(code)).collect();
    assert_eq!(without, ELSEWHERE.map(|(code, _)| code.to_owned()).into(), "a row, or a place in ELSEWHERE");
}
