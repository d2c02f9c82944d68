//! Tests of clamps.

extern crate std;

use super::*;
use crate::units::{Mm, MmPerSec2, Seconds};
use std::string::{String, ToString};
use std::vec::Vec;

fn number(text: &str) -> Number {
    Number::read(text.as_bytes()).unwrap().0
}

fn texts(clamps: &Clamps) -> Vec<String> {
    clamps.list.iter().map(ToString::to_string).collect()
}

#[test]
fn what_is_in_range_is_set_and_not_reported() {
    let (mut clamps, modal) = (Clamps::new(), Modal::new());
    for (text, bits) in [("0.01", 0.01), ("3000", 3000.0), ("250.3", 250.3), ("0.1234567", 0.123_456_7)] {
        let mut speed = MmPerSec::ONE;
        clamps.length(&modal, ["M203", "X"], number(text), ranges::SPEED, &mut speed);
        assert!((speed.to_num::<f64>() - bits).abs() < 1e-4);
    }
    for text in ["0", "4", "0.00001", "3.9999999"] {
        let mut time = Seconds::ONE;
        clamps.near(["M900", "K"], number(text), ranges::ADVANCE, &mut time);
        assert_eq!(time, nearest::<Seconds>(number(text)));
    }
    for text in ["0.001", "1"] {
        let deviation = clamps.length_of(&modal, ["M205", "J"], number(text), ranges::TOLERANCE, None);
        assert_eq!(deviation, Some(Mm::from_num(number(text).value())));
    }
    for text in ["0.6", "180000", "1800"] {
        assert!(clamps.feed(&modal, Some(number(text))).is_some());
    }
    assert_eq!(clamps.whole_of(["M113", "S"], number("60.9"), Range { least: 0, most: 60 }, None), Some(60));
    assert_eq!(texts(&clamps), [""; 0]);
    assert!(!clamps.refuses_line());
}

#[test]
fn what_is_beyond_stays_as_it_was_in_the_units_of_the_line() {
    let (mut clamps, mut modal) = (Clamps::new(), Modal::new());
    let mut speed = MmPerSec::from_num(300);
    clamps.length(&modal, ["M203", "X"], number("99999"), ranges::SPEED, &mut speed);
    assert!(clamps.refuses_line());
    let mut acceleration = MmPerSec2::from_num(5000);
    clamps.length(&modal, ["M201", "X"], number("0"), ranges::ACCELERATION, &mut acceleration);
    // A type without a sign holds 0 of it, which is legal.
    let mut time = Seconds::lit("0.05");
    clamps.near(["M900", "K"], number("-1"), ranges::ADVANCE, &mut time);
    clamps.near(["M900", "K"], number("30"), ranges::ADVANCE, &mut time);
    modal.inches = true;
    clamps.length(&modal, ["M203", "X"], number("200"), ranges::SPEED, &mut speed);
    assert_eq!((speed, acceleration, time), (MmPerSec::from_num(300), MmPerSec2::from_num(5000), Seconds::lit("0.05")));
    assert_eq!(clamps.whole_of(["M914", "X"], number("-5"), Range { least: 0, most: 255 }, None), None);
    assert_eq!(
        texts(&clamps),
        [
            "M203 ignored: X99999 is out of range (0.01 to 3000), stays 300; speeds are in mm/s",
            "M201 ignored: X0 is out of range (1 to 100000), stays 5000",
            "M900 ignored: K-1 is out of range (0 to 4), stays 0.05",
            "M900 ignored: K30 is out of range (0 to 4), stays 0.05; K is in seconds (Linear Advance 1.5); \
             a profile for Linear Advance 1.0 means another unit",
            "M203 ignored: X200 is out of range (0 to 118.11), stays 11.811; speeds are in mm/s",
            "M914 ignored: X-5 is out of range (0 to 255)",
        ]
    );
    clamps.clear();
    assert!(!clamps.refuses_line());
}

#[test]
fn where_the_edge_is_meant_the_line_is_carried_out() {
    let (mut clamps, mut modal) = (Clamps::new(), Modal::new());
    modal.inches = true;
    assert_eq!(clamps.feed(&modal, Some(number("99999"))), Some(ranges::SPEED.most.into()));
    assert_eq!(clamps.feed(&modal, Some(number("0.001"))), Some(ranges::SPEED.least.into()));
    assert_eq!(clamps.feed(&modal, Some(number("-5"))), None);
    assert_eq!(clamps.whole_of(["M220", "S"], number("-5"), Range { least: 10, most: 999 }, None), Some(10));
    let most = Range { least: Seconds::ZERO, most: Seconds::from_num(200) };
    assert_eq!(clamps.near_of(["M104", "S"], number("-273"), most, None), Some(Seconds::ZERO));
    assert!(!clamps.refuses_line());
    assert_eq!(clamps.near_of(["M104", "S"], number("300"), most, None), None);
    assert!(clamps.refuses_line());
    assert_eq!(
        texts(&clamps),
        [
            "F99999 is out of range, set to 7086.614",
            "F0.001 is out of range, set to 0.024",
            "F-5 is out of range, stays 118.11",
            "M220 S-5 is out of range, set to 10",
            "M104 S-273 is out of range, set to 0",
            "M104 ignored: S300 is out of range (0 to 200)",
        ]
    );
}
