//! Lines of G-code by the machine's table: the errors in them, the parts that they are for, and their codes and names.

use corehbot::gcode::{Absent, ArcShape, ArcWords, AxisWords, Command, Flaw, MoveCommand, Number, Part};
use corehbot::machine::parse;
use std::collections::BTreeSet;

fn flaw(line: &str) -> Option<Flaw<'_>> {
    match parse(line.as_bytes()) {
        Command::Malformed(flaw) => Some(flaw),
        _ => None,
    }
}

#[test]
fn what_is_no_word_is_named() {
    for (line, word) in [
        ("G1 X1,5 Y2", "X1,5"),
        ("G1 Y2 X1.2.3", "X1.2.3"),
        ("G1 X--5", "X--5"),
        ("G1 X-", "X-"),
        ("G1 X. Y5", "X."),
        ("G1 X10\x01", "X10\x01"),
        ("G1 \x07X10", "\x07X10"),
        ("G1 X=5 Y6", "X=5"),
        ("G1 (a) X=5 Y6", "X=5"),
        ("G1 X5 Y6 %", "%"),
        ("G28 X,", "X,"),
        ("M203 X1,\u{b0}", "X1,"),
        ("G1 \"a b\" Y,", "Y,"),
        ("G1 \"a b", "\"a"),
        ("G92 X1..5", "X1..5"),
        ("G90 %", "%"),
        ("M83 %", "%"),
        ("M900 % K1", "%"),
    ] {
        assert_eq!(flaw(line), Some(Flaw::NoWord(word.as_bytes())), "{line:?}");
    }
}

#[test]
fn letters_that_need_a_number_have_one() {
    for (line, letter) in [
        ("G1 X", b'X'),
        ("G1 Xabc", b'X'),
        ("G0 Y5 F", b'F'),
        ("G1 Xnan", b'X'),
        ("G1 X\"10\"", b'X'),
        ("G1 X10 X", b'X'),
        ("G2 X5 I", b'I'),
        ("G4 S", b'S'),
        ("M92 E", b'E'),
        ("M204 P", b'P'),
        ("M220 S", b'S'),
        ("M900 K", b'K'),
        ("M593 F", b'F'),
        ("M84 S", b'S'),
        ("M205 B", b'B'),
        ("M572 W", b'W'),
        ("M304 I", b'I'),
    ] {
        assert_eq!(flaw(line), Some(Flaw::NoNumber(letter)), "{line}");
    }
}

#[test]
fn no_axis_no_second_command_and_no_time_before_now() {
    for line in ["G92 C0", "G28 C", "M84 C", "M18 C", "G2 X5 I5 C1", "M17 C"] {
        assert_eq!(flaw(line), Some(Flaw::NoAxis(b'C')), "{line}");
    }
    assert_eq!(flaw("G1 U5"), Some(Flaw::NoAxis(b'U')));
    assert_eq!(flaw("G1 X5 C"), Some(Flaw::NoNumber(b'C')));
    assert_eq!(flaw("G90 G1 X10"), Some(Flaw::SecondCommand(b"G1")));
    assert_eq!(flaw("G1 X10 Y5G1 X20"), Some(Flaw::SecondCommand(b"G1")));
    assert_eq!(flaw("G91 M 400"), Some(Flaw::SecondCommand(b"M 400")));
    assert_eq!(flaw("G4 P-5"), Some(Flaw::OutOfRange(b"P-5")));
    assert_eq!(flaw("G2 X1 R5 P-3"), Some(Flaw::OutOfRange(b"P-3")));
    assert_eq!(flaw("M84 S-1"), Some(Flaw::OutOfRange(b"S-1")));
    assert_eq!(flaw("M593 F-5"), Some(Flaw::OutOfRange(b"F-5")));
}

#[test]
fn what_slicers_and_people_write_is_in_order() {
    for line in [
        "G1X10Y20E-.04",
        "G1 X 10\tY 5. ; Z,",
        "G1 X1E5",
        "G1\u{a0}X10\u{a0}Y20",
        "G1 X5 S255 P0 (,)",
        "G28 W",
        "G28 X R5 L",
        "G28 X0 Y0",
        "M84 X Y E",
        "M400 U1",
        "M204 P500 T500",
        "M593 P\"mzv\" F60",
        "M900 K1e-05",
        "M115 U6.2.6+8948",
        "M117 50% = 1,5 mm",
        "M0 Insert the plate, please",
        "M112 %",
        "M108*",
        "M92 C100 V1:2",
        "M201 X5000 Y5000 W1:2",
        "M203 X300 A1:2",
        "M206 X0 U1:2",
        "M569 S1 C",
        "M851 Z-1.5 W1:2",
        "G35 U1:2",
        "G92",
        "G92 E",
        "G10 S1",
        "M622 J1 %",
        "G4 P0 S0",
        "M84 S0",
    ] {
        assert_eq!(flaw(line), None, "{line}");
    }
}

