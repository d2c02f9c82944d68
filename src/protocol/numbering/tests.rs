//! Tests of numbering.

extern crate std;

use super::super::request::STALE_LINES;
use super::*;
use std::format;

/// A numbering at `last`, and the verdict on each line.
struct Story(Numbering);

const OK: Verdict = Verdict::Acknowledge;

fn resend(reason: ResendReason, last: i32) -> Verdict {
    Verdict::Resend { reason, last }
}

impl Story {
    fn at(last: i32) -> Self {
        Self(Numbering { last, is_fresh: false, ..Numbering::new() })
    }

    fn raw(&mut self, line: &str, ms: u32) -> Option<Verdict> {
        let mut frame = Frame::new();
        line.bytes().for_each(|byte| frame.push(byte));
        self.0.judge(&frame, Instant(0).after_ms(ms))
    }

    /// An empty line with that number, so that it is acknowledged whether it is accepted or passed over.
    fn line(&mut self, number: i64, ms: u32) -> Verdict {
        let body = format!("N{number} ");
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        self.raw(&format!("{body}*{sum}"), ms).unwrap()
    }
}

#[test]
fn a_burst_of_stale_lines_is_asked_for_once() {
    let mut story = Story::at(18);
    assert_eq!(story.line(20, 0), resend(ResendReason::LineNumber, 18));
    for number in 21..=26 {
        assert_eq!(story.line(number, 10), OK);
    }
    assert_eq!(story.0.last(), 18);
    assert_eq!(story.line(19, 20), OK);
    assert_eq!(story.0.last(), 19);
    assert_eq!(story.line(21, 30), resend(ResendReason::LineNumber, 19));
}

#[test]
fn a_host_that_starts_over_at_the_wrong_line_is_asked_again() {
    let mut story = Story::at(18);
    assert_eq!(story.line(20, 0), resend(ResendReason::LineNumber, 18));
    assert_eq!(story.line(21, 1), OK);
    assert_eq!(story.line(20, 2), resend(ResendReason::LineNumber, 18));
    assert_eq!(story.line(20, 3), resend(ResendReason::LineNumber, 18));
}

#[test]
fn a_request_that_was_itself_lost_is_repeated() {
    let mut story = Story::at(18);
    assert_eq!(story.line(20, 0), resend(ResendReason::LineNumber, 18));
    assert_eq!(story.line(21, 999), OK);
    assert_eq!(story.line(22, 1000), resend(ResendReason::LineNumber, 18));
    let asked_again = (23..).find(|&number| story.line(number, 1001) != OK);
    assert_eq!(asked_again, Some(23 + i64::from(STALE_LINES)));
}

#[test]
fn an_old_line_is_refused_and_those_after_it_are_passed_over() {
    let mut story = Story::at(18);
    assert_eq!(story.line(16, 0), resend(ResendReason::LineNumber, 18));
    assert_eq!(story.line(17, 0), OK);
    assert_eq!(story.line(18, 0), OK);
    assert_eq!(story.line(19, 0), OK);
    assert_eq!(story.0.last(), 19);
}

#[test]
fn a_damaged_line_is_always_asked_for_again() {
    let mut story = Story::at(4);
    for _ in 0..3 {
        let verdict = story.raw("N5 G1*1", 0);
        assert_eq!(verdict, Some(resend(ResendReason::ChecksumMismatch, 4)));
    }
    assert_eq!(story.raw("N5 G1", 0), Some(resend(ResendReason::NoChecksum, 4)));
}

#[test]
fn the_number_is_questioned_before_the_checksum() {
    let wrong_number = Some(resend(ResendReason::LineNumber, 4));
    assert_eq!(Story::at(4).raw("N7 G1*1", 0), wrong_number);
    assert_eq!(Story::at(4).raw("N7 G1", 0), wrong_number);
}

#[test]
fn numbers_reach_the_ends_of_32_bits() {
    let mut story = Story::at(i32::MAX - 1);
    assert_eq!(story.line(i64::from(i32::MAX), 0), OK);
    assert_eq!(story.0.last(), i32::MAX);
    assert_eq!(story.line(i64::from(i32::MAX) + 1, 0), resend(ResendReason::LineNumber, i32::MAX));
    let mut story = Story::at(i32::MIN);
    assert_eq!(story.line(i64::from(i32::MIN) + 1, 0), OK);
    assert_eq!(Story::at(999_999).line(1_000_000, 0), OK);
    assert_eq!(Story::at(-2).line(-1, 0), OK);
}

#[test]
fn a_repetition_of_one_of_the_last_lines_is_acknowledged() {
    let mut story = Story::at(-5);
    for number in -4..=5 {
        assert_eq!(story.line(number, 0), OK);
    }
    for number in -2..=5 {
        assert_eq!(story.line(number, 2000), OK);
    }
    // A different line with that number is refused, and so is an older one.
    assert_eq!(story.raw("N5 G1*58", 2000), Some(resend(ResendReason::LineNumber, 5)));
    assert_eq!(story.line(-3, 4000), resend(ResendReason::LineNumber, 5));
    assert_eq!(story.0.last(), 5);
}

#[test]
fn a_fresh_connection_may_begin_with_either_line() {
    let mut story = Story(Numbering::new());
    assert_eq!(story.raw("N-1 M110 N-1*1", 0), Some(resend(ResendReason::ChecksumMismatch, 0)));
    assert_eq!(story.line(0, 0), OK);
    assert_eq!((story.line(1, 0), story.0.last()), (OK, 1));
    assert_eq!((story.line(0, 0), story.0.last()), (OK, 1));
    assert_eq!(Story(Numbering::new()).line(2, 0), resend(ResendReason::LineNumber, 0));
}

#[test]
fn eight_lines_are_known_and_no_older_one() {
    let sum = |body: &str| body.bytes().fold(0, |sum, byte| sum ^ byte);
    let mut story = Story::at(0);
    // Line 9 has the checksum of line 1, and its place among the remembered lines.
    let (first, ninth) = ("N1 i", "N9 a");
    assert_eq!(sum(first), sum(ninth));
    assert!(matches!(story.raw(&format!("{first}*{}", sum(first)), 0), Some(Verdict::Command { .. })));
    for number in 2..=8 {
        assert_eq!(story.line(number, 0), OK);
    }
    assert_eq!(story.raw(&format!("{first}*{}", sum(first)), 0), Some(OK), "a repetition");
    assert!(matches!(story.raw(&format!("{ninth}*{}", sum(ninth)), 0), Some(Verdict::Command { .. })));
    assert_eq!(story.raw(&format!("{first}*{}", sum(first)), 0), Some(resend(ResendReason::LineNumber, 9)));
}

#[test]
fn once_m110_has_named_a_line_no_other_one_may_be_the_first() {
    let mut story = Story(Numbering::new());
    assert_eq!(story.raw("M110 N12", 0), Some(Verdict::LineNumber { report: None }));
    assert_eq!(story.line(0, 0), resend(ResendReason::LineNumber, 12));
}

#[test]
fn only_a_host_that_counts_from_below_zero_waits_for_ever() {
    for (line, waits) in [("N-1 M110 N-1*125", true), ("N0 M110 N0*125", false), ("N1 M110 N1*125", false)] {
        let mut story = Story(Numbering::new());
        assert_eq!(story.raw(line, 0), Some(Verdict::LineNumber { report: None }));
        assert_eq!((story.0.waits_for_ever(), story.0.is_stream()), (waits, waits), "{line}");
    }
}
