//! Defines of `Configuration.h` one by one, on a small Cartesian machine.

use super::sources::{holds, value};
use crate::reports::verdict;
use corehbot_machine_file::Kind::{self, Approximated, Decide, NotNeeded, NotYet, Taken};
use corehbot_machine_file::marlin::Given;
use corehbot_machine_file::{Translation, configuration_h};

const BASE: &str = "#define MOTHERBOARD BOARD_BTT_SKR_MINI_E3_V3_0
#define X_DRIVER_TYPE TMC2209
#define Y_DRIVER_TYPE TMC2209
#define Z_DRIVER_TYPE TMC2209
#define E0_DRIVER_TYPE TMC2209
#define DEFAULT_AXIS_STEPS_PER_UNIT { 80, 80, 400, 93 }
#define X_BED_SIZE 235
#define Y_BED_SIZE 220
#define X_MIN_POS -10
#define X_MAX_POS X_BED_SIZE
#define Y_MAX_POS Y_BED_SIZE
#define Z_MAX_POS 250
#define HOMING_FEEDRATE_MM_M { (50*60), (50*60), (4*60) }
";

fn of(lines: &str) -> Translation {
    let given = Given { board: Some(&corehbot_boards::octopus::CONNECTORS), kinematics: None };
    configuration_h::translate(&[("Configuration.h", &format!("{BASE}{lines}\n"))], given)
}

fn said<'d>(done: &'d Translation, key: &str) -> (Kind, &'d str) {
    verdict(&done.report, "Configuration.h", key)
}

/// Reproducer: a second motor of Z stayed unturned, so it turned against the first one.
#[test]
fn each_motor_of_an_axis_has_its_direction() {
    const Z: &str = "#define Z2_DRIVER_TYPE TMC2209\n#define Z3_DRIVER_TYPE TMC2209\n#define Z4_DRIVER_TYPE TMC2209\n";
    for (lines, turned) in [
        (format!("{Z}#define INVERT_Z_DIR true"), "z z1 z2 z3"),
        (format!("{Z}#define INVERT_Z_DIR false"), ""),
        (format!("{Z}#define INVERT_Z_DIR true\n#define INVERT_Z3_VS_Z_DIR"), "z z1 z3"),
        (format!("{Z}#define INVERT_Z_DIR false\n#define INVERT_Z2_VS_Z_DIR\n#define INVERT_Z4_VS_Z_DIR"), "z1 z3"),
        (format!("{Z}#define INVERT_Z_DIR true\n#define INVERT_Z2_VS_Z_DIR false"), "z z1 z2 z3"),
        (format!("{Z}#define INVERT_Z_DIR true\n#define INVERT_Z2_DIR false"), "z z2 z3"),
        ("#define Y2_DRIVER_TYPE TMC2209\n#define INVERT_Y_DIR true".to_owned(), "y y1"),
        ("#define Y2_DRIVER_TYPE A4988\n#define INVERT_Y_DIR true\n#define INVERT_Y2_VS_Y_DIR true".to_owned(), "y"),
        ("#define X2_DRIVER_TYPE TMC2209\n#define INVERT_X2_VS_X_DIR".to_owned(), "x1"),
        ("#define INVERT_X_DIR true\n#define INVERT_E0_DIR true".to_owned(), "x e0"),
    ] {
        let done = of(&lines);
        for name in ["x", "x1", "y", "y1", "z", "z1", "z2", "z3", "e0"] {
            let Some(socket) = value(&done, &format!("motors.{name}")) else { continue };
            let is = turned.split(' ').any(|other| other == name);
            assert_eq!(socket.as_str().unwrap().starts_with('!'), is, "{lines}: {name} at {socket}");
        }
        let all = &done.report.sections[0].keys;
        let told = all.iter().filter(|key| key.key.starts_with("INVERT"));
        assert!(told.clone().all(|key| key.verdict.kind == Taken), "{lines}: {}", done.report);
    }
    let done = of("#define INVERT_Z2_VS_Z_DIR\n#define INVERT_E1_DIR true");
    assert_eq!((said(&done, "INVERT_Z2_VS_Z_DIR").0, said(&done, "INVERT_E1_DIR").0), (NotNeeded, NotYet));
}

