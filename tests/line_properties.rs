//! The line protocol for any input: every line is answered once, the split into packets does not matter, and every
//! damaged line is repaired.

use crate::support::bodies;
use crate::support::machine::{Machine, numbered};
use corehbot::port::Received;
use proptest::prelude::*;

/// Whether a line needs an answer, found from the whole line.
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

/// The bytes that terminals send for the key that erases a character: backspace, or delete.
const ERASING: [u8; 2] = [0x08, 0x7F];

/// The same without the bytes of those keys.
fn without_erasing_keys(noise: Vec<Received>) -> Vec<Received> {
    let is_key = |received: &Received| matches!(received, Received::Byte(byte) if ERASING.contains(byte));
    noise.into_iter().filter(|received| !is_key(received)).collect()
}

/// Characters typed by mistake, with the key by which each is erased again.
fn typing_slips() -> impl Strategy<Value = Vec<(String, u8)>> {
    // No N: if a line begins with it nothing is erased, because a host sent it.
    let slip = ("[A-MO-Z0-9*;\"()]{0,5}", proptest::sample::select(ERASING.to_vec()));
    proptest::collection::vec(slip, 1..5)
}

/// Input for a fuzzer: noise, pauses, and valid lines.
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

/// The fate of a byte on a bad line.
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

    /// The keys that erase a character have their own property below: their effect on a line depends on the lines
    /// before it.
    #[test]
    fn every_line_that_asks_for_an_answer_gets_one(noise in noise().prop_map(without_erasing_keys)) {
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
    fn what_is_erased_was_never_typed(line in "[GM][0-9]{1,3}( [XYZ][0-9]{1,3}){0,3}", slips in typing_slips()) {
        // It sets the line number and is no command.
        prop_assume!(!line.starts_with("M110"));
        let mut machine = Machine::new();
        let mut slips = slips.iter().cycle();
        for byte in line.bytes() {
            let (slip, key) = slips.next().unwrap();
            slip.bytes().for_each(|wrong| machine.feed(Received::Byte(wrong)));
            slip.bytes().for_each(|_| machine.feed(Received::Byte(*key)));
            machine.feed(Received::Byte(byte));
        }
        machine.feed(Received::Byte(b'\n'));
        prop_assert!(machine.answer_one());
        prop_assert_eq!(&machine.commands, &[line]);
        prop_assert_eq!(machine.take_replies(), "ok\n");
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
        // The rest of a checksum after a false line end is a number, and no command looks like one.
        let carried_out: Vec<&String> =
            machine.commands.iter().filter(|text| text.starts_with(['G', 'g'])).collect();
        prop_assert_eq!(carried_out, program.iter().collect::<Vec<_>>());
    }
}
