//! The line protocol against simple models: every line answered once, every damaged line repaired.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use corehbot::port::Received;
use corehbot::protocol::{Emergency, Replies, ResendReason};
use proptest::prelude::*;
use support::bodies;
use support::machine::{Machine, numbered};

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

/// Whether a line asks for an answer, worked out from the whole line.
fn asks_for_an_answer(line: &[Received]) -> bool {
    let text: Vec<u8> = line
        .iter()
        .filter_map(|received| match received {
            Received::Byte(byte) if *byte != 0 => Some(*byte),
            _ => None,
        })
        .collect();
    let text = String::from_utf8_lossy(&text).into_owned();
    let text = text.trim_start_matches([' ', '\t']);
    let is_numbered = text.strip_prefix(['N', 'n']).is_some_and(|rest| {
        let rest = rest.trim_start_matches([' ', '\t']);
        let rest = rest.strip_prefix(['-', '+']).unwrap_or(rest);
        rest.starts_with(|c: char| c.is_ascii_digit())
    });
    let blanks = [' ', '\t'];
    let ends_in_checksum = text.rsplit_once('*').is_some_and(|(_, rest)| {
        let claim = rest.trim_start_matches(blanks);
        let rest = claim.trim_start_matches(|c: char| c.is_ascii_digit());
        let after = rest.trim_start_matches(blanks);
        rest.len() < claim.len() && (after.is_empty() || after.starts_with(';'))
    });
    let is_blank = text.is_empty() || text.starts_with(';') && !ends_in_checksum;
    line.contains(&Received::Lost) || is_numbered || !is_blank
}

/// Things that arrive: much that looks like G-code, some that does not.
fn noise() -> impl Strategy<Value = Vec<Received>> {
    let piece = prop_oneof![
        4 => "N ?-?[0-9]{1,3} (M110|M117|G1 X5|M112|) ?(N-?[0-9]{1,2})?(\\*[0-9]{1,3})?[ ]?\n".prop_map(String::into_bytes),
        3 => "[ NGMX0-9*;\"\\\\()\t-]{0,12}\n".prop_map(String::into_bytes),
        2 => "(M105|G28 X|M110|M117 2\\*3|;c)[\r\n]{1,2}".prop_map(String::into_bytes),
        2 => (0i32..9, "(G1|M105|;|M110 N[0-9])").prop_map(|(number, text)| numbered(number, &text).into_bytes()),
        1 => proptest::collection::vec(any::<u8>(), 0..9),
        1 => "[a-z*]{280,300}\n".prop_map(String::into_bytes),
    ];
    let received = prop_oneof![
        12 => piece.prop_map(|bytes| bytes.into_iter().map(Received::Byte).collect::<Vec<_>>()),
        1 => Just(vec![Received::Lost]),
    ];
    proptest::collection::vec(received, 0..20).prop_map(|pieces| pieces.concat())
}

/// What a fuzzer might think of: noise, pauses, and lines in order.
fn fuzz_data() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        3 => (0i32..6, "(G1 X5|M105|M110 N[0-9]|M112|)").prop_map(|(number, text)| numbered(number, &text).into_bytes()),
        2 => "[NGMX0-9*; -]{0,8}[\r\n]?".prop_map(String::into_bytes),
        2 => proptest::sample::select(vec![vec![0xFF], vec![0xFE], vec![0xFC], vec![0xFD, 9], vec![0xFD, 99]]),
        1 => proptest::collection::vec(any::<u8>(), 0..9),
    ];
    proptest::collection::vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

/// A host that numbers its lines and, as OctoPrint does, sends one for every `ok`.
struct Host {
    program: Vec<String>,
    next: usize,
    credit: usize,
}

impl Host {
    fn hear(&mut self, answers: &str) {
        for line in answers.lines() {
            if let Some(number) = line.strip_prefix("Resend: ") {
                self.next = number.parse::<usize>().unwrap() - 1;
            } else if line == "ok" {
                self.credit += 1;
            }
        }
    }