fn refused(line: &str) -> Option<(Part, &str)> {
    match parse(line.as_bytes()) {
        Command::Malformed(Flaw::Absent(Absent { part, which, .. })) => {
            Some((part, std::str::from_utf8(which).unwrap()))
        }
        _ => None,
    }
}

#[test]
fn words_for_parts_that_are_not_there_are_known_by_name() {
    for (line, part, which) in [
        ("T1", Part::Tool, ""),
        ("T255", Part::Tool, ""),
        ("M301 E1 P10 I1 D5", Part::Extruder, "1"),
        ("M301 H1 P10", Part::Heater, "1"),
        ("M304 H0 P1", Part::Heater, "0"),
        ("M572 D1 S0.05", Part::Extruder, "1"),
        ("M900 T1 K.2", Part::Extruder, "1"),
        ("M900 S1", Part::Slot, "1"),
        ("M900 K.1 L.2", Part::Other, ".2"),
        ("M569 S1 I1 X", Part::Driver, "1"),
        ("M92 T1 E400", Part::Extruder, "1"),
        ("M201 T1 E400", Part::Extruder, "1"),
        ("M203 T-1 E40", Part::Extruder, "-1"),
        ("M200 T1 D0", Part::Extruder, "1"),
        ("M84 E1", Part::Extruder, "1"),
        ("M17 X E1", Part::Extruder, "1"),
        ("SET_PRESSURE_ADVANCE EXTRUDER=extruder1 ADVANCE=.1", Part::Extruder, "extruder1"),
    ] {
        assert_eq!(refused(line), Some((part, which)), "{line}");
    }
}

#[test]
fn words_of_machines_with_one_extruder_are_obeyed() {
    for line in [
        "T0",
        "M200 D0",
        "M200 T0 D0",
        "M301 E0 P10",
        "M572 D0 S0.05",
        "M900 T0 K.2",
        "M900 S0 K.2",
        "M84 X Y E",
        "M84 X0 Y0 E0",
        "M204 P500 T500",
        "M205 T5",
        "M600 T1",
        "M105 T1",
        "SET_PRESSURE_ADVANCE EXTRUDER=extruder ADVANCE=.1",
    ] {
        assert_eq!(refused(line), None, "{line}");
    }
    for line in ["M900 T K1", "M572 D S.1"] {
        assert!(matches!(parse(line.as_bytes()), Command::Malformed(Flaw::NoNumber(_))), "{line}");
    }
}

#[test]
fn each_part_of_each_command_has_a_key_of_its_own() {
    let lines = ["M203 T1", "M203 T2", "M301 H1", "T1", "T2", "M304 H1", "M900 S1", "M900 T1", "M92 T1", "M301 E1"];
    let names = ["SET_PRESSURE_ADVANCE EXTRUDER=extruder1", "SET_PRESSURE_ADVANCE EXTRUDER=extruder2"];
    let key = |line: &str| match parse(line.as_bytes()) {
        Command::Malformed(Flaw::Absent(absent)) => absent.key(),
        other => panic!("{line}: {other:?}"),
    };
    let keys: BTreeSet<u32> = lines.into_iter().chain(names).map(key).collect();
    assert_eq!(keys.len(), lines.len() + names.len());
    assert_eq!(key("M203 T1 E50"), key("M203 E80 T1"));
}

#[test]
fn words_for_parts_of_heat_are_known_by_name() {
    for (line, part, which) in [
        ("M104 T1 S200", Part::Tool, "1"),
        ("M104 I1", Part::Preset, "1"),
        ("M109 S200 T2", Part::Tool, "2"),
        ("M106 I1", Part::Preset, "1"),
        ("M140 P1 S60", Part::Bed, "1"),
        ("M190 H0 S60", Part::Heater, "0"),
        ("M141 P1 S60", Part::Chamber, "1"),
        ("M303 T1 S200", Part::Tool, "1"),
        ("M116 P1", Part::Tool, "1"),
    ] {
        let Command::Malformed(Flaw::Absent(absent)) = parse(line.as_bytes()) else { panic!("{line}") };
        assert_eq!((absent.part, absent.which), (part, which.as_bytes()), "{line}");
    }
    for line in ["M104 T0 S200", "M109 S200 T0", "M106 P3 S100", "M140 P0 S60", "M141 P0 S40", "M303 E-1 S60", "M306 T"]
    {
        assert!(matches!(parse(line.as_bytes()), Command::Table(_)), "{line}");
    }
    for (line, letter) in
        [("M104 T", b'T'), ("M106 P", b'P'), ("M190 R", b'R'), ("M303 C", b'C'), ("M306 H", b'H'), ("M107 P", b'P')]
    {
        assert_eq!(parse(line.as_bytes()), Command::Malformed(Flaw::NoNumber(letter)), "{line}");
    }
    let key = |line: &'static str| match parse(line.as_bytes()) {
        Command::Malformed(Flaw::Absent(absent)) => absent.key(),
        other => panic!("{line}: {other:?}"),
    };
    let keys: BTreeSet<u32> = ["M104 T1", "M104 I1", "M140 I1", "M203 T1"].map(key).into();
    assert_eq!(keys.len(), 4);
}

