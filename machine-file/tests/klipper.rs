//! Configurations of Klipper, in all forms that its documentation has, as machine files.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::settings::{CornerRule, Settings};
use corehbot_machine_file::klipper::{Config, Files, Kind, Report, Translation, matches, translate};
use corehbot_machine_file::parse;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// Texts by their names.
struct Texts(Vec<(String, String)>);

impl Files for Texts {
    fn matching(&mut self, from: &str, pattern: &str) -> Vec<String> {
        let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
        let pattern = if folder.is_empty() { pattern.to_owned() } else { format!("{folder}/{pattern}") };
        let is_meant = |name: &&String| {
            let (name, pattern): (Vec<_>, Vec<_>) = (name.split('/').collect(), pattern.split('/').collect());
            name.len() == pattern.len() && name.iter().zip(pattern).all(|(name, pattern)| matches(pattern, name))
        };
        self.0.iter().map(|(name, _)| name).filter(is_meant).cloned().collect()
    }

    fn read(&mut self, name: &str) -> Result<String, String> {
        self.0
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, text)| text.clone())
            .ok_or_else(|| "no such file".into())
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/klipper")
}

/// The texts of the folder of tests.
fn texts() -> Texts {
    let names = ["gantry.cfg", "parts/tool.cfg", "parts/heat/heat.inc", "awd.cfg", "bedslinger.cfg"];
    Texts(names.map(|name| (name.to_owned(), std::fs::read_to_string(folder().join(name)).unwrap())).to_vec())
}

fn translated(name: &str) -> Translation {
    let config = Config::read(name, &mut texts()).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    translate(&config, None).unwrap()
}

/// The translation of one text for the Octopus.
fn of_text(text: &str) -> Translation {
    let config = read(text).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    translate(&config, Some(&corehbot_boards::octopus::CONNECTORS)).unwrap()
}

fn read(text: &str) -> Result<Config, Vec<String>> {
    let mut texts = Texts(vec![("printer.cfg".to_owned(), text.to_owned())]);
    Config::read("printer.cfg", &mut texts).map_err(|mistakes| mistakes.iter().map(ToString::to_string).collect())
}

/// The verdict on a key: its kind and its words.
fn verdict<'r>(report: &'r Report, section: &str, key: &str) -> (Kind, &'r str) {
    let section = report.sections.iter().find(|known| known.name == section).unwrap();
    let key = section.keys.iter().rfind(|known| known.key == key).unwrap();
    (key.verdict.kind, &key.verdict.text)
}

/// Compares a text with its stored copy.
fn is_stored(name: &str, text: &str) {
    let path = folder().join(name);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap_or_default(), text, "{name}: BLESS=1 writes it");
}

#[test]
fn reports_and_machine_files_are_the_stored_ones() {
    for name in ["gantry", "awd", "bedslinger"] {
        let done = translated(&format!("{name}.cfg"));
        let problems: String = done.problems.iter().map(|problem| format!("{name}.toml:{problem}\n")).collect();
        is_stored(&format!("{name}.txt"), &format!("{}{problems}", done.report));
        is_stored(&format!("{name}.toml"), &done.text);
    }
}

