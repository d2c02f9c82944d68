//! Tests of emergency.

extern crate std;

use super::*;
use std::vec::Vec;

/// The emergencies of a text, and the text's length up to the first.
fn scan(text: &str) -> Vec<Emergency> {
    let mut scanner = Scanner::new();
    text.bytes().filter_map(|byte| scanner.read(byte)).collect()
}

#[test]
fn an_emergency_comes_in_many_dresses() {
    for text in [
        "M112\n",
        "M112\r\n",
        "m112\n",
        " M112 \n",
        "M 112\n",
        "N5 M112*34\n",
        "N-1M112*9\n",
        "n 5\tm0112\n",
        "M112 ;now\n",
        "M112(now)\n",
        "\0M\x0011\x002\n",
        "G1 X5\nM112\n",
        "M112*\n",
        "M112 S1\n",
        "\x08\x7FM112\n",
    ] {
        assert_eq!(scan(text), [Emergency::Stop], "{text:?}");
    }
    assert_eq!(scan("N4 M108*46\nM410\n"), [Emergency::Continue, Emergency::QuickStop]);
    assert_eq!(scan("M999\nN5 m999 S1*3\n"), [Emergency::Restart; 2]);
    for text in ["M24\n", "M602 ;go\n", "N7 M876 S0*12\n", "m876s1\n", "M876  S\n"] {
        assert_eq!(scan(text), [Emergency::Resume], "{text:?}");
    }
    for text in
        ["RESUME\n", "resume ;go\n", "N7 RESUME*12\n", "N7RESUME\r\n", "RESUME VELOCITY=50\n", "G1 X5\n RESUME \n"]
    {
        assert_eq!(scan(text), [Emergency::Resume], "{text:?}");
    }
    for text in ["CANCEL_PRINT\n", "N12 cancel_print*7\n", "CANCEL_PRINT\t\n"] {
        assert_eq!(scan(text), [Emergency::Cancel], "{text:?}");
    }
}

#[test]
fn a_false_alarm_would_ruin_a_print() {
    for text in [
        "M112",
        "M1125\n",
        "M11\n",
        "M1120\n",
        ";M112\n",
        "M117 M112\n",
        "G1 M112\n",
        "M117 x;M112\n",
        "(M112)\n",
        "M112.1\n",
        "M112_X\n",
        "M1 12\n",
        "NM112\n",
        "XM112\n",
        "N5 N6 M112\n",
        "M67648\n",
        "M-112\n",
        "MM112\n",
        "M876\n",
        "M876 P1\n",
        "M876 P1 S0\n",
        "M876xS1\n",
        "M8760 S0\n",
        "M240\n",
        "M112\x08\x08\x0805\n",
        "M112 \x7F\n",
        "M9990\n",
        "M99\n",
        "RESUME",
        "RESUM\n",
        "RESUME_BASE\n",
        "BASE_RESUME\n",
        "RESUME2\n",
        "RESUMES\n",
        "RE SUME\n",
        "RESUME\x08\n",
        "M117 RESUME\n",
        ";CANCEL_PRINT\n",
        "CANCEL\n",
        "CANCEL_PRINT_BASE\n",
        "N CANCEL_PRINT\n",
        "RANCEL_PRINT\n",
    ] {
        assert_eq!(scan(text), [], "{text:?}");
    }
}

#[test]
fn damage_lasts_to_the_end_of_the_line() {
    let mut scanner = Scanner::new();
    for begun in ["", "M11", "M112"] {
        begun.bytes().for_each(|byte| assert_eq!(scanner.read(byte), None));
        scanner.spoil();
        assert!("M112"[begun.len()..].bytes().all(|byte| scanner.read(byte).is_none()));
        assert_eq!(scanner.read(b'\n'), None, "{begun}");
    }
    assert_eq!(b"M112\n".iter().find_map(|&byte| scanner.read(byte)), Some(Emergency::Stop));
}
