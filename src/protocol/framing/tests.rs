//! Tests of framing.

extern crate std;

use super::*;

fn frame(line: &str) -> Frame {
    let mut bytewise = Frame::new();
    line.bytes().for_each(|byte| bytewise.push_typed(byte));
    // The same in runs.
    let mut frame = Frame::new();
    let mut after = line.as_bytes();
    while let Some((first, tail)) = after.split_first() {
        let count = frame.push_plain(after);
        after = if count > 0 { &after[count..] } else { tail };
        if count == 0 {
            frame.push_typed(*first);
        }
    }
    assert_eq!((frame.text(), frame.checksum(), frame.length), (bytewise.text(), bytewise.checksum(), bytewise.length));
    frame
}

fn is_good(frame: &Frame) -> bool {
    matches!(frame.checksum(), Checksum::Good(_))
}

#[test]
fn the_sum_of_a_real_line() {
    // As printcore opens a print.
    assert!(is_good(&frame("N-1 M110 N-1*125")));
    assert!(is_good(&frame("N0 M110 N0*125")));
    assert!(is_good(&frame("N1 M115*39")));
    assert_eq!(frame("N1 M115*39").before_checksum(), b"N1 M115");
    assert_eq!(frame("N1 M115*38").checksum(), Checksum::Bad);
    assert_eq!(frame("N1 M115").checksum(), Checksum::Missing);
}

#[test]
fn what_means_nothing_by_itself_is_taken_at_once() {
    for (text, count) in [("G1 X5 Y6", 8), ("G1 X5;c", 5), ("N1 M115*39", 7), ("M117 \"", 5), (" G1", 0), ("", 0)] {
        assert_eq!(Frame::new().push_plain(text.as_bytes()), count, "{text:?}");
    }
    assert_eq!(Frame::new().push_plain(&[b'x'; 2 * CAPACITY]), CAPACITY);
}

#[test]
fn what_may_follow_a_checksum() {
    for line in ["N1 M115*39  ", "N1 M115*39 ;x", "N1 M115* 39", " N1 M115*39", "\t N1 M115*39", "N1 M115*039"] {
        assert!(is_good(&frame(line)), "{line}");
    }
    for line in ["N1 M115*39x", "N1 M115*", "N1 M115*295", "N1 M115*3 9", "N1 M115*65575", "N1 M115*-39"] {
        assert_eq!(frame(line).checksum(), Checksum::Bad, "{line}");
    }
}

#[test]
fn the_last_asterisk_counts_wherever_it_stands() {
    for body in ["N5 M117 2*3*4", "N5 G1 X1 ;a*b", "N5 M117 \"*\"", "N5 M117 a\\*b"] {
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        assert!(is_good(&frame(&std::format!("{body}*{sum}"))), "{body}");
    }
}

#[test]
fn comments_are_taken_out_but_not_of_strings() {
    assert_eq!(frame("G1 X5 ;Y6").text(), b"G1 X5 ");
    assert_eq!(frame("; all of it").text(), b"");
    assert_eq!(frame("M862.3 P\"a;b\" ;c").text(), b"M862.3 P\"a;b\" ");
    assert_eq!(frame("M117 a\\;b;c").text(), b"M117 a\\;b");
    // A backslash concerns the next byte alone.
    assert_eq!(frame("M117 a\\b;c").text(), b"M117 a\\b");
    assert_eq!(frame("M117 5\" pipe ;b").text(), b"M117 5\" pipe ;b");
}

