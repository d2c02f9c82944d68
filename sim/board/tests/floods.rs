//! Floods: whatever lines of reports and with numbers a host sends without waiting, and whatever the printer does, an
//! emergency behind them is heard.
//!
//! The host is at the end of USB, which holds it up, or of a UART, which does not. Both are modelled by their buffers:
//! 512 bytes on the board for USB (`chips/board-support`, `usb_pump`), 2,048 for a UART (`ring`).

use crate::common::heated::heated;
use corehbot::motors::{MOTORS, MotorSet};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Sink, World};

struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

/// How bytes come to the board.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Link {
    /// So many bytes a millisecond at most, and no more than the board has room for.
    Usb,
    /// 250,000 bits a second, whether there is room or not.
    Uart,
}

/// A printer on a link to its host.
struct Bench<'w> {
    world: World<'w>,
    link: Link,
    partial: Vec<u8>,
    heard: Vec<String>,
    /// Bytes that are not on the board so far, and for how long the board has not taken those that are.
    to_send: std::collections::VecDeque<u8>,
    stuck_ms: u64,
}

/// Bytes that a UART carries in a millisecond, and for how many of them its ring has room.
const UART_BYTES: usize = 25;
const UART_RING_MS: u64 = 2048 / 25;

/// Bytes that USB's buffer holds.
const USB_BYTES: usize = 512;

fn on_bench(settings: &Settings, link: Link, body: impl FnOnce(&mut Bench<'_>)) {
    let (mut desk, drivers, mut sink) = (Desk::new(1), Drivers::new(), Deaf);
    let start = Some([100, 100, 50].map(Mm::from_num));
    let world = World::new(&mut desk, settings, start, NoStorage, &drivers, &mut sink);
    let (partial, heard, to_send) = (Vec::new(), Vec::new(), [].into());
    if link == Link::Uart {
        world.wires()[0].end_in_ring();
    }
    let mut bench = Bench { world, link, partial, heard, to_send, stuck_ms: 0 };
    bench.rest(200);
    body(&mut bench);
}

impl Bench<'_> {
    /// A millisecond.
    fn turn(&mut self) {
        let wire = &self.world.wires()[0];
        match self.link {
            Link::Usb if wire.is_silent() => {
                let count = self.to_send.len().min(USB_BYTES);
                wire.put(self.to_send.drain(..count));
            }
            Link::Usb => {}
            Link::Uart => {
                let count = self.to_send.len().min(UART_BYTES);
                wire.put(self.to_send.drain(..count));
            }
        }
        self.world.poll();
        self.partial.extend(self.world.wires()[0].heard());
        while let Some(end) = self.partial.iter().position(|byte| *byte == b'\n') {
            let line = String::from_utf8(self.partial.drain(..=end).collect()).unwrap().trim_end().to_owned();
            self.heard.push(line);
        }
        self.stuck_ms = if self.world.wires()[0].is_silent() { 0 } else { self.stuck_ms + 1 };
        self.world.advance();
    }

    fn rest(&mut self, ms: u64) {
        (0..ms).for_each(|_| self.turn());
    }

    fn send(&mut self, text: &str) {
        self.to_send.extend(text.bytes());
    }

    /// Time passes until all is on the board, and the board has read it.
    fn arrive(&mut self, why: &str) {
        let most_ms = 100 + self.to_send.len() as u64 / UART_BYTES as u64;
        for _ in 0..most_ms {
            self.turn();
            assert!(self.link == Link::Usb || self.stuck_ms < UART_RING_MS, "bytes are lost, {why}");
            if self.to_send.is_empty() && self.stuck_ms == 0 {
                return;
            }
        }
        panic!("{} bytes are not taken, {why}: {:#?}", self.to_send.len(), self.heard);
    }

    fn count(&self, begin: &str) -> usize {
        self.heard.iter().filter(|line| line.starts_with(begin)).count()
    }

    fn counts(&self) -> [i32; MOTORS] {
        self.world.outcome().counts
    }

    fn awaits_input(&self) -> bool {
        self.world.is_awaiting_hosts()
    }
}

/// `N5 M105*38` of `M105`.
fn numbered(number: usize, line: &str) -> String {
    let text = format!("N{number} {line}");
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{text}*{sum}\n")
}

/// Without prompts, which are `ok`s that no line has asked for.
fn settings() -> Settings {
    let mut s = heated();
    s.patience_ms = 0;
    s
}

