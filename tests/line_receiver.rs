//! The receiver: where lines end, what damage spoils, and when it gives up.

use corehbot::port::Received;
use corehbot::protocol::{Emergency, Incoming, Receiver};
use corehbot::units::Instant;

/// As the receiver has it.
const QUIET_MS: u32 = 100;

/// A receiver and its output, in short: commands as they are, the rest by name.
struct Line {
    receiver: Receiver,
    ms: u32,
}

impl Line {
    fn new() -> Self {
        Self { receiver: Receiver::new(), ms: 0 }
    }

    fn send(&mut self, text: &str) -> Vec<String> {
        text.bytes().for_each(|byte| {
            self.receiver.feed(Received::Byte(byte));
        });
        self.take()
    }

    fn lose(&mut self) {
        self.receiver.feed(Received::Lost);
    }

    fn take(&mut self) -> Vec<String> {
        let mut all = Vec::new();
        while let Some(incoming) = self.receiver.next_line(Instant(0).after_ms(self.ms)) {
            all.push(match incoming {
                Incoming::Command(text) => String::from_utf8_lossy(text).to_string(),
                Incoming::Resend { last, .. } => format!("resend after {last}"),
                other => format!("{other:?}"),
            });
        }
        all
    }
}

#[test]
fn every_line_end_ends_a_line_and_empty_ones_do_not_count() {
    let mut line = Line::new();
    assert_eq!(line.send("M105\nM114\rM115\r\n\n \t \n;x\n\0\nM119"), ["M105", "M114", "M115"]);
    assert_eq!(line.send("\n"), ["M119"]);
}

#[test]
fn a_packet_may_end_anywhere() {
    let mut line = Line::new();
    assert_eq!(line.send("N1 M1"), [""; 0]);
    assert_eq!(line.send("15*3"), [""; 0]);
    assert_eq!(line.send("9\n"), ["M115"]);
}

#[test]
fn damage_spoils_its_own_line_only() {
    let mut line = Line::new();
    line.send("M105\nG1");
    line.lose();
    assert_eq!(line.send(" X5\nM114\n"), ["resend after 0", "M114"]);
}

#[test]
fn damage_before_a_line_spoils_it() {
    let mut line = Line::new();
    line.lose();
    assert_eq!(line.send("M105\nM114\n"), ["resend after 0", "M114"]);
}

#[test]
fn a_line_that_lost_its_end_is_asked_for_after_a_while() {
    let mut line = Line::new();
    line.send("N1 M11");
    line.lose();
    assert_eq!(line.take(), [""; 0]);
    line.ms += QUIET_MS - 1;
    assert_eq!(line.take(), [""; 0]);
    line.ms += 1;
    assert_eq!(line.take(), ["resend after 0"]);
    line.ms += QUIET_MS * 10;
    assert_eq!(line.take(), [""; 0]);
    assert_eq!(line.send("N1 M115*39\n"), ["M115"]);
}

#[test]
fn as_long_as_bytes_arrive_the_end_may_still_come() {
    let mut line = Line::new();
    line.lose();
    for _ in 0..5 {
        assert_eq!(line.send("x"), [""; 0]);
        line.ms += QUIET_MS - 1;
    }
    assert_eq!(line.send("\n"), ["resend after 0"]);
}

#[test]
fn a_healthy_line_may_take_its_time() {
    let mut line = Line::new();
    line.send("M1");
    line.ms += 60_000;
    assert_eq!(line.send("05\n"), ["M105"]);
}

#[test]
fn an_emergency_is_seen_while_nobody_takes_lines() {
    let mut receiver = Receiver::new();
    for _ in 0..2000 {
        assert_eq!(receiver.feed(Received::Byte(b'x')), None);
    }
    assert!(!receiver.has_room());
    let found = b"\nM112\n".iter().filter_map(|&byte| receiver.feed(Received::Byte(byte)));
    assert_eq!(found.collect::<Vec<_>>(), [Emergency::Stop]);
}

#[test]
fn a_line_that_is_opened_begins_anew() {
    let mut line = Line::new();
    assert_eq!(line.send("N1 M115*39\nN2 G1 X1"), ["M115"]);
    line.receiver.feed(Received::Opened);
    assert_eq!(line.send("M105\nN1 M115*39\n"), ["M105", "M115"]);
}

#[test]
fn an_emergency_also_takes_its_turn() {
    let mut line = Line::new();
    assert_eq!(line.send("M108\n"), ["M108"]);
}

#[test]
fn there_is_room_until_the_ring_is_full_and_again_when_lines_are_taken() {
    let mut receiver = Receiver::new();
    let most = receiver.room();
    assert!(most >= 1000 && receiver.is_empty());
    for held in 0..most {
        assert_eq!((receiver.has_room(), receiver.room()), (true, most - held));
        receiver.feed(Received::Byte(if held % 100 == 99 { b'\n' } else { b'x' }));
        assert!(!receiver.is_empty());
    }
    assert_eq!((receiver.has_room(), receiver.room()), (false, 0));
    assert!(matches!(receiver.next_line(Instant(0)), Some(Incoming::Command(text)) if text.len() == 99));
    assert_eq!((receiver.has_room(), receiver.room()), (true, 100));
    while receiver.next_line(Instant(0)).is_some() {}
    assert_eq!((receiver.is_empty(), receiver.room()), (true, most));
}

#[test]
fn a_line_ended_before_or_after_a_place() {
    let mut receiver = Receiver::new();
    b"M105\n".iter().for_each(|byte| _ = receiver.feed(Received::Byte(*byte)));
    let place = receiver.place();
    b"M114\n".iter().for_each(|byte| _ = receiver.feed(Received::Byte(*byte)));
    assert_eq!(receiver.next_line(Instant(0)), Some(Incoming::Command(b"M105")));
    assert!(receiver.is_within(place));
    assert_eq!(receiver.next_line(Instant(0)), Some(Incoming::Command(b"M114")));
    assert!(!receiver.is_within(place) && receiver.is_within(receiver.place()));
}

#[test]
fn the_beginning_of_a_line_that_is_too_long_is_kept() {
    let text = format!("FOO {}", "x".repeat(9000));
    let body = format!("N1 {text}");
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    for line in [format!("{text}\n"), format!("{body}*{sum}\n")] {
        let mut host = Line::new();
        // More than the ring holds, so that it is taken in pieces.
        let found: Vec<_> =
            line.as_bytes().chunks(500).flat_map(|piece| host.send(str::from_utf8(piece).unwrap_or(""))).collect();
        assert_eq!(found, ["TooLong"]);
        let kept = host.receiver.kept();
        assert!(kept.len() > 256 && text.as_bytes().starts_with(kept));
    }
}