#[test]
fn a_gantry_on_an_octopus_is_a_machine() {
    let done = translated("gantry.cfg");
    let machine = done.machine.unwrap_or_else(|| panic!("{:?}\n{}", done.problems, done.text));
    assert_eq!(machine.board.map(|board| board.key), Some("octopus"));
    let s: Settings = machine.settings;
    let plug = |name: &str| {
        let (motor, _) = s.motors().find(|(_, known)| known.as_str() == name).unwrap();
        (
            s.wiring.of(motor).connector.as_str().to_owned(),
            s.wiring.of(motor).is_reversed,
            s.mechanism.rows[motor.index()],
        )
    };
    assert_eq!(plug("x"), ("M0".into(), true, [1, 1, 0, 0]));
    assert_eq!(plug("y"), ("M1".into(), true, [1, -1, 0, 0]));
    assert_eq!(plug("z"), ("M2".into(), false, [0, 0, 1, 0]));
    assert_eq!(plug("z3"), ("M5".into(), true, [0, 0, 1, 0]));
    assert_eq!(plug("e0"), ("M6".into(), false, [0, 0, 0, 1]));
    // 400 steps, 32 microsteps, 40 mm; 200 x 32 over 40 / 5; 200 x 16 over 22.6789511 / 5.
    let steps: [f64; 4] = [s.axes.x, s.axes.y, s.axes.z, s.axes.e].map(|axis| axis.steps_per_mm.to_num());
    assert_eq!(steps[..3], [320.0, 320.0, 800.0]);
    assert!((steps[3] - 3200.0 * 5.0 / 22.678_951_1).abs() < 0.01, "{}", steps[3]);
    assert_eq!(s.axes.z.max_speed.to_num::<f64>(), 15.0);
    assert_eq!(s.axes.z.max_acceleration.to_num::<f64>(), 350.0);
    assert_eq!(s.print_acceleration.to_num::<f64>(), 3000.0);
    assert!(matches!(s.corner, CornerRule::SquareCorner(speed) if speed.to_num::<f64>() == 6.0));
    assert_eq!((s.drivers.belt.current_ma, s.drivers.belt.hold_percent, s.drivers.belt.microsteps), (800, 100, 32));
    assert_eq!((s.drivers.e.current_ma, s.drivers.e.hold_percent, s.drivers.e.stealth), (500, 40, true));
    let ends = [s.wiring.endstops.x, s.wiring.endstops.y, s.wiring.endstops.z];
    assert_eq!(ends.map(|end| end.is_normally_open), [false, true, false]);
    assert_eq!(s.endstops.x.position.to_num::<f64>(), 350.0);
    // The file says -0.5 itself, so the block of SAVE_CONFIG does not count.
    assert_eq!(s.endstops.z.position.to_num::<f64>(), -0.5);
}

/// Nothing in silence: a line for every key.
#[test]
fn every_key_has_a_verdict() {
    for name in ["gantry.cfg", "awd.cfg", "bedslinger.cfg"] {
        let config = Config::read(name, &mut texts()).unwrap();
        let report = translate(&config, None).unwrap().report;
        assert_eq!(report.sections.iter().map(|section| section.keys.len()).sum::<usize>(), config.entries.len());
        assert_eq!(report.sections.len(), config.sections.len());
    }
}

#[test]
fn motors_of_other_boards_and_drivers_are_to_be_decided() {
    let done = translated("awd.cfg");
    assert!(done.machine.is_none());
    assert_eq!(done.report.board.key, "octopus-pro", "a comment names it");
    let of = |section: &str, key: &str| verdict(&done.report, section, key);
    let (kind, text) = of("extruder", "step_pin");
    assert!(kind == Kind::Decide && text.contains("EBBCan is another board"), "{text}");
    let (kind, text) = of("stepper_x", "step_pin");
    assert!(kind == Kind::Taken && text.contains("\"!M0\""), "an alias of an alias: {text}");
    assert_eq!(of("stepper_x", "endstop_pin"), (Kind::Taken, "endstops.x = \"!X-STOP\""));
    assert_eq!(of("stepper_x", "position_min").0, Kind::NotYet);
    assert_eq!(of("stepper_x", "position_endstop").0, Kind::Decide);
    assert!(of("stepper_y", "endstop_pin").1.contains("StallGuard"));
    assert!(of("stepper_z", "endstop_pin").1.contains("probe"));
    assert_eq!(of("printer", "max_accel_to_decel"), (Kind::Taken, "minimum_cruise_ratio = 0.5"));
    let (kind, text) = of("tmc2209 stepper_x", "run_current");
    assert!(kind == Kind::Approximated && text.contains("1700"), "{text}");
    assert!(done.report.notes.iter().any(|note| note.text.contains("a TMC5160 is not there yet")));
    // The usual input must not count where the owner has to decide.
    assert!(done.text.contains("\nz = \"\"  # to decide\n"), "{}", done.text);
}

#[test]
fn a_later_value_counts_and_the_earlier_one_is_told() {
    let done = translated("bedslinger.cfg");
    assert_eq!(done.report.board.key, "spider");
    let section = done.report.sections.iter().find(|section| section.name == "stepper_x").unwrap();
    let of_key: Vec<_> = section.keys.iter().filter(|key| key.key == "position_max").collect();
    assert_eq!(of_key[0].verdict.text, "bedslinger.cfg:38 replaces it");
    assert_eq!(of_key[1].verdict.text, "axes.x.length = 230");
}