    fn next_line(&mut self) -> Option<String> {
        if self.credit == 0 {
            return None;
        }
        let line = numbered(self.next as i32 + 1, self.program.get(self.next)?);
        self.credit -= 1;
        self.next += 1;
        Some(line)
    }
}

/// What happens to a byte on a bad line.
#[derive(Clone, Copy, Debug)]
enum Damage {
    Changed(u8),
    Marked,
    Gone,
}

fn damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        any::<u8>().prop_map(Damage::Changed),
        Just(Damage::Changed(b'\n')),
        Just(Damage::Marked),
        Just(Damage::Gone),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_line_that_asks_for_an_answer_gets_one(noise in noise()) {
        let mut machine = Machine::new();
        let mut answered = 0;
        let is_end = |received: &Received| matches!(received, Received::Byte(b'\n' | b'\r'));
        for &received in &noise {
            machine.feed(received);
            while machine.answer_one() {
                answered += 1;
                machine.take_replies();
            }
            // Pieces of a damaged line would follow it at once.
            machine.ms += if is_end(&received) { 1000 } else { 0 };
            machine.receiver.hold_silence();
        }
        let mut lines: Vec<&[Received]> = noise.split(is_end).collect();
        lines.pop();
        prop_assert_eq!(answered, lines.iter().filter(|line| asks_for_an_answer(line)).count());
    }

    #[test]
    fn any_bytes_are_answered_alike_in_any_packets(data in fuzz_data()) {
        bodies::protocol(&data);
    }

    #[test]
    fn packets_do_not_matter(noise in noise(), cuts in proptest::collection::vec(1usize..40, 1..9)) {
        let answers = |cuts: &[usize]| {
            let mut machine = Machine::new();
            let mut answers = String::new();
            let mut cuts = cuts.iter().cycle();
            let mut rest = &noise[..];
            while !rest.is_empty() {
                let (packet, tail) = rest.split_at(rest.len().min(*cuts.next().unwrap()));
                packet.iter().for_each(|&received| machine.feed(received));
                while machine.answer_one() {
                    answers += &machine.take_replies();
                }
                rest = tail;
            }
            (answers, machine.commands, machine.emergencies)
        };
        prop_assert_eq!(answers(&[1]), answers(&cuts));
    }

    #[test]
    fn a_print_over_a_bad_line_arrives_whole_and_in_order(
        length in 1usize..40,
        gaps in proptest::collection::vec((40usize..200, damage()), 0..9),
    ) {
        let program: Vec<String> = (0..length).map(|n| format!("G1 X{n} Y{}.5", n * 7)).collect();
        // No two in one line: an XOR can miss a pair, and no checksum guards a piece between two false
        // line ends.
        let mut at = 0;
        let spots = gaps.iter().map(|&(gap, damage)| { at += gap; (at - 40, damage) });
        let spots: Vec<(usize, Damage)> = spots.collect();
        let mut host = Host { program: program.clone(), next: 0, credit: 1 };
        let mut machine = Machine::new();
        let mut sent = 0;
        for _ in 0..10_000 {
            if machine.receiver.last_line() == length as i32 {
                break;
            }
            for byte in host.next_line().unwrap_or_default().bytes() {
                let spot = spots.iter().find(|(spot, _)| *spot == sent).map(|(_, damage)| *damage);
                sent += 1;
                match spot {
                    // The end of a line is lost with a mark at least: a UART that loses bytes says so.
                    Some(Damage::Changed(_) | Damage::Gone) if byte == b'\n' => machine.feed(Received::Lost),
                    Some(Damage::Changed(other)) => machine.feed(Received::Byte(other)),
                    Some(Damage::Gone) => {}
                    Some(Damage::Marked) => machine.feed(Received::Lost),
                    None => machine.feed(Received::Byte(byte)),
                }
            }
            machine.ms += 60;
            while machine.answer_one() {
                host.hear(&machine.take_replies());
            }
        }
        // What is left of a checksum after a false line end is a number, which no command looks like.
        let carried_out: Vec<&String> =
            machine.commands.iter().filter(|text| text.starts_with(['G', 'g'])).collect();
        prop_assert_eq!(carried_out, program.iter().collect::<Vec<_>>());
    }
}