fn number(text: &str) -> Option<Number> {
    Number::read(text.as_bytes()).map(|(number, _)| number)
}

#[test]
fn a_slicers_move() {
    let Command::Move(MoveCommand::Line { rapid: false, to, feed }) = parse(b"G1 X.5 Y-12.345 E-.04 F1800") else {
        panic!()
    };
    assert_eq!((to.x, to.y, to.z, to.e), (number("0.5"), number("-12.345"), None, number("-0.04")));
    assert_eq!(feed, number("1800"));
}

#[test]
fn the_last_of_two_equal_letters_wins() {
    assert_eq!(parse(b"G1 X10 X20"), parse(b"G1 X20"));
}

#[test]
fn a_spiral_hop_is_one_turn_without_x_and_y() {
    let command = parse(b"G3 Z.76 I.194 J1.201 P1  F30000");
    let Command::Move(MoveCommand::Arc(ArcWords { clockwise: false, to, shape, turns: 1, .. })) = command else {
        panic!()
    };
    assert_eq!((to.x, to.y, to.z), (None, None, number("0.76")));
    let [i, j] = ["0.194", "1.201"].map(|text| number(text).unwrap());
    assert_eq!(shape, ArcShape::Centre { i, j, k: Number::ZERO });
}

#[test]
fn an_arc_turns_at_least_once() {
    for (text, expected) in [("", 1), ("P0", 1), ("P1", 1), ("P3", 3), ("P1e9", 1), ("P99999", u16::MAX)] {
        let line = std::format!("G2 X1 R5 {text}");
        let Command::Move(MoveCommand::Arc(ArcWords { turns, .. })) = parse(line.as_bytes()) else { panic!() };
        assert_eq!(turns, expected, "{text}");
    }
}

