//! Marlin's sources of settings as machine files, and any text as a source.

use super::config_g::CONFIG_G;
use crate::reports::verdict;
use corehbot_machine_file::Kind::{Approximated, Decide, NotNeeded, Taken};
use corehbot_machine_file::marlin::{Given, is_report};
use corehbot_machine_file::{Kind, Translation, configuration_h, reprap};
use proptest::prelude::*;

/// A small CoreXY in the words of Marlin's two files.
const CONFIGURATION: &str = r#"
/* #define COREXZ
 */
#ifndef CONFIGURATION_H
#define MOTHERBOARD BOARD_BTT_OCTOPUS_V1_0 // the board
#define CUSTOM_MACHINE_NAME "Small one"
#define BAUDRATE 250000
#define COREXY
//#define COREXZ
#define EXTRUDERS 1
#define X_DRIVER_TYPE TMC2209
#define Y_DRIVER_TYPE TMC2209
#define Z_DRIVER_TYPE A4988
#define Z2_DRIVER_TYPE A4988
#define E0_DRIVER_TYPE TMC2209
#define TEMP_SENSOR_0 1
#define TEMP_SENSOR_BED 11
#define HEATER_0_MAXTEMP 275
#define HOTEND_OVERSHOOT 15
#define PIDTEMP
#if ENABLED(PIDTEMP)
  #if ENABLED(PID_PARAMS_PER_HOTEND)
    #define DEFAULT_Kp { 20, 21 }
  #else
    #define DEFAULT_Kp 22.20
  #endif
#endif
//#define PID_PARAMS_PER_HOTEND
//#define CLASSIC_JERK
#if ENABLED(CLASSIC_JERK)
  #define DEFAULT_XJERK 10.0
#endif
#if DISABLED(CLASSIC_JERK)
  #define JUNCTION_DEVIATION_MM (0.010 + 0.003)
#endif
#define DEFAULT_AXIS_STEPS_PER_UNIT { 80, 2*40, \
  (400), 93.5 }
#define DEFAULT_MAX_FEEDRATE { 300, 300, 5, 25 }
#define DEFAULT_MAX_ACCELERATION { 3000, 3000, 100, 10000 }
#define DEFAULT_ACCELERATION 3000
#define X_BED_SIZE 235
#define Y_BED_SIZE 220
#define X_MIN_POS -10
#define Y_MIN_POS 0
#define X_MAX_POS X_BED_SIZE
#define Y_MAX_POS (Y_BED_SIZE + 5)
#define Z_MAX_POS 250
#define X_HOME_DIR -1
#define Y_HOME_DIR 1
#define Z_HOME_DIR -1
#define X_MIN_ENDSTOP_INVERTING false
#define Y_MAX_ENDSTOP_INVERTING true
#define INVERT_X_DIR true
#define INVERT_Y_DIR false
#define BLTOUCH
#define NOZZLE_TO_PROBE_OFFSET { -42, -5, -1.8 }
#define USE_PROBE_FOR_Z_HOMING
#define Z_SAFE_HOMING
#if ENABLED(Z_SAFE_HOMING)
  #define Z_SAFE_HOMING_X_POINT X_CENTER
  #define Z_SAFE_HOMING_Y_POINT 100
#endif
#define HOMING_FEEDRATE_MM_M { (50*60), (50*60), (4*60) }
#if UNKNOWN_TO_US
  #define DEFAULT_TRAVEL_ACCELERATION 1000
#else
  #define DEFAULT_TRAVEL_ACCELERATION 2000
#endif
#endif
"#;

const ADVANCED: &str = r"
#if HAS_TRINAMIC_CONFIG
  #if AXIS_IS_TMC_CONFIG(X)
    #define X_CURRENT 580
    #define X_MICROSTEPS 16
  #endif
  #if AXIS_IS_TMC_CONFIG(Z)
    #define Z_CURRENT 700
  #endif
#endif
#define HOMING_BUMP_MM { 5, 5, 2 }
#define HOMING_BUMP_DIVISOR { 2, 2, 4 }
#define LIN_ADVANCE
#if ENABLED(LIN_ADVANCE)
  #define LIN_ADVANCE_K 0.22
#endif
#define NOBODY_KNOWS_IT 5
";

fn marlin() -> Translation {
    configuration_h::translate(
        &[("Configuration.h", CONFIGURATION), ("Configuration_adv.h", ADVANCED)],
        Given::default(),
    )
}

/// The value of a key in a machine file.
pub(super) fn value(done: &Translation, path: &str) -> Option<toml::Value> {
    let file: toml::Table = done.text.parse().unwrap();
    let mut keys = path.split('.');
    let first = file.get(keys.next()?)?.clone();
    keys.try_fold(first, |table, key| table.get(key).cloned())
}

