//! Tests of lexer.

extern crate std;

use super::*;
use std::string::{String, ToString};
use std::vec::Vec;

/// The words, printed the shortest way.
fn words(text: &str) -> Vec<String> {
    let print = |word: Word| {
        let mut text = (word.letter as char).to_string();
        if let Some(number) = word.number {
            text += &number.to_string();
        }
        text
    };
    Words::new(text.as_bytes()).map(print).collect()
}

#[test]
fn spaces_are_where_people_put_them() {
    for text in ["X10Y20E-.04", " X 10 Y 20 E -.04 ", "x10\ty20\te-0.04", "X10  Y20 E-.04 ; Z9"] {
        assert_eq!(words(text), ["X10", "Y20", "E-0.04"], "{text}");
    }
}

#[test]
fn an_exponent_is_another_word() {
    assert_eq!(words("X1E5"), ["X1", "E5"]);
    assert_eq!(words("X1e-3"), ["X1", "E-0.003"].map(|w| w.replace("0.003", "3")));
    assert_eq!(words("K1e-05"), ["K1", "E-5"]);
}

#[test]
fn flags_have_no_number() {
    assert_eq!(words(" X Y"), ["X", "Y"]);
    assert_eq!(words("X- Y. Z-.E"), ["X", "Y", "Z", "E"]);
    assert_eq!(words("XYZ"), ["X", "Y", "Z"]);
}

#[test]
fn glued_rubbish_is_skipped() {
    assert_eq!(words(" U6.2.6+8948 S1"), ["U6.2", "S1"]);
    assert_eq!(words("X1*Y2 Z3"), ["X1", "Z3"]);
    assert_eq!(words("X=5 Y6"), ["X", "Y6"]);
    assert_eq!(words("%*# \u{fc}X5 Y6"), ["Y6"]);
    assert_eq!(words("X - 5 Y6"), ["X", "Y6"]);
}

#[test]
fn what_is_skipped_is_noted() {
    let has_skipped = |text: &str| {
        let mut words = Words::new(text.as_bytes());
        words.by_ref().for_each(drop);
        words.has_skipped()
    };
    for text in
        ["X1,5", "X1.2.3", "X--5", "X-", "X.", "X1\x01", "\x07X1", "X1*Y2", "X=5", "% X5", "A\"open", "X1\u{e4}"]
    {
        assert!(has_skipped(text), "{text:?}");
    }
    for text in ["", "X1Y2", "X 1\tY-.5", "X1\u{a0}Y2\u{a0}", "X1 (,) Y2;,", "P\"a,b\" S1", "X1E5", "XY", "X+5 Y5."] {
        assert!(!has_skipped(text), "{text:?}");
    }
    assert_eq!(words("X\u{a0}1\u{a0}Y2"), ["X1", "Y2"]);
    assert_eq!(Words::new(b"P \"mzv\" F60").next().and_then(|word| word.quoted), Some(&b"mzv"[..]));
}

#[test]
fn comments_and_strings_hide_their_letters() {
    assert_eq!(words("X1 (Y2) Z3;E4"), ["X1", "Z3"]);
    assert_eq!(words("X1(Y2)Z3 (E4"), ["X1", "Z3"]);
    assert_eq!(words("P\"Input shaper; X5\" S1"), ["P", "S1"]);
    assert_eq!(words("P \"MK4S\"S1"), ["P", "S1"]);
    assert_eq!(words("\"X5\" S1 A\"never ends X5"), ["S1", "A"]);
}
