//! Tests of parse.

extern crate std;

use super::super::commands::{MotionCommand, MotorCommand, SettingCommand};
use super::super::number::Number;
use super::super::parts::{ArcShape, ArcWords, AxisFlags, AxisWords, Flaw, HomeWords, PlainWords};
use super::*;
use crate::settings::plain::MOST_WORDS;

fn number(text: &str) -> Option<Number> {
    Number::read(text.as_bytes()).map(|(number, _)| number)
}

#[test]
fn a_slicers_move() {
    let Command::Motion(MotionCommand::Line { rapid: false, to, feed }) = parse(b"G1 X.5 Y-12.345 E-.04 F1800") else {
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
    let Command::Motion(MotionCommand::Arc(ArcWords { clockwise: false, to, shape, turns: 1, .. })) = command else {
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
        let Command::Motion(MotionCommand::Arc(ArcWords { turns, .. })) = parse(line.as_bytes()) else { panic!() };
        assert_eq!(turns, expected, "{text}");
    }
}

#[test]
fn an_arc_without_a_centre_says_so() {
    let Command::Motion(MotionCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Y1") else { panic!() };
    assert_eq!(shape, ArcShape::Missing);
    let Command::Motion(MotionCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Y1 I3 R-2") else { panic!() };
    assert_eq!(shape, ArcShape::Radius(Number::from(-2)));
    let Command::Motion(MotionCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Y1 J3") else { panic!() };
    let zero = Number::ZERO;
    assert_eq!(shape, ArcShape::Centre { i: zero, j: Number::from(3), k: zero });
    let Command::Motion(MotionCommand::Arc(ArcWords { shape, .. })) = parse(b"G2 X1 Z1 K3") else { panic!() };
    assert_eq!(shape, ArcShape::Centre { i: zero, j: zero, k: Number::from(3) });
}

#[test]
fn dwelling_adds_seconds_and_milliseconds() {
    assert_eq!(parse(b"G4"), Command::Motion(MotionCommand::Dwell { ms: 0 }));
    assert_eq!(parse(b"G4 P250"), Command::Motion(MotionCommand::Dwell { ms: 250 }));
    assert_eq!(parse(b"G4 S1.5 P1"), Command::Motion(MotionCommand::Dwell { ms: 1501 }));
    assert_eq!(parse(b"G4 S999999999 P999999999"), Command::Motion(MotionCommand::Dwell { ms: 1_000_000_000 }));
}

#[test]
fn homing_knows_flags_and_ignores_the_rest() {
    let words = |x, y, z| HomeWords { axes: AxisFlags { x, y, z, e: false }, ..HomeWords::default() };
    let home = |x, y, z| Command::Motion(MotionCommand::Home(words(x, y, z)));
    assert_eq!(parse(b"G28"), home(false, false, false));
    assert_eq!(parse(b"G28 X Y"), home(true, true, false));
    assert_eq!(parse(b"G28 X0 Y0"), home(true, true, false));
    let dropped = HomeWords { drops_mesh: true, ..words(false, false, false) };
    assert_eq!(parse(b"G28 W"), Command::Motion(MotionCommand::Home(dropped)));
    let raised = HomeWords { raise: number("5"), ..words(true, false, false) };
    assert_eq!(parse(b"G28 X R5"), Command::Motion(MotionCommand::Home(raised)));
    let lost = HomeWords { only_lost: true, ..words(false, false, false) };
    assert_eq!(parse(b"G28 O"), Command::Motion(MotionCommand::Home(lost)));
    assert_eq!(parse(b"G28 XY"), home(true, true, false));
    assert_eq!(parse(b"G28 R-5"), Command::Malformed(Flaw::OutOfRange(b"R-5")));
    assert_eq!(parse(b"G28 E"), home(false, false, false));
    assert_eq!(parse(b"g28z"), home(false, false, true));
}

#[test]
fn naming_the_position() {
    let zero = Some(Number::ZERO);
    let e = Command::Motion(MotionCommand::SetPosition(AxisWords { e: zero, ..AxisWords::default() }));
    assert_eq!(parse(b"G92 E0; G1 E-10 F1200"), e);
    assert_eq!(parse(b"G92 E"), e);
    let all = Command::Motion(MotionCommand::SetPosition(AxisWords { x: zero, y: zero, z: zero, e: zero }));
    assert_eq!(parse(b"G92"), all);
}

#[test]
fn what_is_not_a_command_comes_back_as_it_came() {
    for line in [
        "print_end",
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
        assert_eq!(parse(line.as_bytes()), Command::Motion(MotionCommand::Line { rapid, to, feed }));
    }
    let shape = ArcShape::Radius(Number::from(6));
    for clockwise in [true, false] {
        let line = std::format!("G{} X1 Y2 Z3 E4 F5 R6", if clockwise { 2 } else { 3 });
        assert_eq!(
            parse(line.as_bytes()),
            Command::Motion(MotionCommand::Arc(ArcWords { clockwise, to, feed, shape, turns: 1, decimals: 0 }))
        );
    }
    assert_eq!(parse(b"G92 X1 Y2 Z3 E4"), Command::Motion(MotionCommand::SetPosition(to)));
    let mut numbers = [None; MOST_WORDS];
    numbers[..4].copy_from_slice(&[x, y, z, e]);
    assert_eq!(parse(b"M92 X1 Y2 Z3 E4"), Command::Setting(SettingCommand::Plain(PlainWords { code: 92, numbers })));
    let none = AxisFlags::default();
    for (letter, axis) in [
        ('X', AxisFlags { x: true, ..none }),
        ('Y', AxisFlags { y: true, ..none }),
        ('Z', AxisFlags { z: true, ..none }),
        ('E', AxisFlags { e: true, ..none }),
    ] {
        assert_eq!(parse(std::format!("M17 {letter}").as_bytes()), Command::Motor(MotorCommand::EnableMotors(axis)));
    }
}

#[test]
fn every_g_code_has_its_command() {
    for (line, command) in [
        ("G10", Command::Motion(MotionCommand::Retract)),
        ("G10 S1", Command::Motion(MotionCommand::Retract)),
        ("G11", Command::Motion(MotionCommand::Recover)),
        ("G12", Command::Silent),
        ("G90", Command::Motion(MotionCommand::Absolute)),
        ("G91", Command::Motion(MotionCommand::Relative)),
        ("T0", Command::Motion(MotionCommand::Tool)),
    ] {
        assert_eq!(parse(line.as_bytes()), command, "{line}");
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
    for (quoted, plain) in [
        ("M572 D\"0\" S0.05", "M572 D0 S0.05"),
        ("SET_GCODE_OFFSET Z=\"0.1\" MOVE=\"1\"", "SET_GCODE_OFFSET Z=0.1 MOVE=1"),
        ("SET_PRESSURE_ADVANCE EXTRUDER=\"extruder\" ADVANCE=\".03\"", "SET_PRESSURE_ADVANCE ADVANCE=.03"),
    ] {
        assert_eq!(parse(quoted.as_bytes()), parse(plain.as_bytes()), "{quoted}");
    }
    for line in ["M593 F\"60\"", "G1 X\"0\"", "M572 D\"1\" S.1", "SET_GCODE_OFFSET Z=\"0.1"] {
        assert!(matches!(parse(line.as_bytes()), Command::Malformed(_)), "{line}: {:?}", parse(line.as_bytes()));
    }
}
