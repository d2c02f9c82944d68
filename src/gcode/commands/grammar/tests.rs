//! Tests of grammar.

use super::*;
use crate::gcode::parse::parse;

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
