//! Forms of configurations: lines, order, spelling, and any text.

use super::{folder, read, translated, verdict};
use crate::configurations;
use corehbot_machine_file::klipper::translate;
use proptest::prelude::*;

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
        ("#\n[include printer.cfg]", "printer.cfg:2: error: printer.cfg includes itself"),
        ("[include p*.cfg]", "printer.cfg:1: error: printer.cfg includes itself"),
    ] {
        let said = read(text).unwrap_err();
        assert!(said[0].starts_with(told), "{text}: {said:?}");
    }
    // A pattern may mean no file.
    assert!(read("[include x/*.cfg]").unwrap().missing.is_empty());
    // A file that is not there is told, and the rest is read.
    let done = super::of_text("[include no.cfg]\n[printer]\nkinematics: corexy\n");
    let told = "printer.cfg:1: there is no file no.cfg: copy it";
    assert!(done.report.notes.iter().any(|note| note.text.starts_with(told)) && !done.is_whole());
    assert!(done.text.contains("\nsquare_corner = 5"), "{}", done.text);
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

/// V2.2 of the Spider has fans elsewhere than the older ones. Without a fan it is the table that every Spider starts
/// with.
#[test]
fn fans_tell_which_spider_it_is() {
    let step = "[stepper_x]\nstep_pin: PE11\n";
    for (fan, board) in [
        ("[fan]\npin: PB0\n", "spider-v1"),
        ("[heater_fan hotend]\npin: !PB1\n[fan]\npin: PB2\n", "spider-v1"),
        ("[fan]\npin: PA14\n", "spider"),
        ("[fan]\npin: PB2\n", "spider"),
        ("# a Fysetc Spider\n", "spider"),
        ("", "spider"),
    ] {
        let text = format!("{step}{fan}");
        assert_eq!(translate(&read(&text).unwrap(), None).unwrap().report.board.key, board, "{text}");
    }
}