#[test]
fn an_arc_without_a_centre_says_so() {
    let Command::Move(MoveCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Y1") else { panic!() };
    assert_eq!(shape, ArcShape::Missing);
    let Command::Move(MoveCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Y1 I3 R-2") else { panic!() };
    assert_eq!(shape, ArcShape::Radius(Number::from(-2)));
    let Command::Move(MoveCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Y1 J3") else { panic!() };
    let zero = Number::ZERO;
    assert_eq!(shape, ArcShape::Centre { i: zero, j: Number::from(3), k: zero });
    let Command::Move(MoveCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Z1 K3") else { panic!() };
    assert_eq!(shape, ArcShape::Centre { i: zero, j: zero, k: Number::from(3) });
}

#[test]
fn what_is_not_a_command_comes_back_as_it_came() {
    for line in [
        "my_print_end",
        "P0 S1",
        "Q603 X",
        "%",
        "(a) (never ends",
        "/G1 X5",
        "T",
        "T256",
        "G38",
        "G10 P0 S200",
        "G10 L2 P1 X0",
        "G5 X1",
        "M999999",
        "G92.1",
        "T0.5",
        "M",
        "(never ends",
    ] {
        assert_eq!(parse(std::format!(" \t{line} \r").as_bytes()), Command::Unknown(line.as_bytes()));
    }
}

#[test]
fn a_line_of_comments_is_no_command() {
    for line in ["(comment)", "()", "(a) (b)", "(a;b) ", " (M112)\r", "\u{feff}(a)", "(a) ; b"] {
        assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
    }
}

#[test]
fn a_comment_may_stand_before_the_code() {
    assert_eq!(parse(b"(home) ( all ) G28"), parse(b"G28"));
    assert_eq!(parse("\u{feff}G28".as_bytes()), parse(b"G28"));
    assert_eq!(parse("\u{a0}G28\u{a0}".as_bytes()), parse(b"G28"));
}

#[test]
fn every_axis_has_its_value() {
    let [x, y, z, e, feed] = [1, 2, 3, 4, 5].map(|n| Some(Number::from(n)));
    let to = AxisWords { x, y, z, e };
    for rapid in [true, false] {
        let line = std::format!("G{} X1 Y2 Z3 E4 F5", u8::from(!rapid));
        assert_eq!(parse(line.as_bytes()), Command::Move(MoveCommand::Line { rapid, to, feed }));
    }
    let shape = ArcShape::Radius(Number::from(6));
    for clockwise in [true, false] {
        let line = std::format!("G{} X1 Y2 Z3 E4 F5 R6", if clockwise { 2 } else { 3 });
        assert_eq!(
            parse(line.as_bytes()),
            Command::Move(MoveCommand::Arc(ArcWords { clockwise, to, feed, shape, turns: 1, decimals: 0 }))
        );
    }
}

#[test]
fn placeholders_of_templates_decide_nothing() {
    for line in ["{% set x = 1 %}", "[end_gcode]", "{extruder_temp}", "[iffy]", "{}", "[", "{%"] {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()), "{line}");
    }
}

#[test]
fn values_in_quotes_are_values() {
    assert_eq!(parse(b"M572 D\"0\" S0.05"), parse(b"M572 D0 S0.05"));
    for line in ["SET_GCODE_OFFSET Z=\"0.1\" MOVE=\"1\"", "SET_PRESSURE_ADVANCE EXTRUDER=\"extruder\" ADVANCE=\".03\""]
    {
        assert!(matches!(parse(line.as_bytes()), Command::Table(_)), "{line}");
    }
    for line in ["M593 F\"60\"", "G1 X\"0\"", "M572 D\"1\" S.1", "SET_GCODE_OFFSET Z=\"0.1"] {
        assert!(matches!(parse(line.as_bytes()), Command::Malformed(_)), "{line}: {:?}", parse(line.as_bytes()));
    }
}

#[test]
fn what_cannot_be_done_has_a_name() {
    for line in ["M622 J1", "M623", "if {x > 1}", "while true", "  ELSE", "break", "{if layer}"] {
        assert_eq!(parse(line.as_bytes()), Command::Condition, "{line}");
    }
    for line in ["iffy", "elsewhere X", "O100 sub", "whilefoo"] {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()), "{line}");
    }
}

#[test]
fn volumetric_extrusion_is_only_ever_switched_off() {
    for line in ["M200 D0", "M200 S0 D1.75", "M200"] {
        assert_eq!(parse(line.as_bytes()), Command::Silent);
    }
    for line in ["M200 D1.75", "M200 S1"] {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()));
    }
}

#[test]
fn what_is_another_firmwares_is_unknown() {
    for line in ["M915 D R", "M915 R1", "M915 X S3", "M569 P0 S0", "G10 P0 S200", "M104.1 S200", "M204.1 P500", "M74.1"]
    {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()), "{line}");
    }
}

#[test]
fn custom_code_of_real_profiles() {
    for (line, code) in [
        ("G92 E0; G1 E-10 F1200", ('G', 92)),
        ("G90;", ('G', 90)),
        ("G4 ; wait", ('G', 4)),
        ("G28 X0 Y0", ('G', 28)),
        ("M84 X Y E ;disable all but Z", ('M', 84)),
        ("M115 U6.2.6+8948", ('M', 115)),
        ("M117 E5 * ; x", ('M', 117)),
        ("T0", ('T', 0)),
    ] {
        let Command::Table(command) = parse(line.as_bytes()) else { panic!("{line}") };
        assert!(command.is(code.0, code.1), "{line}");
    }
    for line in [
        "M862.3 P \"MK4S\" ; printer model check",
        "M862.6 P \"Input shaper\"",
        "M486 ACube (1)*",
        "M486 T5",
        "M486 ASupport P5 (1)*",
        "M486",
        "M74 W5",
        "M300",
        "EXCLUDE_OBJECT_START NAME=cube",
        "EXCLUDE_OBJECT_END",
        "EXCLUDE_OBJECT",
        "EXCLUDE_OBJECT RESET=1",
        "Tx",
        "Tc",
        "T?",
        "(comment)",
    ] {
        assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
    }
    for line in ["M486 P1", "M486 C", "M486 S-1", "EXCLUDE_OBJECT NAME=cube", "EXCLUDE_OBJECT CURRENT=1"] {
        assert!(matches!(parse(line.as_bytes()), Command::Table(_)), "{line}");
    }
    for line in ["my_print_end", "P0 S1", "Q603 X1", "%", "/G1", "T0_PARK", "EXCLUDE_OBJECTS"] {
        assert_eq!(parse(line.as_bytes()), Command::Unknown(line.as_bytes()));
    }
}
