//! The line protocol, one dialogue after the other; `line_properties.rs` has the properties for any input.

use crate::support::machine::{Machine, numbered};
use corehbot::port::Received;
use corehbot::protocol::{Emergency, Replies, ResendReason};

fn resend(reason: &str, last: i64) -> String {
    format!("Error:{reason}, Last Line: {last}\nResend: {}\nok\n", last + 1)
}

const NUMBER: &str = "Line Number is not Last Line Number+1";
const MISMATCH: &str = "checksum mismatch";

#[test]
fn printcore_opens_a_print() {
    let mut machine = Machine::new();
    assert_eq!(machine.say("M105\n"), "ok\n");
    assert_eq!(machine.say("N-1 M110 N-1*125\n"), "ok\n");
    assert_eq!(machine.say(numbered(0, "G21")), "ok\n");
    assert_eq!(machine.say(numbered(1, "G90")), "ok\n");
    assert_eq!(machine.say("M105\n"), "ok\n");
    assert_eq!(machine.say(numbered(2, "G28")), "ok\n");
    assert_eq!(machine.say("N-1 M110 N-1*125\n"), "ok\n");
    assert_eq!(machine.commands, ["M105", "G21", "G90", "M105", "G28"]);
}

#[test]
fn octoprint_connects() {
    let mut machine = Machine::new();
    assert_eq!(machine.say("\nN0 M110 N0*125\n".repeat(3)), "ok\nok\nok\n");
    assert_eq!(machine.say("N1 M115*39\n"), "ok\n");
    assert_eq!(machine.commands, ["M115"]);
}

#[test]
fn m110_in_all_its_forms_is_never_refused() {
    for (form, last) in [
        ("N0 M110 N0*125\n", 0),
        ("N-1 M110 N-1*125\n", -1),
        ("M110 N-1\n", -1),
        ("m110n7\n", 7),
        ("M110 N 7 ;start\n", 7),
        ("N1 M110*34\n", 1),
        ("N0 M110 N0*125 \r\n", 0),
    ] {
        let mut machine = Machine::new();
        machine.say(numbered(0, "M110 N4711"));
        assert_eq!(machine.receiver.last_line(), 4711);
        assert_eq!(machine.say(form), "ok\n", "{form}");
        assert_eq!(machine.receiver.last_line(), last, "{form}");
        assert_eq!(machine.say(numbered(last + 1, "G28")), "ok\n");
        assert_eq!(machine.commands, ["G28"]);
    }
}

#[test]
fn a_bare_m110_asks_for_the_number() {
    let mut machine = Machine::new();
    machine.say("M110 N41\n");
    assert_eq!(machine.say("M110\n"), "Line: 41\nok\n");
    assert_eq!(machine.receiver.last_line(), 41);
}

#[test]
fn m110_is_a_command_and_not_a_piece_of_text() {
    let mut machine = Machine::new();
    assert_eq!(machine.say(numbered(1, "M117 M110 N99")), "ok\n");
    assert_eq!(machine.receiver.last_line(), 1);
    assert_eq!(machine.say(numbered(5, "M117 M110 N99")), resend(NUMBER, 1));
    machine.ms += 1000;
    assert_eq!(machine.say("M1100 N9\n"), "ok\n");
    assert_eq!(machine.receiver.last_line(), 1);
}

#[test]
fn a_damaged_m110_changes_nothing() {
    let mut machine = Machine::new();
    assert_eq!(machine.say("N0 M110 N9*125\n"), resend(MISMATCH, 0));
    assert_eq!(machine.say("N0 M110 N9\n"), resend("No Checksum with line number", 0));
    assert_eq!(machine.say("0 M110 N0*125\n"), resend(MISMATCH, 0));
    assert_eq!(machine.say(" M110 N9*125\n"), resend(MISMATCH, 0));
    assert_eq!(machine.receiver.last_line(), 0);
    // A checksum without a number is strange, but it does vouch for the line.
    assert_eq!(machine.say(format!("M110 N9*{}\n", b"M110 N9".iter().fold(0, |a, b| a ^ b))), "ok\n");
    assert_eq!(machine.receiver.last_line(), 9);
}

#[test]
fn the_resend_dialogue_repairs_a_line() {
    let mut machine = Machine::new();
    machine.say("M110 N12\n");
    assert_eq!(machine.say("N13 G1 X1*99\n"), resend(MISMATCH, 12));
    assert_eq!(machine.say("N13 G1 X1\n"), resend("No Checksum with line number", 12));
    assert_eq!(machine.say(numbered(14, "G1 X2")), "ok\n", "stale after a refused line");
    assert_eq!(machine.say(numbered(13, "G1 X1")), "ok\n");
    assert_eq!(machine.say(numbered(13, "G1 X1")), "ok\n", "a repetition");
    assert_eq!(machine.say(numbered(13, "G1 X7")), resend(NUMBER, 13));
    assert_eq!(machine.say(numbered(14, "G1 X2")), "ok\n");
    assert_eq!(machine.commands, ["G1 X1", "G1 X2"]);
}

#[test]
fn a_line_that_lost_its_head_is_not_carried_out() {
    let mut machine = Machine::new();
    for tail in ["1 G1 X5*34\n", "G1 X5*34\n", "1 X5*4\n", "*34\n", "G1 X5 * 34 \n", "N G1 X5*34\n", ";1 G1 X5*34\n"] {
        assert_eq!(machine.say(tail), resend(MISMATCH, 0), "{tail}");
    }
    assert_eq!(machine.commands, [""; 0]);
}