/// A number that looks random, below `most`.
fn random(seed: &mut u64, most: u64) -> u64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) % most
}

/// Reproducer: a host that asks for the temperatures every second while filament is changed, and waits for no answer,
/// was not heard after 205 lines.
#[test]
fn a_host_that_asks_for_the_temperatures_during_a_filament_change_may_go_on_stop_and_cancel() {
    for link in [Link::Usb, Link::Uart] {
        for word in ["M108", "M410", "M524", "M876 S0", "M24", "M112"] {
            on_bench(&settings(), link, |bench| {
                bench.send("M600\n");
                bench.rest(1000);
                assert_eq!(bench.count("//action:prompt_show"), 1);
                for _ in 0..600 {
                    bench.send("M105\n");
                    bench.rest(10);
                }
                bench.arrive(word);
                assert_eq!(bench.count("ok T:"), 600, "each is answered at once");
                bench.send("M114\nM27\n");
                bench.rest(10);
                assert_eq!((bench.count("X:"), bench.count("ok")), (1, 602), "so are these");
                bench.send(&format!("{word}\n"));
                bench.arrive(word);
                bench.rest(100);
                let (halted, ended) = (bench.world.outcome().halted, bench.count("//action:prompt_end"));
                assert_eq!((halted, ended), if word == "M112" { (true, 0) } else { (false, 1) }, "{word}");
                bench.rest(3000);
                if word != "M112" {
                    assert_eq!(bench.count("ok"), 604, "{word}: {:#?}", bench.heard);
                }
            });
        }
    }
}

/// What the printer does, and the words that end it.
const STATES: [(&str, &str, &[&str]); 9] = [
    ("moving", "G1 X390 F600\nM400\n", &["M112", "M410", "M524"]),
    ("waiting for room", "", &["M112", "M410", "M524"]),
    ("homing", "G1 X390 F9000\nG28\n", &["M112", "M410", "M524"]),
    ("dwelling", "G4 S600\n", &["M112", "M410", "M524", "M108"]),
    ("heating", "M190 S110\n", &["M112", "M410", "M524", "M108"]),
    ("tuning", "M303 E0 S200\n", &["M112", "M410", "M524", "M108"]),
    ("changing filament", "M600\n", &["M112", "M410", "M524", "M108", "M876 S1", "M24", "M602"]),
    ("waiting for the user", "M0\n", &["M112", "M410", "M524", "M108", "M876 S1", "M24", "M602"]),
    ("shaking the tool", "TEST_RESONANCES AXIS=X\n", &["M112", "M410", "M524"]),
];

/// Lines of reports and with numbers, in any mixture, a few moves as by a user, and comments as of a thumbnail. Says
/// how many want an answer.
fn flood(seed: &mut u64) -> (String, usize) {
    let (mut text, mut number, mut lines) = (String::new(), 0, 0);
    let (kinds, count, moves) = (1 + random(seed, 31), 1 + random(seed, 600), 1 + random(seed, 40));
    for at in 0..count {
        let kind = random(seed, 5);
        if at % (count / moves + 20) == 19 {
            text += "G1 X150\n";
        } else if kinds >> kind & 1 == 0 {
            continue;
        } else if random(seed, 4) == 0 {
            text += "; AAADCbwQ6mAAAAAXNSR0IArs4c6QAAIABJREFUeJzsvXe8XFd57/1du0yfOXN61dFRl2\n";
            continue;
        } else if kind < 3 {
            text += ["M105\n", "M114\n", "M27\n"][kind as usize];
        } else {
            number += 1;
            let line = if kind == 3 { "M105" } else { "G1 X123.456 Y78.901 F6000.25" };
            text += &numbered(number, line);
        }
        lines += 1;
    }
    (text, lines)
}