#[test]
fn a_semicolon_in_parentheses_begins_no_comment() {
    for (line, text) in [
        ("G1 X5 (a;b) Y6 ;c", "G1 X5 (a;b) Y6 "),
        ("G1 (a) X5 ;b (c) d", "G1 (a) X5 "),
        ("G1 X5 (a ; b", "G1 X5 (a "),
        ("G1 X5 (a;(b) c", "G1 X5 (a"),
        ("G1 X5 ;a) b", "G1 X5 "),
        ("G1 X5 (a(b;c) Y6", "G1 X5 (a(b;c) Y6"),
        ("G1 X5 (5\";b) Y6;c", "G1 X5 (5\";b) Y6"),
        ("G1 X5 ) Y6;c", "G1 X5 ) Y6"),
        ("M117 \"(\" ;c", "M117 \"(\" "),
    ] {
        assert_eq!(frame(line).text(), text.as_bytes(), "{line}");
    }
    let line = "N5 G1 X5 (a;b) Y6";
    let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
    let whole = frame(&std::format!("{line}*{sum}"));
    assert!(is_good(&whole) && whole.before_checksum() == line.as_bytes());
    assert!(!frame(&std::format!("G1 X5 (a;{}", "x".repeat(9000))).is_too_long());
}

#[test]
fn what_is_typed_can_be_erased_and_what_a_host_sends_cannot() {
    for (line, text) in [
        ("G1 X10\x08\x085", "G1 X5"),
        ("\x08\x7FG28\x08\x7F1\x7F0", "G0"),
        ("G1 X5 ;ab\x08\x08\x08Y6", "G1 X5 Y6"),
        ("P\"a;\x08\x08b\";c", "P\"b\""),
        ("G1 (;\x08\x08X5;c", "G1 X5"),
        ("G1 X(;(\x08\x08\x085", "G1 X5"),
        ("G1*34\x08\x08\x08 X5", "G1 X5"),
        ("G28\x08\x08\x08\x08", ""),
    ] {
        assert_eq!(frame(line).text(), text.as_bytes(), "{line:?}");
    }
    assert_eq!(frame("G1*34\x08\x08\x08").checksum(), Checksum::Missing);
    // A damaged line of a host keeps the erasing byte, or it might pass: HH became H and a backspace.
    let sum = "N5 M117 HH".bytes().fold(0, |sum, byte| sum ^ byte);
    assert_eq!(frame(&std::format!("N5 M117 H\x08*{sum}")).checksum(), Checksum::Bad);
    let long = std::format!("M117 {}{}", "x".repeat(9000), "\x08".repeat(9000));
    assert_eq!(frame(&long).text(), b"M117 ");
    // The last kept character is erased, with its effect on the state.
    let full = "x".repeat(CAPACITY - 1);
    assert_eq!(frame(&std::format!("{full}\"\x08;c")).text(), full.as_bytes());
}

#[test]
fn a_long_line_is_verified_to_its_end() {
    let body = std::format!("N7 M117 {}", "x".repeat(9000));
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    let long = frame(&std::format!("{body}*{sum}"));
    assert!(is_good(&long));
    assert!(long.is_too_long_before_checksum());
    assert_eq!(long.text(), &body.as_bytes()[..CAPACITY]);
    assert!(!frame(&std::format!("G1 X5;{}", "x".repeat(9000))).is_too_long());
}

#[test]
fn a_full_line_may_still_have_a_checksum() {
    let body = std::format!("N7 M117 {}", "x".repeat(CAPACITY - 8));
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    let full = frame(&std::format!("{body}*{sum}"));
    assert!(is_good(&full));
    assert!(!full.is_too_long_before_checksum());
    assert_eq!(full.before_checksum(), body.as_bytes());
}

#[test]
fn a_line_is_too_long_from_the_first_byte_that_is_not_kept() {
    for (length, is_too_long) in [(CAPACITY - 1, false), (CAPACITY, false), (CAPACITY + 1, true), (9000, true)] {
        let line = frame(&"x".repeat(length));
        assert_eq!((line.is_too_long(), line.is_too_long_before_checksum()), (is_too_long, is_too_long), "{length}");
    }
}

#[test]
fn a_line_has_begun_with_its_first_byte_that_is_no_blank() {
    for (text, is_empty) in [("", true), (" \t", true), ("G", false), (" G", false), (";", false), ("*", false)] {
        assert_eq!(frame(text).is_empty(), is_empty, "{text:?}");
    }
}