/// A note on another board with the same pins comes later.
#[test]
fn the_first_board_that_is_named_counts() {
    for (text, board) in [
        ("# For the OctoPus V1\n[stepper_x]\nstep_pin: PF13 # as on the Octopus Pro", "octopus"),
        ("# octopus_pro\n# octopus\n[stepper_x]\nstep_pin: PF13", "octopus-pro"),
        ("# for an Octopus\n# Pro\n[stepper_x]\nstep_pin: PF13", "octopus-pro"),
        ("[mcu]\nserial: /dev/serial/by-id/usb-octopus-pro-if00\n[stepper_x]\nstep_pin: PF13", "octopus-pro"),
        ("# octopus\n[stepper_x]\nstep_pin: PE11", "spider"),
        ("# Not for the Octopus Pro. This is a BTT Octopus v1.1\n[stepper_x]\nstep_pin: PF13", "octopus"),
        ("# This is not an Octopus, but the Octopus Pro\n[stepper_x]\nstep_pin: PF13", "octopus-pro"),
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
    assert!(translate(&config, None).is_err_and(|said| said.contains("octopus and octopus-pro have these pins")));
}

/// A board is one with all pins of motors, heaters and sensors: single ones are on many boards.
#[test]
fn a_board_that_is_not_here_is_refused_with_the_nearest_one() {
    // An SKR Mini E3's: by its step pins it was a CNC shield.
    let skr = "[mcu]\nserial: /dev/serial/by-id/usb-Klipper_stm32f103xe_1-if00\n\
               [stepper_x]\nstep_pin: PB13\ndir_pin: !PB12\nenable_pin: !PB14\n\
               [stepper_y]\nstep_pin: PB10\ndir_pin: !PB2\nenable_pin: !PB11\n\
               [stepper_z]\nstep_pin: PB0\ndir_pin: PC5\nenable_pin: !PB1\n\
               [extruder]\nstep_pin: PB3\ndir_pin: !PB4\nenable_pin: !PD2\nheater_pin: PC8\nsensor_pin: PA0\n";
    let octopus = "# octopus\n[stepper_x]\nstep_pin: PF13\ndir_pin: PF12\nenable_pin: !PF14\n";
    for (text, told) in [
        (skr.to_owned(), &["an STM32F103XE, is not supported", "nearest", "[stepper_x] step_pin PB13"][..]),
        (format!("{octopus}[extruder]\nheater_pin: PA0\n"), &["differs in [extruder] heater_pin PA0)"]),
        (format!("{octopus}[mcu]\nserial: /dev/x_stm32h723xx_1\n"), &["is an STM32H723", "images for the STM32F446"]),
        (format!("{octopus}[mcu]\nserial: usb-Klipper_stm32f407xx_1\n"), &["is an STM32F407", "not supported"]),
        ("# Fysetc S6\n[stepper_x]\nstep_pin: PE11\n".to_owned(), &["says fysetc s6"]),
        ("# octopus pro v1.1\n[stepper_x]\nstep_pin: PF13\n".to_owned(), &["says octopus pro v1.1"]),
        ("[mcu a]\n[stepper_x]\nstep_pin: a:PF13\n".to_owned(), &["main processor has no motors"]),
        // All of its motors on headers.
        ("[stepper_x]\nstep_pin: PE8\ndir_pin: PE9\n".to_owned(), &["not supported"]),
    ] {
        let said = translate(&read(&text).unwrap(), None).err().unwrap_or_else(|| panic!("{text}"));
        assert!(told.iter().all(|told| said.contains(told)) && said.contains("--board"), "{text}: {said}");
    }
    for more in [
        // Not driven yet, but printed; on headers; on another processor.
        "[heater_generic a]\nheater_pin: PB10\nsensor_pin: PF8\n",
        "[manual_stepper a]\nstep_pin: PE8\ndir_pin: PE9\nenable_pin: PE10\n",
        "[mcu b]\n[stepper_y]\nstep_pin: b:PB13\ndir_pin: b:PC9\n",
        "[temperature_sensor a]\nsensor_type: MAX31865\nsensor_pin: PG0\n",
        "[mcu]\nserial: usb-Klipper_stm32f446xx_1\n",
    ] {
        let done = translate(&read(&format!("{octopus}{more}")).unwrap(), None).unwrap_or_else(|said| panic!("{said}"));
        assert_eq!(done.report.board.key, "octopus");
    }
    // Whoever names the board learns that its processor has no image.
    let text = format!("{octopus}[mcu]\nserial: usb-Klipper_stm32f407xx_1\n");
    let done = translate(&read(&text).unwrap(), Some(&corehbot_boards::octopus::CONNECTORS)).unwrap();
    assert_eq!(verdict(&done.report, "mcu", "serial").0, corehbot_machine_file::Kind::Decide);
    let done = translate(&read(skr).unwrap(), Some(&corehbot_boards::octopus::CONNECTORS)).unwrap();
    assert_ne!(verdict(&done.report, "mcu", "serial").0, corehbot_machine_file::Kind::Decide);
}

/// With a foreign pin only the pin is lost.
#[test]
fn on_another_board_all_is_kept_that_is_not_a_pin() {
    let text = "[stepper_x]\nstep_pin: PB13\ndir_pin: !PB12\nenable_pin: !PB14\nendstop_pin: ^!PC0\n\
                [stepper_y]\nstep_pin: PB10\ndir_pin: PB2\nendstop_pin: ^PC1\nrotation_distance: 40\n\
                microsteps: 16\n[printer]\nkinematics: cartesian\n[tmc2209 stepper_x]\nuart_pin: PC11\n\
                run_current: 0.58\n[heater_fan a]\npin: PC7\nmax_power: 0.5\nheater_temp: 45\n\
                [fan]\npin: PC6\noff_below: 0.1\n";
    let done = super::of_text(text);
    for line in [
        "\nx = \"!\"  # no socket\n",
        "\ny = \"\"  # no socket\n",
        "\nx = \"!\"  # to decide\n",
        "\ny = \"\"  # to decide\n",
        "current_ma = 580",
        "[fans.fan0]\nrole = \"hotend\"  # printer.cfg:18\nmost = 0.5  # printer.cfg:19\n",
        "[fans.fan1]\nrole = \"part\"  # printer.cfg:22\nleast = 0.1",
        "hotend_fan_above = 45",
    ] {
        assert!(done.text.contains(line), "{line}: {}", done.text);
    }
    assert!(done.machine.is_none(), "its plugs are to be decided");
    use corehbot_machine_file::Kind::{Decide, NotNeeded, Taken};
    for (section, key, kind) in [
        ("stepper_x", "step_pin", Decide),
        ("stepper_x", "dir_pin", Taken),
        ("stepper_x", "enable_pin", NotNeeded),
        ("stepper_x", "endstop_pin", Decide),
        ("tmc2209 stepper_x", "uart_pin", NotNeeded),
        ("fan", "pin", Decide),
    ] {
        assert_eq!(verdict(&done.report, section, key).0, kind, "[{section}] {key}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_text_has_a_verdict_for_every_key(choice in any::<u8>(), text in any_config()) {
        configurations::any(&[&[choice], text.as_bytes()].concat());
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
        "[\u{0}-\u{1f}\u{7f}-\u{a0}\u{2028}]{0,4}",
    ];
    let line = prop_oneof![
        4 => (key, value).prop_map(|(key, value)| format!("{key}: {value}\n")),
        1 => section.clone().prop_map(|section| format!("[{section}]\n")),
        1 => any::<char>().prop_map(|letter| format!("[heater_generic chamber{letter}]\n")),
        1 => "[ -~\t]{0,30}\n",
    ];
    (section, prop::collection::vec(line, 0..60))
        .prop_map(|(section, lines)| format!("[{section}]\n{}", lines.concat()))
}
