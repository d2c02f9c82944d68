//! Answers that a row of the table is too short for.

use super::asker::answers;

#[test]
fn the_firmware_names_itself_and_what_it_can_in_one_piece() {
    let heard = answers(&["M115 U6.2.6+8948"]);
    assert!(heard[0].starts_with("FIRMWARE_NAME:CoreH-bot ") && heard[0].contains(" EXTRUDER_COUNT:1 "), "{heard:?}");
    let caps = &heard[1..heard.len() - 1];
    assert!(caps.iter().all(|line| line.starts_with("Cap:")), "{heard:?}");
    for cap in ["AUTOREPORT_TEMP:1", "AUTOREPORT_POS:1", "EMERGENCY_PARSER:1", "HOST_ACTION_COMMANDS:1"] {
        assert!(caps.contains(&format!("Cap:{cap}")), "{cap}");
    }
    assert_eq!(heard.last().unwrap(), "ok");
}

#[test]
fn temperatures_stand_in_the_line_of_the_ok() {
    assert_eq!(answers(&["M105"]), ["ok T:0.00 /0.00 B:0.00 /0.00 @:0 B@:0"]);
    assert_eq!(answers(&["M105 T0"]), ["ok T:0.00 /0.00 B:0.00 /0.00 @:0 B@:0"]);
}

#[test]
fn the_outline_of_an_object_may_be_longer_than_a_line() {
    let outline = format!("EXCLUDE_OBJECT_DEFINE NAME=cube POLYGON=[{}]", "[100.5,100.5],".repeat(640));
    assert!(outline.len() > 8_900);
    assert_eq!(answers(&[&outline, "M114"])[0], "ok");
    let message = format!("M117 {}", "long ".repeat(200));
    assert_eq!(answers(&[&message]), ["ok"]);
    let moved = format!("G1 X5 {}", "X6 ".repeat(200));
    assert_eq!(answers(&[&moved]), ["echo:Line too long, ignored", "ok"]);
}

#[test]
fn reports_come_by_themselves_until_they_are_called_off() {
    let heard = answers(&["M155 S1", "M154 S2", "G4 S6.5", "M155 S0", "M154 S0", "G4 S5"]);
    let count = |line: &str| heard.iter().filter(|heard| heard.starts_with(line)).count();
    assert_eq!((count(" T:0.00 /0.00 B:0.00 /0.00 @:0 B@:0"), count("X:100.00 ")), (6, 3), "{heard:?}");
}

#[test]
fn a_position_reported_unasked_is_that_of_the_tool() {
    let heard = answers(&["M154 S1", "G1 X110 F120", "M400"]);
    let told: Vec<_> = heard.iter().filter(|line| line.starts_with("X:")).collect();
    assert!(told.len() >= 4 && told[1].starts_with("X:10") && !told[1].starts_with("X:110"), "{told:?}");
}

#[test]
fn shapers_may_have_the_names_of_another_firmware() {
    for (line, told) in [
        ("M593 P\"mzv\" F60", "  M593 X F60 D0.1 T2"),
        ("M593 P\"EI\" F50 S0.05", "  M593 X F50 D0.05 T3"),
        ("M593 P\"none\"", "  M593 X F0"),
    ] {
        let heard = answers(&["M593 F40", line, "M593"]);
        assert!(heard.contains(&told.to_owned()), "{line}: {heard:?}");
    }
}

#[test]
fn velocity_limits_are_obeyed_word_by_word() {
    let line = "SET_VELOCITY_LIMIT VELOCITY=9 ACCEL=2000 ACCEL_TO_DECEL=500 SQUARE_CORNER_VELOCITY=6";
    let heard =
        answers(&[line, "M204", "M205", "SET_VELOCITY_LIMIT", "SET_VELOCITY_LIMIT ACCEL_TO_DECEL=1500", "M503"]);
    for told in [
        "echo:SET_VELOCITY_LIMIT VELOCITY is not supported by this firmware",
        "  M204 P2000 R3000 T2000",
        "  M205 X6 Y6 E5 S0 T0 Z3000",
        "  SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.75",
        "echo:; SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.25",
    ] {
        assert!(heard.contains(&told.to_owned()), "{told}: {heard:?}");
    }
}

#[test]
fn the_report_of_the_settings_has_the_bed_and_homing() {
    let heard = answers(&["M503"]);
    for told in [
        "echo:; reachable: X390 Y417.6 Z335 mm",
        "echo:; homing X: down to 0 mm, 40 mm/s, 5 mm back, 5 mm/s",
        "echo:; serial lines: 250000 baud",
        "echo:; homing is not needed before moves",
    ] {
        assert!(heard.contains(&told.to_owned()), "{told}: {heard:?}");
    }
}
