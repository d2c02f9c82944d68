//! Tests of number.

extern crate std;

use super::*;
use std::string::ToString;

fn bits(text: &str) -> i64 {
    let (number, after) = Number::read(text.as_bytes()).unwrap();
    assert!(after.is_empty(), "{text} left {after:?}");
    number.value().to_bits()
}

const ONE: i64 = 1 << 32;

#[test]
fn slicers_leave_out_what_they_can() {
    assert_eq!(bits(".5"), ONE / 2);
    assert_eq!(bits("-.5"), -ONE / 2);
    assert_eq!(bits("5."), 5 * ONE);
    assert_eq!(bits("+0.25"), ONE / 4);
    assert_eq!(bits("-0"), 0);
    assert_eq!(bits("007"), 7 * ONE);
}

#[test]
fn without_a_digit_there_is_no_number() {
    for text in ["", "-", "+", ".", "-.", "x", " 1", "--1", "e5", "inf", "nan"] {
        assert_eq!(Number::read(text.as_bytes()), None, "{text}");
    }
}

#[test]
fn the_text_after_a_number_is_left_alone() {
    assert_eq!(Number::read(b"1E5").unwrap(), (Number::from(1), &b"E5"[..]));
    assert_eq!(Number::read(b"6.2.6+8948").unwrap().1, b".6+8948");
    assert_eq!(Number::read(b"1-2").unwrap().1, b"-2");
    // The characters before 0 and after 9.
    assert_eq!(Number::read(b"1/2").unwrap(), (Number::from(1), &b"/2"[..]));
    assert_eq!(Number::read(b"1:2").unwrap(), (Number::from(1), &b":2"[..]));
}

#[test]
fn numbers_out_of_range_saturate() {
    let limit = i64::from(Number::LIMIT) * ONE;
    assert_eq!(bits("99999999999999999999"), limit);
    assert_eq!(bits("-99999999999999999999.5"), -limit);
    assert_eq!(bits("1000000000.9"), limit);
    assert_eq!(bits("999999999.9999999999999999"), limit);
    assert_eq!(Number::saturating(I32F32::MIN), Number::from(-Number::LIMIT));
    assert_eq!(Number::from(i32::MAX), Number::from(Number::LIMIT));
}

#[test]
fn a_tie_goes_away_from_zero_and_less_than_a_tie_does_not() {
    let tie = "0.000000000116415321826934814453125"; // 2^-33
    assert_eq!(bits(tie), 1);
    assert_eq!(bits(&std::format!("-{tie}")), -1);
    assert_eq!(bits("0.000000000116415321826934814453124999999999999999"), 0);
    assert_eq!(bits("0.0000000001164153218269348144531250000000000000001"), 1);
    assert_eq!(bits("0.99999999999999"), ONE);
}

#[test]
fn quick_and_long_paths_agree() {
    for decimals in ["1", "12345", "999999999", "000000001", "500000000", "123456789", "00001"] {
        let long = std::format!("{decimals}0000000000000");
        assert_eq!(read_fraction(decimals.as_bytes()).0, read_fraction(long.as_bytes()).0);
    }
    // Numbers as slicers write them take the fast path.
    for text in
        ["0", "200", "-", "12.345", "0.03123", ".5", "5.", "999999999", "1234.56789", "123456789.", ".000000001"]
    {
        let short = read_short(text.as_bytes());
        assert_eq!((short.is_some(), short), (text != "-", read_long(text.as_bytes())), "{text}");
    }
    for text in ["1234567890", "12345.67890", ".0000000001", "0000000001", ""] {
        assert_eq!(read_short(text.as_bytes()), None, "{text}");
    }
}

#[test]
fn parts_of_a_number() {
    let number = |text: &str| Number::read(text.as_bytes()).unwrap().0;
    assert_eq!(number("-1.9").to_int(), -1);
    assert_eq!(number("-1.9").to_u32(), 0);
    assert_eq!(number("255.9").to_u32(), 255);
    assert_eq!(number("1.2345").to_thousandths(), 1235);
    assert_eq!(number("-1.2346").to_thousandths(), -1235);
    assert_eq!(number("-2.0004").to_thousandths(), -2000);
    assert_eq!((number("0").to_int(), number("1").to_int(), number("-1").to_int()), (0, 1, -1));
    assert_eq!((number("0").to_u32(), number("1").to_u32()), (0, 1));
    assert_eq!(number("-0.0004").to_thousandths(), 0);
    assert_eq!(number("1e9").to_thousandths(), 1000);
    assert_eq!(number("1000000000").to_thousandths(), 1_000_000_000_000);
}

#[test]
fn printing_is_short() {
    for text in ["0", "5", "-5", "0.1", "-0.04", "12.345", "0.00001", "1000000000", "-0.5"] {
        assert_eq!(Number::read(text.as_bytes()).unwrap().0.to_string(), text);
    }
    assert_eq!(Number::saturating(I32F32::DELTA).to_string(), "0.0000000002");
    assert_eq!(bits("0.0000000002"), 1);
    assert_eq!(bits(&Number::saturating(I32F32::from_bits(ONE - 1)).to_string()), ONE - 1);
}

#[test]
fn the_tenth_decimal_is_the_nearest() {
    // 6.98e-10: nine decimals do not read back, and 6 as the tenth would.
    assert_eq!(Number::saturating(I32F32::from_bits(3)).to_string(), "0.0000000007");
}