pub(super) fn holds(done: &Translation, pairs: &[(&str, &str)]) {
    for (path, wanted) in pairs {
        let found = value(done, path).unwrap_or_else(|| panic!("{path} is not there: {}", done.text));
        assert_eq!(found.to_string(), *wanted, "{path}: {}", done.text);
    }
}

#[test]
fn defines_that_count_become_a_machine() {
    let done = marlin();
    holds(
        &done,
        &[
            ("board", "\"octopus\""),
            ("name", "\"Small one\""),
            ("baud", "250000"),
            ("mechanism.x", "[1, 1, 0]"),
            ("mechanism.z1", "[0, 0, 1]"),
            ("axes.x.steps_per_mm", "80"),
            ("axes.y.steps_per_mm", "80"),
            ("axes.z.steps_per_mm", "400"),
            ("axes.e.steps_per_mm", "93.5"),
            ("axes.z.max_speed", "5"),
            ("axes.x.min", "-10"),
            ("axes.x.length", "245"),
            ("axes.y.length", "225"),
            ("bed.width", "235"),
            ("bed.left", "0"),
            ("corner.junction_deviation", "0.013"),
            ("heaters.hotend.pid.p", "22.2"),
            ("heaters.hotend.most", "260"),
            ("heaters.hotend.thermistor.points", "[[25, 100000], [150, 1641.9], [250, 226.15]]"),
            ("heaters.bed.thermistor", "\"ntc_3950\""),
            ("drivers.belt.current_ma", "580"),
            ("homing.x.fast", "50"),
            ("homing.x.slow", "25"),
            ("homing.z.slow", "1"),
            ("homing.z.back_off", "2"),
            ("homing.y.end", "\"max\""),
            ("motors.x", "\"!M0\""),
            ("motors.y", "\"M1\""),
            ("endstops.x", "\"X-STOP\""),
            ("endstops.y", "\"!Y-STOP\""),
            ("probe.kind", "\"bltouch\""),
            ("probe.z_home", "true"),
            ("probe.offset.z", "-1.8"),
            ("probe.home.x", "\"auto\""),
            ("probe.home.y", "100"),
            ("advance.time", "0.22"),
        ],
    );
    for path in ["corner.square_corner", "travel_acceleration", "drivers.z.stall_threshold"] {
        assert_eq!(value(&done, path), None, "{path}");
    }
    let of = |section: &str, key: &str| verdict(&done.report, section, key);
    assert_eq!(of("Configuration.h", "COREXY").0, Taken);
    // Two values, of a condition that is not known here.
    let (kind, said) = of("Configuration.h", "DEFAULT_TRAVEL_ACCELERATION");
    assert!(kind == Decide && said.contains("says 1000"), "{said}");
    assert_eq!(of("Configuration.h", "Z_DRIVER_TYPE").0, Approximated);
    assert_eq!(of("Configuration_adv.h", "NOBODY_KNOWS_IT"), (Kind::NotYet, "no setting for it"));
    assert!(!done.report.sections.iter().flat_map(|s| &s.keys).any(|key| key.key == "COREXZ"), "it is off");
}

#[test]
fn conditions_are_those_of_the_preprocessor() {
    let value_of = |condition: &str| {
        let text = format!(
            "#define MOTHERBOARD 5\n#define A\n#define B 0\n#define C 3\n//#define D\n#define E false\n\
             #if {condition}\n\
             #define X_BED_SIZE 111\n#else\n#define X_BED_SIZE 222\n#endif\n"
        );
        let done = configuration_h::translate(&[("Configuration.h", &text)], Given::default());
        value(&done, "bed.width").map(|size| size == toml::Value::Integer(111))
    };
    for (condition, is) in [
        ("ENABLED(A)", Some(true)),
        ("ENABLED(A, B)", Some(false)),
        ("ANY(B, D, A)", Some(true)),
        ("ANY(B, D, E)", Some(false)),
        ("EITHER(B, A) && DISABLED(D)", Some(true)),
        ("BOTH(A, E)", Some(false)),
        ("NONE(B, D)", Some(true)),
        ("defined(B) && !defined(D)", Some(true)),
        ("defined C", Some(true)),
        ("C == 3 && C * 2 - 1 >= 5", Some(true)),
        ("(C > 3) || (1 + 1 < C)", Some(true)),
        ("C / 2 == 1", Some(true)),
        ("C / 2.0 == 1.5", Some(true)),
        ("D", Some(false)),
        ("UNKNOWN && B", Some(false)),
        ("UNKNOWN || C", Some(true)),
        ("UNKNOWN", None),
        ("ENABLED(UNKNOWN)", None),
        ("C == ", None),
    ] {
        assert_eq!(value_of(condition), is, "{condition}");
    }
}