#[test]
fn bad_lines_are_told_with_their_place() {
    for (text, told) in [
        ("key: 1", "printer.cfg:1: error: \"key: 1\" stands in no section"),
        ("[printer]\nkinematics", "printer.cfg:2: error: \"kinematics\" is neither"),
        ("[printer\na: 1", "printer.cfg:1: error: the section [printer has no `]`"),
        ("[printer]\n\n: 5", "printer.cfg:3: error: \": 5\" has no key"),
        ("[]", "printer.cfg:1: error: a section without a name"),
        ("[include no.cfg]", "printer.cfg:1: error: there is no file no.cfg"),
        ("#\n[include printer.cfg]", "printer.cfg:2: error: printer.cfg includes itself"),
        ("[include p*.cfg]", "printer.cfg:1: error: printer.cfg includes itself"),
    ] {
        let said = read(text).unwrap_err();
        assert!(said[0].starts_with(told), "{text}: {said:?}");
    }
    // A pattern may mean no file.
    assert!(read("[include x/*.cfg]").is_ok());
}

#[test]
fn values_go_on_over_lines_and_comments_end_them() {
    let config = read("[a]\nx:\n  1 ; no\n\n  2;3 # no\n[b c]\nY = p:q\n").unwrap();
    let values: Vec<_> = config.entries.iter().map(|entry| (&*entry.key, &*entry.value)).collect();
    assert_eq!(values, [("x", "1\n2;3"), ("y", "p:q")]);
    assert_eq!(config.sections[1].name, "b c");
}

#[test]
fn what_save_config_wrote_counts_where_the_file_says_nothing() {
    let config =
        read("[a]\nx: 1\n#*# <--- SAVE_CONFIG --->\n#*# DO NOT EDIT: this\n#*# [a]\n#*# x = 2\n#*# y =\n#*# \t 3\n")
            .unwrap();
    let value = |key: &str| &config.entries[config.find("a", key).unwrap()].value;
    assert_eq!((value("x").as_str(), value("y").as_str()), ("1", "3"));
}

/// A motor in another socket than its driver is found.
#[test]
fn pins_of_two_sockets_are_to_be_decided() {
    let text = "[printer]\nkinematics: cartesian\n[stepper_x]\nstep_pin: PF13\ndir_pin: PG1\nenable_pin: PF14\n";
    let report = of_text(text).report;
    let (kind, text) = verdict(&report, "stepper_x", "dir_pin");
    assert_eq!((kind, text), (Kind::Decide, "M0 has PF12 there, not PG1: is the motor in another socket?"));
    assert_eq!(verdict(&report, "stepper_x", "enable_pin").0, Kind::NotYet);
}

/// What is left out counts as in the prototype, so a file with something open must not be a machine.
#[test]
fn what_could_break_a_machine_is_left_open() {
    let whole = std::fs::read_to_string(folder().join("bedslinger.cfg")).unwrap();
    let done = |text: &str| translate(&read(text).unwrap(), None).unwrap();
    let is_machine = |text: &str| done(text).machine.is_some();
    assert!(is_machine(&whole) && !done(&whole).is_whole(), "the heater is left to decide");
    for (from, to) in [
        ("kinematics = cartesian", "kinematics = delta"),
        ("kinematics = cartesian", ""),
        ("position_max = 250", ""),
        ("position_max = 250", "position_max = tall"),
        ("position_endstop = 0\nposition_max = 250", "position_endstop = -60\nposition_max = 250"),
        ("rotation_distance = 8\n", ""),
        ("rotation_distance = 8\n", "rotation_distance = 8\ngear_ratio = 5\n"),
        ("rotation_distance = 8\nmicrosteps = 16", "rotation_distance = 8"),
        ("dir_pin = PD13", "dir_pin = PD6"),
        ("step_pin = PD14", "step_pin = PD15"),
        ("endstop_pin = ^PA0", "endstop_pin = probe:z_virtual_endstop"),
        ("endstop_pin = ^PA0", ""),
        ("[stepper_z]\n", "[stepper_z1]\nstep_pin = PE1\nrotation_distance = 4\nmicrosteps = 16\n[stepper_z]\n"),
        ("[stepper_z]\n", "[stepper_z1]\nstep_pin = PE1\nrotation_distance = 8\nmicrosteps = 8\n[stepper_z]\n"),
    ] {
        assert!(whole.contains(from), "{from}");
        let text = whole.replacen(from, to, 1);
        assert!(!is_machine(&text), "{to}: {}", done(&text).text);
        assert!(!done(&text).report.counts().contains(&(Kind::Decide, 0)), "{to}");
    }
    // Steps instead of turns, and microsteps with the driver, as older configurations have them.
    let old = whole.replacen("rotation_distance = 8\nmicrosteps = 16", "step_distance = .0025", 1)
        + "[tmc2209 stepper_z]\nmicrosteps = 16\nrun_current = 0.6\n";
    assert!(done(&old).text.contains("steps_per_mm = 400  # "), "{}", done(&old).text);
    assert!(is_machine(&old), "{:?}", done(&old).problems);
}