/// Before Marlin 2.1 a number or a switch says how many motors an axis has; a second carriage is no second motor.
#[test]
fn motors_of_an_axis_are_counted_as_marlin_counts_them() {
    for (lines, has, lacks) in [
        ("#define NUM_Z_STEPPER_DRIVERS 3\n#define INVERT_Z_DIR true", "z2", "z3"),
        ("#define NUM_Z_STEPPER_DRIVERS 1\n#define Z2_DRIVER_TYPE TMC2209", "z", "z1"),
        ("#define Y_DUAL_STEPPER_DRIVERS", "y1", "y2"),
        ("//#define Y_DUAL_STEPPER_DRIVERS\n#define Y2_DRIVER_TYPE TMC2209", "y", "y1"),
        ("#define DUAL_X_CARRIAGE\n#define X2_DRIVER_TYPE TMC2209", "x", "x1"),
    ] {
        let done = of(lines);
        assert!(value(&done, &format!("mechanism.{has}")).is_some(), "{lines}: {}", done.text);
        assert!(value(&done, &format!("mechanism.{lacks}")).is_none(), "{lines}: {}", done.text);
    }
    assert_eq!(said(&of("#define DUAL_X_CARRIAGE\n#define X2_DRIVER_TYPE TMC2209"), "X2_DRIVER_TYPE").0, NotYet);
}

/// Reproducer: a place beside the middle became the middle.
#[test]
fn a_place_to_home_z_is_evaluated() {
    const ON: &str = "#define Z_SAFE_HOMING\n#define Z_SAFE_HOMING_Y_POINT 100\n#define Z_SAFE_HOMING_X_POINT";
    const PROBE: &str = "#define BLTOUCH\n#define USE_PROBE_FOR_Z_HOMING\n";
    for (point, place, of_probe) in [
        ("(X_CENTER - 30)", "87", "87"),
        ("X_CENTER", "117", "\"auto\""),
        ("(X_CENTER)", "117", "\"auto\""),
        ("X_CENTER + 0.5", "117.5", "117.5"),
        ("((X_MIN_POS + X_MAX_POS) / 2)", "112", "112"),
        ("((X_MAX_POS) / 2.0)", "117.5", "117.5"),
        ("(X_MAX_BED - X_MIN_BED)", "235", "235"),
        ("Y_CENTER + 1", "111", "111"),
    ] {
        holds(&of(&format!("{ON} {point}")), &[("safe_z_home.x", place), ("safe_z_home.y", "100")]);
        holds(&of(&format!("{PROBE}{ON} {point}")), &[("probe.home.x", of_probe), ("probe.home.y", "100")]);
    }
    holds(&of(&format!("#define BED_CENTER_AT_0_0\n{ON} X_CENTER + 5")), &[("safe_z_home.x", "5")]);
    for lines in [format!("{ON} (X_CENTER - TO_THE_LEFT)"), format!("{PROBE}{ON} (X_CENTER - TO_THE_LEFT)")] {
        let done = of(&lines);
        assert_eq!(said(&done, "Z_SAFE_HOMING_X_POINT").0, Decide);
        assert!(value(&done, "safe_z_home.x").or(value(&done, "probe.home.x")).is_none(), "{}", done.text);
    }
    holds(&of("#define Z_SAFE_HOMING"), &[("safe_z_home.x", "117"), ("safe_z_home.y", "110")]);
    let of_mesh = of("#define Z_SAFE_HOMING\n#define AUTO_BED_LEVELING_UBL");
    assert!(value(&of_mesh, "safe_z_home.x").is_none(), "{}", of_mesh.text);
    let off = of("//#define Z_SAFE_HOMING\n#define Z_SAFE_HOMING_X_POINT X_CENTER");
    assert_eq!(said(&off, "Z_SAFE_HOMING_X_POINT").0, NotNeeded);
}