#[test]
fn an_asterisk_in_a_message_is_no_checksum() {
    let mut machine = Machine::new();
    assert_eq!(machine.say("M117 50*2\nM118 a*b*3\nG1 X5 ;2*3\n"), "ok\nok\nok\n");
    assert_eq!(machine.say(numbered(1, "M117 50*2")), "ok\n");
    assert_eq!(machine.commands, ["M117 50*2", "M118 a*b*3", "G1 X5", "M117 50*2"]);
}

#[test]
fn lines_without_content() {
    let mut machine = Machine::new();
    assert_eq!(machine.say("\n\r\n  \n\t\n; comment\n ;2*x\n\0\n"), "");
    assert_eq!(machine.say(numbered(1, "")), "ok\n");
    assert_eq!(machine.say(numbered(2, "; comment")), "ok\n");
    assert_eq!(machine.receiver.last_line(), 2);
    assert_eq!(machine.commands, [""; 0]);
    // A comment in parentheses is left to the parser, which does not know it.
    assert_eq!(machine.say("(comment)\n"), "ok\n");
}

#[test]
fn spaces_and_comments_where_hosts_and_people_put_them() {
    let mut machine = Machine::new();
    for line in ["N 1 G1 X5", "N2G1 X5", "N3\tG1 X5", "n4 G1 X5  ", "N5 G1 X5 ;c"] {
        let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
        assert_eq!(machine.say(format!(" {line}*{sum}  \r\n")), "ok\n", "{line}");
    }
    assert_eq!(machine.commands, ["G1 X5"; 5]);
}

#[test]
fn a_long_line_does_not_break_the_stream() {
    let mut machine = Machine::new();
    let outline = format!("EXCLUDE_OBJECT_DEFINE NAME=x POLYGON=[{}]", "[10.5,20.5],".repeat(740));
    assert!(outline.len() > 8867);
    let too_long = "echo:Line too long, ignored\nok\n";
    assert_eq!(machine.say(numbered(1, &outline)), too_long);
    assert_eq!(machine.say(numbered(2, &outline).replace("NAME=x", "NAME=y")), resend(MISMATCH, 1));
    assert_eq!(machine.say(numbered(2, "G28")), "ok\n");
    assert_eq!(machine.say(outline.clone() + "\n"), too_long);
    assert_eq!(machine.say(outline + "*12\n"), resend(MISMATCH, 2));
    assert_eq!(machine.say(format!(";{}\n", "thumbnail ".repeat(1000))), "");
    assert_eq!(machine.commands, ["G28"]);
}

#[test]
fn two_hundred_and_fifty_six_bytes_are_kept() {
    let mut machine = Machine::new();
    let longest = format!("M117 {}", "x".repeat(251));
    machine.say("M110 N999999999\n");
    assert_eq!(machine.say(numbered(1_000_000_000, &longest)), "ok\n");
    assert_eq!(machine.say(longest.clone() + "\n"), "ok\n");
    assert_eq!(machine.commands, [longest.clone(), longest]);
}

#[test]
fn bad_line_numbers_do_not_overflow() {
    let mut machine = Machine::new();
    machine.say(format!("M110 N{}\n", i32::MAX));
    assert_eq!(machine.say(numbered(i32::MIN, "G1")), resend(NUMBER, i64::from(i32::MAX)));
    machine.say("M110 N-99999999999999\n");
    assert_eq!(machine.receiver.last_line(), i32::MIN);
    assert_eq!(machine.say(numbered(i32::MIN + 1, "G1")), "ok\n");
}

#[test]
fn a_stop_is_seen_before_its_line_is_taken() {
    let mut machine = Machine::new();
    for &byte in b"G28\nG1 X5\nM112\n" {
        machine.feed(Received::Byte(byte));
    }
    assert_eq!(machine.emergencies, [Emergency::Stop]);
    assert!(machine.commands.is_empty());
    while machine.answer_one() {}
    assert_eq!(machine.commands, ["G28", "G1 X5", "M112"]);
}

#[test]
fn only_emergency_commands_are_emergencies() {
    for (text, expected) in [
        ("M112\n", Some(Emergency::Stop)),
        ("m112\r\n", Some(Emergency::Stop)),
        ("N5 M112*12\n", Some(Emergency::Stop)),
        ("N4 M108*46\n", Some(Emergency::Continue)),
        ("M410 ;stop\n", Some(Emergency::QuickStop)),
        ("M1125\n", None),
        (";M112\n", None),
        ("M117 M112\n", None),
        ("M112", None),
        ("G1 M112\n", None),
    ] {
        let mut machine = Machine::new();
        machine.say(text);
        assert_eq!(machine.emergencies.first().copied(), expected, "{text:?}");
    }
}

#[test]
fn unprintable_answers_cannot_happen() {
    let mut replies = Replies::new();
    replies.unknown(b"\xC3\xBC\x01").unwrap();
    replies.resend(ResendReason::LineNumber, 1).unwrap();
    assert!(replies.pending().iter().all(|byte| matches!(byte, b' '..=b'~' | b'\n')));
}