/// The rows by Klipper's own formulas: the position of a stepper, for the tool at x, y and z.
#[test]
fn every_kinematics_has_klippers_matrix() {
    let whole = std::fs::read_to_string(folder().join("bedslinger.cfg")).unwrap();
    // Axes that share motors need one resolution, and one speed limit that all motors bear.
    let whole = whole.replace("rotation_distance = 8", "rotation_distance = 40");
    for (name, [x, y, z]) in [
        ("cartesian", [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
        ("corexy", [[1, 1, 0, 0], [1, -1, 0, 0], [0, 0, 1, 0]]),
        ("corexz", [[1, 0, 1, 0], [0, 1, 0, 0], [1, 0, -1, 0]]),
        ("hybrid_corexy", [[1, -1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
        ("hybrid_corexz", [[1, 0, -1, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
    ] {
        let text = whole.replace("kinematics = cartesian", &format!("kinematics = {name}"));
        let done = translate(&read(&text).unwrap(), None).unwrap();
        let machine = done.machine.unwrap_or_else(|| panic!("{name}: {:?}\n{}", done.problems, done.text));
        let rows = machine.settings.mechanism.rows;
        assert_eq!(rows[..4], [x, y, z, [0, 0, 0, 1]], "{name}");
    }
}

/// The same configuration in another form is the same machine.
#[test]
fn order_and_spelling_do_not_count() {
    let mut whole = std::fs::read_to_string(folder().join("bedslinger.cfg")).unwrap();
    // Without the section that comes again, where the order does count.
    let again = whole.find("[stepper_x]\n# Comes again").unwrap();
    let next = whole.find("[extruder]").unwrap();
    whole.replace_range(again..next, "");
    let machine = |text: &str| translate(&read(text).unwrap(), None).unwrap().machine.unwrap().settings;
    let mut sections: Vec<String> =
        whole.split("\n[").map(|section| section.trim_start_matches('[').to_owned()).collect();
    sections.reverse();
    let with_capitals = |line: &str| match line.split_once(" = ") {
        Some((key, value)) => format!("{} =   {value}   ; a comment", key.to_uppercase()),
        None => line.to_owned(),
    };
    for other in [
        sections.iter().map(|section| format!("[{section}\n")).collect::<String>(),
        whole.replace(" = ", ": "),
        whole.replace(" = ", ":"),
        whole.replace(" = ", " =\n    "),
        whole.replace('\n', "\r\n"),
        whole.replace('\n', "\n\n# a comment\n\n"),
        whole.lines().map(with_capitals).collect::<Vec<_>>().join("\n"),
        whole.replace("= PE11", "= mcu:STEP") + "\n[board_pins]\naliases: STEP = PE11\n",
    ] {
        assert_eq!(machine(&other), machine(&whole), "{other}");
    }
}

/// A heater with the wrong sensor would heat to the wrong temperature.
#[test]
fn a_heater_without_a_known_sensor_is_not_fitted() {
    let head = "[extruder]\nheater_pin: PA2\nsensor_pin: PF4\n";
    for (more, is_fitted) in [
        ("sensor_type: PT1000", true),
        ("sensor_type: PT1000\npullup_resistor: 4700\ninline_resistor: 0", true),
        ("sensor_type: mine\n[thermistor mine]\ntemperature1: 25\nresistance1: 10000\nbeta: 3950", true),
        ("sensor_type: mine\n[thermistor mine]\ntemperature1: 25\nresistance1: 10000", false),
        ("sensor_type: MAX31865", false),
        ("", false),
        ("sensor_type: PT1000\npullup_resistor: 1000", false),
        ("sensor_type: PT1000\nheater_pin: !PA2", false),
        ("sensor_type: PT1000\nsensor_pin: PF2", false),
    ] {
        let text = of_text(&format!("{head}{more}")).text;
        assert!(text.contains("\n[heaters.hotend]\n"), "{text}");
        assert!(text.contains(&format!("\nis_fitted = {is_fitted}  # ")), "{more}: {text}");
    }
}

/// By hand: 100 kOhm at 25 C and 1770 Ohm at 150 C are a B of 4071.7 K.
#[test]
fn a_thermistor_of_three_points_is_an_ntc() {
    let points = "temperature1: 25\nresistance1: 100000\ntemperature2: 90\nresistance2: 8700\ntemperature3: 150\nresistance3: 1770";
    let text = of_text(&format!("[thermistor a b]\n{points}\n[heater_bed]\nsensor_type: a b\n")).text;
    assert!(text.contains("\nthermistor = { beta = 4072, ohms = 100000 }"), "{text}");
}

#[test]
fn a_switch_without_a_place_sits_at_its_end() {
    let done = of_text("[stepper_x]\nposition_max: 300\nhoming_positive_dir: True\n[stepper_y]\nposition_max: 200\n");
    assert!(done.text.contains("end = \"max\"  # printer.cfg:3\n"), "{}", done.text);
    assert_eq!(verdict(&done.report, "stepper_x", "homing_positive_dir").0, Kind::Taken);
    assert!(done.report.notes.iter().any(|note| note.text.contains("homing.y.position is the min end")));
}

/// A note on another board with the same pins comes later.
#[test]
fn the_first_board_that_is_named_counts() {
    for (text, board) in [
        ("# For the OctoPus V1\n[a]\nstep_pin: PF13 # as on the Octopus Pro", "octopus"),
        ("# octopus_pro\n# octopus\n[a]\nstep_pin: PF13", "octopus-pro"),
        ("# octopus\n[a]\nstep_pin: PE11", "spider"),
    ] {
        assert_eq!(translate(&read(text).unwrap(), None).unwrap().report.board.key, board, "{text}");
    }
}

#[test]
fn a_board_that_cannot_be_told_is_asked_for() {
    let config = read("[stepper_x]\nstep_pin: PX1\n").unwrap();
    assert!(translate(&config, None).err().unwrap().contains("--board"));
    // Octopus and Pro have the same pins; no comment tells them apart.
    let config = read("[stepper_x]\nstep_pin: PF13\n").unwrap();
    assert!(translate(&config, None).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_text_has_a_verdict_for_every_key(text in any_config()) {
        if let Ok(config) = read(&text) {
            let done = translate(&config, Some(&corehbot_boards::octopus::CONNECTORS)).unwrap();
            let keys = done.report.sections.iter().map(|section| section.keys.len()).sum::<usize>();
            prop_assert_eq!(keys, config.entries.len());
            let counted: usize = done.report.counts().iter().map(|(_, count)| count).sum();
            prop_assert!(counted >= keys);
            prop_assert_eq!(done.machine.is_some(), parse(&done.text).is_ok());
            prop_assert!(toml::from_str::<toml::Table>(&done.text).is_ok(), "{}", done.text);
        }
    }
}

/// Texts near configurations: known sections and keys with all kinds of values.
fn any_config() -> impl Strategy<Value = String> {
    let section = prop::sample::select(vec![
        "printer",
        "stepper_x",
        "stepper_y",
        "stepper_z",
        "stepper_x1",
        "extruder",
        "tmc2209 stepper_x",
        "heater_bed",
        "fan",
        "heater_fan a",
        "board_pins",
        "input_shaper",
        "probe",
        "mcu",
        "thermistor t",
        "idle_timeout",
    ]);
    let key = prop::sample::select(vec![
        "kinematics",
        "max_velocity",
        "max_accel",
        "step_pin",
        "dir_pin",
        "enable_pin",
        "endstop_pin",
        "microsteps",
        "rotation_distance",
        "gear_ratio",
        "position_max",
        "position_min",
        "position_endstop",
        "run_current",
        "aliases",
        "homing_speed",
        "sensor_type",
        "sensor_pin",
        "heater_pin",
        "max_temp",
        "pid_kp",
        "pin",
        "timeout",
        "shaper_type",
    ]);
    let value = prop_oneof![
        prop::sample::select(vec![
            "corexy",
            "cartesian",
            "PF13",
            "!PF12",
            "^!mcu:PG6",
            "80:16,2:1",
            "1e999",
            "-1",
            "nan",
            "x=y",
            "PA1"
        ])
        .prop_map(str::to_owned),
        "-?[0-9]{1,6}(\\.[0-9]{1,4})?",
        "[ -~\n\t]{0,20}",
        "\\PC{0,8}",
    ];
    let line = prop_oneof![
        4 => (key, value).prop_map(|(key, value)| format!("{key}: {value}\n")),
        1 => section.clone().prop_map(|section| format!("[{section}]\n")),
        1 => "[ -~\t]{0,30}\n",
    ];
    (section, prop::collection::vec(line, 0..60))
        .prop_map(|(section, lines)| format!("[{section}]\n{}", lines.concat()))
}