#[test]
fn an_emergency_acts_within_a_tenth_of_a_second_behind_any_flood_in_any_state() {
    let mut seed = 57;
    for round in 0..6 {
        for link in [Link::Usb, Link::Uart] {
            for state in &STATES {
                for word in state.2 {
                    let (text, lines) = flood(&mut seed);
                    let why = format!("{word} while {} on {link:?}, round {round}", state.0);
                    let long: String = (0..45).map(|n| format!("G1 X{} F3000\n", 110 + n % 2 * 200)).collect();
                    let begin = if state.1.is_empty() { &long } else { state.1 };
                    on_bench(&settings(), link, |bench| {
                        bench.send(begin);
                        bench.rest(1500);
                        bench.send(&text);
                        bench.arrive(&why);
                        bench.rest(random(&mut seed, 300));
                        bench.send(&format!("{word}\n"));
                        bench.arrive(&why);
                        // Brakes take time too.
                        bench.rest(if *word == "M112" { 100 } else { 400 });
                        let (halted, counts) = (bench.world.outcome().halted, bench.counts());
                        assert_eq!(halted, *word == "M112", "{why}: {:#?}", bench.heard);
                        if halted {
                            return;
                        }
                        if matches!(*word, "M410" | "M524") {
                            bench.rest(300);
                            assert_eq!(bench.counts(), counts, "{why}");
                        }
                        bench.rest(30_000);
                        assert!(bench.awaits_input(), "{why}: {:#?}", bench.heard);
                        assert_eq!(bench.count("ok"), begin.lines().count() + lines + 1, "{why}: {:#?}", bench.heard);
                    });
                }
            }
        }
    }
}

/// Moves without numbers stay, however many they are. A UART has room for 3,000 bytes of them, and its emergencies are
/// heard before the lines in front of them are taken. USB holds its host up.
#[test]
fn on_a_uart_an_emergency_is_heard_behind_more_moves_than_there_is_room_for() {
    for word in ["M112", "M410", "M524", "M108"] {
        on_bench(&settings(), Link::Uart, |bench| {
            bench.send("G4 S600\n");
            bench.rest(500);
            let moves: String = (0..190).map(|n| format!("G1 X{} F6000\n", 110 + n)).collect();
            assert!((2500..2900).contains(&moves.len()), "{}", moves.len());
            bench.send(&format!("{moves}{word}\n"));
            let before = bench.counts();
            while !bench.to_send.is_empty() {
                bench.turn();
            }
            bench.rest(100);
            assert_eq!(bench.world.outcome().halted, word == "M112");
            bench.rest(60_000);
            let (oks, moved) = (bench.count("ok"), bench.counts() != before);
            // M108 ends the dwell alone.
            assert_eq!((oks, moved), [(0, false), (192, word == "M108")][usize::from(word != "M112")], "{word}");
        });
    }
}

/// A host that sends a numbered program without waiting, through a wait, and repeats lines when it is asked to: each
/// is carried out once, and in order.
#[test]
fn a_numbered_program_that_floods_in_is_carried_out_whole_and_in_order() {
    for link in [Link::Usb, Link::Uart] {
        on_bench(&settings(), link, |bench| {
            let line = |n: usize| match n {
                200 | 600 => numbered(n, "G4 P3000"),
                _ => numbered(n, &format!("M118 E1 line {n}")),
            };
            let (mut next, mut read) = (1, 0);
            for _ in 0..60_000 {
                if bench.to_send.len() < 100 && next <= 1000 {
                    bench.send(&line(next));
                    next += 1;
                }
                bench.turn();
                for heard in &bench.heard[read..] {
                    if let Some(number) = heard.strip_prefix("Resend: ") {
                        next = number.parse().unwrap();
                    }
                }
                read = bench.heard.len();
            }
            assert!(bench.count("Resend:") >= 2, "{:#?}", bench.heard);
            let said: Vec<_> = bench.heard.iter().filter_map(|line| line.strip_prefix("echo:line ")).collect();
            let expected: Vec<_> = (1..=1000).filter(|n| ![200, 600].contains(n)).map(|n| n.to_string()).collect();
            assert!(said == expected, "{link:?}: {said:?}");
        });
    }
}

/// `cat file > /dev/ttyACM0`: lines without numbers, held back by USB alone.
#[test]
fn a_file_without_numbers_arrives_whole_whatever_waits_are_in_it() {
    on_bench(&settings(), Link::Usb, |bench| {
        let lines = 3000;
        for n in 0..lines {
            bench.send(&match n % 100 {
                17 => "G4 P400\n".to_owned(),
                31 => "M105\n".to_owned(),
                57 => format!("G1 X{} F6000\nM400\n", 100 + n / 10),
                _ => format!("M118 E1 line {n}\n"),
            });
        }
        bench.rest(120_000);
        let said: Vec<_> = bench.heard.iter().filter_map(|line| line.strip_prefix("echo:line ")).collect();
        let expected: Vec<_> =
            (0..lines).filter(|n| ![17, 31, 57].contains(&(n % 100))).map(|n| n.to_string()).collect();
        assert!(said == expected, "{} of {} lines", said.len(), expected.len());
        assert_eq!(bench.count("ok"), lines + lines / 100);
    });
}