/// Defines that are used are never told to have no setting, and one that was taken back decides nothing.
#[test]
fn defines_that_are_used_or_taken_back_are_told_so() {
    let text = "#define MOTHERBOARD 5\n#define TEMP_SENSOR_0 1\n#define HEATER_0_MAXTEMP 275\n\
        #define HOTEND_OVERSHOOT 20\n#define PREVENT_LENGTHY_EXTRUDE\n#define EXTRUDE_MAXLENGTH 200\n\
        #define CLASSIC_JERK\n#define DEFAULT_XJERK 8\n#define X_BED_SIZE 235\n#undef X_BED_SIZE\n\
        #define X_BED_SIZE 310\n";
    let of = |text: &str| configuration_h::translate(&[("Configuration.h", text)], Given::default());
    let done = of(text);
    holds(&done, &[("heaters.hotend.most", "255"), ("axes.e.length", "200"), ("bed.width", "310")]);
    for key in ["HOTEND_OVERSHOOT", "EXTRUDE_MAXLENGTH", "PREVENT_LENGTHY_EXTRUDE", "CLASSIC_JERK"] {
        assert_eq!(verdict(&done.report, "Configuration.h", key).0, Taken, "{key}");
    }
    let section = &done.report.sections[0];
    let widths: Vec<_> = section.keys.iter().filter(|key| key.key == "X_BED_SIZE").map(|key| &key.verdict).collect();
    assert_eq!((widths[0].kind, widths[0].text.as_str()), (NotNeeded, "line 10 takes it back"));
    assert_eq!(widths[1].kind, Taken);
    let off = of(&text.replace("#define PREVENT", "//#define PREVENT"));
    assert_eq!(verdict(&off.report, "Configuration.h", "EXTRUDE_MAXLENGTH").0, NotNeeded);
}

/// A thermistor that comes near a thermocouple does not exist.
#[test]
fn the_chip_of_a_thermocouple_is_told_to_be_on_no_board() {
    for (number, told) in [("-5", true), ("-2", true), ("999", false)] {
        let text = format!("#define MOTHERBOARD 5\n#define TEMP_SENSOR_0 {number}\n");
        let done = configuration_h::translate(&[("Configuration.h", &text)], Given::default());
        let (kind, said) = verdict(&done.report, "Configuration.h", "TEMP_SENSOR_0");
        assert_eq!((kind, said.contains("no such sensor on this board")), (Decide, told), "{number}: {said}");
    }
}

/// A comment of Klipper begins as a define does.
#[test]
fn sections_are_no_source_of_marlin() {
    assert!(configuration_h::is_configuration(CONFIGURATION) && configuration_h::is_configuration(ADVANCED));
    assert!(!configuration_h::is_configuration(CONFIG_G) && !is_report(CONFIGURATION));
    let defines = "#define STEPS DEFAULT_AXIS_STEPS_PER_UNIT\n#define CURRENT X_CURRENT\n";
    for (text, is) in [
        (defines.to_owned(), true),
        (format!("{defines}[printer]\nkinematics: corexy\n"), false),
        (format!("  [mcu]  # the board\n{defines}"), false),
        (format!("[include parts/*.cfg]\n{defines}"), false),
        (format!("# parts/*.cfg\n[tmc2209 stepper_x]\n{defines}"), false),
        (format!("/* Sections:\n[printer] is none here\n */\n{defines}"), true),
        (format!("{defines}#define LIST {{ \\\n  [0] = 5 }}\n"), true),
    ] {
        assert_eq!(configuration_h::is_configuration(&text), is, "{text}");
    }
}

fn is_sound(done: &Translation) {
    assert!(toml::from_str::<toml::Table>(&done.text).is_ok(), "{}", done.text);
    assert!(!done.report.to_string().is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn any_text_becomes_a_file_and_a_report(text in any_source()) {
        is_sound(&configuration_h::translate(&[("Configuration.h", &text)], Given::default()));
        is_sound(&reprap::translate("config.g", &text, Given::default()));
        let _ = (configuration_h::is_configuration(&text), reprap::is_config(&text));
    }
}

/// Texts near either source.
fn any_source() -> impl Strategy<Value = String> {
    let of_both: Vec<String> = CONFIGURATION.lines().chain(CONFIG_G.lines()).map(str::to_owned).collect();
    let line = prop_oneof![
        6 => prop::sample::select(of_both),
        1 => "#(if|elif|else|endif|define|undef|ifdef) ?[A-Z!&|()<>=+*/0-9 -]{0,20}",
        1 => "[GM][0-9]{1,3}( [A-Z][-\"{}:0-9.eA-Z]{0,6}){0,4}",
        1 => "\\PC{0,20}",
        1 => "#define [A-Z]{1,3} [({]{0,60}",
    ];
    prop::collection::vec(line, 0..60).prop_map(|lines| lines.join("\n"))
}
