//! Keys that are left to the owner to decide.

use super::{folder, of_text, read, translated, verdict};
use corehbot_machine_file::klipper::{Kind, translate};

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
    assert_eq!(of("stepper_x", "position_min"), (Kind::Taken, "axes.x.min = -59.8"));
    assert_eq!(of("stepper_x", "position_max"), (Kind::Taken, "axes.x.length = 389.8"));
    assert_eq!(of("stepper_x", "position_endstop"), (Kind::Taken, "homing.x.position = -59.8"));
    assert!(of("stepper_y", "endstop_pin").1.contains("StallGuard"));
    assert!(of("stepper_z", "endstop_pin").1.contains("probe"));
    assert_eq!(of("printer", "max_accel_to_decel"), (Kind::Taken, "minimum_cruise_ratio = 0.5"));
    let (kind, text) = of("tmc2209 stepper_x", "run_current");
    assert!(kind == Kind::Approximated && text.contains("1700"), "{text}");
    assert!(done.report.notes.iter().any(|note| note.text.contains("a TMC5160 is not there yet")));
    // The usual input must not count where the owner has to decide.
    assert!(done.text.contains("\nz = \"\"  # to decide\n"), "{}", done.text);
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

/// A key that is left out counts as in the prototype, so a file with an open key must not be a machine.
#[test]
fn what_could_break_a_machine_is_left_open() {
    let whole = std::fs::read_to_string(folder().join("bedslinger.cfg")).unwrap();
    let done = |text: &str| translate(&read(text).unwrap(), Some(&corehbot_boards::spider::CONNECTORS)).unwrap();
    let is_machine = |text: &str| done(text).machine.is_some();
    assert!(is_machine(&whole) && done(&whole).is_whole());
    // E2 of the Spider is no output.
    let cold = whole.replace("heater_pin = PB15", "heater_pin = PB3");
    assert!(is_machine(&cold) && !done(&cold).is_whole(), "the heater is left to decide");
    for (from, to) in [
        ("kinematics = cartesian", "kinematics = delta"),
        ("kinematics = cartesian", ""),
        ("position_max = 250", ""),
        ("position_max = 250", "position_max = tall"),
        (
            "position_endstop = 0\nposition_max = 250",
            "position_endstop = 200\nhoming_positive_dir = false\nposition_max = 250",
        ),
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

/// A thermistor that comes near a PT100 behind a converter does not exist.
#[test]
fn the_chip_of_a_pt100_is_told_to_be_on_no_board() {
    for (kind, told) in [("MAX31865", true), ("MAX6675", true), ("Unheard of", false)] {
        let head = "[extruder]\nheater_pin: PA2\nsensor_pin: PF4\n";
        let done = of_text(&format!("{head}sensor_type: {kind}\n"));
        let (_, said) = verdict(&done.report, "extruder", "sensor_type");
        assert_eq!(said.contains("no such sensor on this board"), told, "{kind}: {said}");
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

/// A small machine with the pins of no board here, of which many are pins of the Octopus, for other things.
const STRANGER: &str = "[printer]\nkinematics: cartesian\n\
    [stepper_x]\nstep_pin: PC2\ndir_pin: !PB9\nenable_pin: !PC3\nendstop_pin: ^!PG10\n\
    [extruder]\nstep_pin: PF13\ndir_pin: PF12\nenable_pin: !PF14\nheater_pin: PA1\nsensor_pin: PF3\n\
    sensor_type: Generic 3950\n\
    [heater_bed]\nheater_pin: PA2\nsensor_pin: PF4\nsensor_type: Generic 3950\n\
    [fan]\npin: PA8\n[heater_fan hotend]\npin: PE5\n\
    [bltouch]\nsensor_pin: ^PB7\ncontrol_pin: PB6\n[temperature_sensor lid]\nsensor_type: Generic 3950\n\
    sensor_pin: PF5\n[filament_switch_sensor a]\nswitch_pin: PG12\n";

/// Boards share names of pins, and each means another connector by them.
#[test]
fn no_pin_of_another_board_is_taken() {
    for entry in corehbot_boards::entries() {
        let board = entry.board.connectors;
        let done = translate(&read(STRANGER).unwrap(), Some(board)).unwrap();
        for (section, key, path) in [
            ("stepper_x", "endstop_pin", "endstops.x"),
            ("extruder", "step_pin", "motors.e0"),
            ("extruder", "heater_pin", "heaters.hotend.output"),
            ("extruder", "sensor_pin", "heaters.hotend.sensor"),
            ("heater_bed", "heater_pin", "heaters.bed.output"),
            ("heater_bed", "sensor_pin", "heaters.bed.sensor"),
            ("fan", "pin", "PA8"),
            ("bltouch", "sensor_pin", "endstops.probe"),
        ] {
            let (kind, said) = verdict(&done.report, section, key);
            assert!(kind == Kind::Decide && said.contains(path), "{}: [{section}] {key}: {said}", board.key);
            assert!(said.contains("is a pin of another board"), "{}: [{section}] {key}: {said}", board.key);
        }
        for (section, key) in [("temperature_sensor lid", "sensor_pin"), ("filament_switch_sensor a", "switch_pin")] {
            assert_eq!(verdict(&done.report, section, key).0, Kind::NotYet, "{}", board.key);
        }
        let file: toml::Table = done.text.parse().unwrap();
        assert_eq!(file["endstops"]["x"].as_str(), Some("!"), "{}", board.key);
        assert!(["hotend", "bed"].iter().all(|name| file["heaters"][name]["is_fitted"].as_bool() == Some(false)));
        assert!(["output", "sensor"].iter().all(|leaf| file["heaters"]["bed"].get(leaf).is_none()));
        let told = format!("these are not the pins of the {}", board.name);
        assert!(done.report.notes.iter().any(|note| note.kind == Kind::Decide && note.text.starts_with(&told)));
    }
}

/// Fans tell the versions of a board, so those of another version are none of this one's.
#[test]
fn fans_of_another_version_are_to_be_decided() {
    let text = "[stepper_x]\nstep_pin: PE11\n[heater_fan hotend]\npin: PB1\n[fan]\npin: PB2\n";
    let done = translate(&read(text).unwrap(), Some(&corehbot_boards::spider::CONNECTORS)).unwrap();
    let (kind, said) = verdict(&done.report, "fan", "pin");
    assert!(kind == Kind::Decide && said.contains("another version of the"), "{said}");
    let done = translate(&read(text).unwrap(), Some(&corehbot_boards::spider_v1::CONNECTORS)).unwrap();
    assert_eq!(verdict(&done.report, "fan", "pin").0, Kind::Taken);
}

/// The Octopus has the pins of the Pro, and a note on yet another one comes later.
#[test]
fn pins_of_a_twin_are_taken() {
    let text = "# pins of the Octopus; those of the Octopus Pro v1.1 differ\n[stepper_x]\nstep_pin: PF13\n\
        [heater_bed]\nheater_pin: PA1\n";
    for board in [&corehbot_boards::octopus::CONNECTORS, &corehbot_boards::octopus_pro::CONNECTORS] {
        let done = translate(&read(text).unwrap(), Some(board)).unwrap();
        assert_eq!(verdict(&done.report, "heater_bed", "heater_pin").0, Kind::Taken, "{}", board.key);
    }
}

/// A board with the same pins has other heaters on them, or another bootloader: its name is said.
#[test]
fn pins_of_a_named_namesake_are_not_taken() {
    let text = "[stepper_x]\nstep_pin: PE11\n[heater_bed]\nheater_pin: PC8\nsensor_pin: PC3\n";
    let of = |comment: &str| {
        translate(&read(&format!("{comment}{text}")).unwrap(), Some(&corehbot_boards::spider::CONNECTORS)).unwrap()
    };
    let done = of("# pins of a Fysetc S6\n");
    assert_eq!(verdict(&done.report, "heater_bed", "heater_pin").0, Kind::Decide);
    assert!(done.report.notes.iter().any(|note| note.text.contains("a comment or a name says fysetc s6")));
    for comment in ["", "# a Spider, with the pins of a Fysetc S6\n", "# not for the Fysetc S6\n"] {
        assert_eq!(verdict(&of(comment).report, "heater_bed", "heater_pin").0, Kind::Taken, "{comment}");
    }
}

/// Reproducer: a switch that Klipper refuses became a machine, at an end that nothing names.
#[test]
fn a_switch_that_klipper_refuses_is_refused() {
    let whole = std::fs::read_to_string(folder().join("bedslinger.cfg")).unwrap();
    let of = |lines: &str| {
        let text = whole.replacen("position_endstop = 0\nposition_max = 250", lines, 1);
        assert_ne!(text, whole);
        translate(&read(&text).unwrap(), Some(&corehbot_boards::spider::CONNECTORS))
    };
    for (lines, why) in [
        ("position_endstop = 125\nposition_max = 250.5", Some("neither end")),
        ("position_endstop = 63\nposition_max = 250", Some("neither end")),
        ("position_endstop = 62.5\nposition_max = 250", None),
        ("position_endstop = 187.5\nposition_max = 250", None),
        ("position_endstop = 125\nhoming_positive_dir = true\nposition_max = 250", None),
        ("position_endstop = -0.5\nposition_max = 250", Some("from 0 to 250")),
        ("position_endstop = -0.5\nposition_min = -1\nposition_max = 250", None),
        ("position_endstop = 251\nposition_max = 250", Some("from 0 to 250")),
        ("position_endstop = 0\nhoming_positive_dir = true\nposition_max = 250", Some("low end")),
        ("position_endstop = 250\nhoming_positive_dir = false\nposition_max = 250", Some("high end")),
    ] {
        match (of(lines), why) {
            (Ok(_), None) => {}
            (Err(said), Some(why)) => assert!(said.contains(why) && said.contains("position_endstop"), "{said}"),
            (done, _) => panic!("{lines}: {:?}", done.map(|done| done.text)),
        }
    }
}

/// Reproducer: a threshold within 0.5 of another motor's was told to be taken.
#[test]
fn values_of_one_group_are_equal_as_the_firmware_keeps_them() {
    let whole = std::fs::read_to_string(folder().join("bedslinger.cfg")).unwrap();
    let of = |x: &str, y: &str| {
        let motor =
            |axis: &str, key: &str| format!("[tmc2209 stepper_{axis}]\nuart_pin = PE7\nrun_current = 0.8\n{key}\n");
        let (kept, _) = whole.split_once("[tmc2209 stepper_x]").unwrap();
        let text = kept.to_owned() + &motor("x", x) + &motor("y", y);
        let done = translate(&read(&text).unwrap(), Some(&corehbot_boards::spider::CONNECTORS)).unwrap();
        let key = y.split(' ').next().unwrap();
        verdict(&done.report, "tmc2209 stepper_y", key).0
    };
    for (x, y, kind) in [
        ("stealthchop_threshold = 3.1", "stealthchop_threshold = 3.5", Kind::Decide),
        ("stealthchop_threshold = 3.1", "stealthchop_threshold = 3.1000000001", Kind::Taken),
        ("hold_current = 0.4", "hold_current = 0.401", Kind::Taken),
        ("hold_current = 0.4", "hold_current = 0.6", Kind::Taken),
        ("driver_sgthrs = 100", "driver_sgthrs = 101", Kind::Taken),
    ] {
        assert_eq!(of(x, y), kind, "{x}, {y}");
    }
}

/// Reproducer: of a part of a configuration "the main processor has no motors" was told.
#[test]
fn a_part_without_a_printer_is_told_so() {
    let said = translate(&read("[gcode_macro START]\ngcode:\n  G28\n").unwrap(), None).err().unwrap();
    assert!(said.contains("no printer is in it"), "{said}");
    let said = translate(&read("[printer]\nkinematics: corexy\n").unwrap(), None).err().unwrap();
    assert!(said.contains("cannot tell the board"), "{said}");
}