/// Reproducer: heights to which Z rises had "no setting".
#[test]
fn heights_of_homing_become_a_hop() {
    const BEFORE: &str = "#define Z_HOMING_HEIGHT 7\n";
    for (lines, height, before, after) in [
        (BEFORE.to_owned(), "7", Some(Approximated), None),
        ("#define Z_CLEARANCE_FOR_HOMING 0".to_owned(), "0", None, None),
        (format!("{BEFORE}#define Z_AFTER_HOMING 7"), "7", Some(Taken), Some(Taken)),
        (format!("{BEFORE}#define Z_AFTER_HOMING 9"), "7", Some(Approximated), Some(Decide)),
        ("#define Z_AFTER_HOMING 9".to_owned(), "9", None, Some(Approximated)),
        ("#define Z_CLEARANCE_BETWEEN_PROBES 5".to_owned(), "5", None, None),
    ] {
        let done = of(&lines);
        holds(&done, &[("safe_z_home.z_hop", height)]);
        for (key, kind) in [("Z_HOMING_HEIGHT", before), ("Z_AFTER_HOMING", after)] {
            if let Some(kind) = kind {
                assert_eq!(said(&done, key).0, kind, "{lines}: {}", done.report);
            }
        }
    }
    holds(&of(BEFORE), &[("safe_z_home.z_hop_speed", "4")]);
    for (lines, order) in [
        ("#define HOME_Y_BEFORE_X", r#"["y", "x", "z"]"#),
        ("#define HOME_Z_FIRST", r#"["z", "x", "y"]"#),
        ("#define HOME_Y_BEFORE_X\n#define HOME_Z_FIRST", r#"["z", "y", "x"]"#),
    ] {
        holds(&of(lines), &[("homing.order", order)]);
    }
}

/// Reproducer: these had "no setting" though a machine file has their keys.
#[test]
fn a_define_with_a_key_of_ours_is_taken() {
    for (lines, path, wanted) in [
        ("#define PID_PARAMS_PER_HOTEND\n#define DEFAULT_KP_LIST { 21, 22 }", "heaters.hotend.pid.p", "21"),
        ("#define HOLD_MULTIPLIER 0.6", "drivers.belt.hold_percent", "60"),
        ("#define HOLD_MULTIPLIER 0.6", "drivers.e.hold_percent", "60"),
        ("#define HOLD_MULTIPLIER 0.6\n#define Z_HOLD_MULTIPLIER 0.9", "drivers.z.hold_percent", "90"),
        ("#define INTERPOLATE false", "drivers.z.interpolate", "false"),
        ("#define INTERPOLATE true\n#define E0_INTERPOLATE false", "drivers.e.interpolate", "false"),
        ("#define FAN_KICKSTART_TIME 200", "fans.fan0.kick_ms", "200"),
        ("#define FAN_MIN_PWM 51", "fans.fan0.least", "0.2"),
        ("#define FAN_MAX_PWM 204", "fans.fan0.most", "0.8"),
        ("#define FAST_PWM_FAN\n#define FAST_PWM_FAN_FREQUENCY 25000", "fans.fan0.frequency", "25000"),
        ("#define NO_MOTION_BEFORE_HOMING", "require_homing", "true"),
        ("#define ADVANCED_OK", "advanced_ok", "true"),
        ("#define MIN_SOFTWARE_ENDSTOPS\n#define MAX_SOFTWARE_ENDSTOPS", "soft_endstops", "true"),
        ("#define ENABLE_LEVELING_AFTER_G28", "mesh.is_on", "true"),
        ("#define DELAY_BEFORE_PROBING 400", "probe.quiet", "0.4"),
        ("#define PROBING_HEATERS_OFF", "probe.bed_heater_off", "true"),
        ("#define X_PROBE_OFFSET_FROM_EXTRUDER -30", "probe.offset.x", "-30"),
        ("#define CONTROLLERFAN_SECS 90", "thermal.fan_run_on_s", "90"),
        ("#define HOTEND_IDLE_TIMEOUT\n#define HOTEND_IDLE_TIMEOUT_SEC (10*60)", "thermal.idle_min", "10"),
        ("#define MAX_CHAMBER_POWER 204", "heaters.chamber.max_duty", "0.8"),
        ("#define TEMP_SENSOR_BOARD 5", "sensors.board.thermistor", "\"104gt2\""),
        ("#define NOZZLE_PARK_FEATURE\n#define NOZZLE_PARK_POINT { (X_MIN_POS + 10), 215, 20 }", "pause.x", "0"),
        ("#define NOZZLE_PARK_FEATURE\n#define NOZZLE_PARK_POINT { (X_MIN_POS + 10), 215, 20 }", "pause.lift", "20"),
        ("#define NOZZLE_PARK_FEATURE\n#define NOZZLE_PARK_XY_FEEDRATE 110", "pause.travel_speed", "110"),
        ("#define ADVANCED_PAUSE_FEATURE\n#define PAUSE_PARK_RETRACT_LENGTH 3", "pause.retract", "3"),
        ("#define ADVANCED_PAUSE_FEATURE\n#define PAUSE_PARK_NOZZLE_TIMEOUT 600", "pause.heat_off_min", "10"),
        (
            "#define Z_STEPPER_AUTO_ALIGN\n#define Z_STEPPER_ALIGN_XY { { 10, 190 }, { 100, 5*2 } }",
            "screws.2.point_y",
            "10",
        ),
        ("#define Z_STEPPER_AUTO_ALIGN\n#define Z_STEPPER_ALIGN_XY { { 10, 190 }, { 100, 5*2 } }", "screws.1.y", "190"),
    ] {
        let done = of(lines);
        holds(&done, &[(path, wanted)]);
        let key = lines.lines().last().unwrap().split(' ').nth(1).unwrap();
        assert!(matches!(said(&done, key).0, Taken | Approximated), "{lines}: {}", done.report);
    }
    let own = "#define Z_STEPPER_AUTO_ALIGN\n#define Z_STEPPER_ALIGN_XY { { 10, 190 }, { 100, 10 } }\n\
        #define Z_STEPPER_ALIGN_STEPPER_XY { { -20, 100 }, { 250, 100 } }";
    holds(&of(own), &[("screws.1.x", "-20"), ("screws.2.x", "250"), ("screws.2.point_x", "100")]);
}

/// Switches say where their numbers are, and only if they are.
#[test]
fn switches_are_told_by_their_numbers() {
    let done = of("#define PIDTEMP\n#define DEFAULT_KP 20\n#define LIN_ADVANCE\n#define ADVANCE_K 0.03\n\
        #define INPUT_SHAPING_X\n#define SHAPING_FREQ_X 40\n#define INPUT_SHAPING_Y\n#define PREVENT_COLD_EXTRUSION\n\
        #define EXTRUDE_MINTEMP 170\n#define TEMP_SENSOR_1 5\n#define TEMP_SENSOR_2 0\n#define QUICK_HOME\n");
    for (key, wanted) in [
        ("PIDTEMP", (Taken, "its numbers are: heaters.hotend.pid.p")),
        ("LIN_ADVANCE", (Taken, "its numbers are: advance.time")),
        ("INPUT_SHAPING_X", (Taken, "its numbers are: shaper.x.frequency")),
        ("INPUT_SHAPING_Y", (NotYet, "no number of it is here")),
        ("PREVENT_COLD_EXTRUSION", (Taken, "its numbers are: thermal.min_extrude")),
        ("TEMP_SENSOR_1", (NotYet, "one hotend so far")),
        ("TEMP_SENSOR_2", (NotNeeded, "no other hotend")),
        ("QUICK_HOME", (NotYet, "X and Y are homed one after the other")),
    ] {
        assert_eq!(said(&done, key), wanted, "{key}");
    }
}
