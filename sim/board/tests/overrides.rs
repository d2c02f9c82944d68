//! M220 counts at once, also for queued moves; neither it nor M221 makes the machine exceed its limits.

use corehbot::motors::{MOTORS, Motor, MotorSet, prototype};
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Mm, Ratio};
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Host, Sink, run};
use proptest::prelude::*;
use std::cell::Cell;

/// Watches the speed along x, averaged over 2 ms.
struct Speed<'a> {
    tick: &'a Cell<u64>,
    slow_at: &'a Cell<Option<u64>>,
    changed_at: &'a Cell<Option<u64>>,
    window: (u64, u32),
}

impl Sink for Speed<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, _forward: MotorSet) {
        self.tick.set(tick);
        let (since, count) = self.window;
        let count = count + u32::from(steps.has(prototype::M8));
        if tick - since < 20_000 {
            self.window = (since, count);
            return;
        }
        let speed = f64::from(count) / 80.0 / ((tick - since) as f64 / 1e7);
        if self.changed_at.get().is_some() && self.slow_at.get().is_none() && speed < 60.0 {
            self.slow_at.set(Some(tick));
        }
        self.window = (tick, 0);
    }
}

/// Sends moves of one length, one for each ok, and once M220.
struct Stream<'a> {
    length: f64,
    x: f64,
    tick: &'a Cell<u64>,
    changed_at: &'a Cell<Option<u64>>,
    awaiting: u32,
    is_done: bool,
}

impl Host for Stream<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting > 0 || self.is_done {
            return;
        }
        self.x += self.length;
        if self.x < 380.0 {
            out.extend(format!("G1 X{:.3} F6000\n", self.x).bytes());
        } else {
            self.is_done = true;
            out.extend(b"M400\n");
        }
        self.awaiting += 1;
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.changed_at.get().is_none() && self.tick.get() > 10_000_000 {
            self.changed_at.set(Some(self.tick.get()));
            out.extend(b"M220 S50\n");
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        if line.starts_with("ok") {
            self.awaiting -= 1;
        }
    }

    fn is_done(&self) -> bool {
        self.is_done && self.awaiting == 0
    }
}

/// How long until the tool is as slow as M220 S50 wants it, in ms.
fn delay(length: f64, settings: &Settings) -> f64 {
    let (tick, slow_at, changed_at) = (Cell::new(0), Cell::new(None), Cell::new(None));
    let mut host = Stream { length, x: 0.0, tick: &tick, changed_at: &changed_at, awaiting: 0, is_done: false };
    let mut speed = Speed { tick: &tick, slow_at: &slow_at, changed_at: &changed_at, window: (0, 0) };
    let start = Some([0, 100, 10].map(Mm::from_num));
    run(settings, start, &mut host, &mut speed).unwrap();
    (slow_at.get().unwrap() - changed_at.get().unwrap()) as f64 / 1e4
}

#[test]
fn an_override_reaches_the_tool_within_100_ms() {
    let plain = Settings::prototype();
    let mut shaped = plain;
    shaped.shapers.x = Shaper::new(ShaperKind::Mzv, Hertz::from_num(60), Ratio::from_num(0.1));
    for length in [0.1, 0.2, 0.5, 1.0, 1.5] {
        let [plain, shaped] = [plain, shaped].map(|settings| delay(length, &settings));
        println!("moves of {length} mm: {plain:.0} ms, shaped {shaped:.0} ms");
        assert!(plain < 100.0 && shaped < 100.0, "{length}: {plain} ms, shaped {shaped} ms");
    }
}

/// Checks the played events.
struct Steps<'a> {
    checker: Checker,
    tick: &'a Cell<u64>,
    counts: [i64; MOTORS],
}

impl Sink for Steps<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.tick.set(tick);
        self.checker.event(tick, steps, forward);
        for (count, motor) in self.counts.iter_mut().zip(Motor::ALL) {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
    }

    fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }
}

/// Prints lines, and changes overrides during the print, each after a motion time.
struct Fiddler<'a> {
    lines: std::vec::IntoIter<String>,
    words: std::iter::Peekable<std::vec::IntoIter<(u64, String)>>,
    tick: &'a Cell<u64>,
    awaiting: u32,
    heard: Vec<String>,
}

impl Host for Fiddler<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting == 0
            && let Some(line) = self.lines.next()
        {
            out.extend(line.bytes());
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        while let Some((_, word)) = self.words.next_if(|(at, _)| *at <= self.tick.get()) {
            out.extend(word.bytes());
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        if line == "ok" {
            self.awaiting -= 1;
        }
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.lines.len() == 0 && self.awaiting == 0
    }
}

struct Print {
    ticks: u64,
    counts: [i64; MOTORS],
    findings: Findings,
    heard: Vec<String>,
}

fn print(lines: Vec<String>, words: Vec<(u64, String)>) -> Print {
    let settings = Settings::prototype();
    let mut limits = Limits::new(&settings, None, "");
    limits.of.iter_mut().for_each(|limit| limit.hard_stop = 0.0);
    let tick = Cell::new(0);
    let mut steps = Steps { checker: Checker::new(&settings, &limits), tick: &tick, counts: [0; MOTORS] };
    let (lines, words) = (lines.into_iter(), words.into_iter().peekable());
    let mut host = Fiddler { lines, words, tick: &tick, awaiting: 0, heard: Vec::new() };
    let outcome = run(&settings, Some([100, 100, 10].map(Mm::from_num)), &mut host, &mut steps).unwrap();
    let Steps { checker, counts, .. } = steps;
    Print { ticks: tick.get(), counts, findings: checker.finish(Some(outcome.counts)), heard: host.heard }
}

fn line_of(moves: usize) -> Vec<String> {
    let mut lines = vec!["M83".to_owned(), "G91".to_owned(), "G1 F6000".to_owned()];
    lines.extend((0..moves).map(|_| "G1 X1 E.05".to_owned()));
    lines.push("M400".to_owned());
    lines
}

#[test]
fn the_program_counts_its_filament_as_before() {
    let mut lines = line_of(250);
    lines.extend(["M114", "G90", "M82", "G1 E12.5", "G1 E13.5", "M400", "M114 R"].map(str::to_owned));
    let print = print(lines, vec![(10_000_000, "M221 S150".to_owned()), (16_000_000, "M221 S80".to_owned())]);
    let told: Vec<_> = print.heard.iter().filter(|line| line.starts_with("X:")).collect();
    assert!(told[0].contains("E:12.50 ") && told[1].contains("E:13.50 "), "{told:?}");
}

#[test]
fn a_faster_print_ends_sooner() {
    let slow = print(line_of(250), vec![]);
    let fast = print(line_of(250), vec![(10_000_000, "M220 S200".to_owned())]);
    assert_eq!(fast.findings.total, 0, "{:?}", fast.findings.first);
    assert_eq!(slow.counts, fast.counts);
    let saved = (slow.ticks - fast.ticks) as f64 / 1e7;
    assert!((saved - 0.75).abs() < 0.1, "{saved} s of the last 1.5 s");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_override_asks_too_much(
        moves in proptest::collection::vec((-300i32..300, -300i32..300, -6i32..6, 0i32..200, 600u32..18000), 3..120),
        scale in prop_oneof![Just(0.1), Just(0.02), Just(0.005)],
        changes in proptest::collection::vec((1u64..15_000_000, 10u16..400, any::<bool>()), 1..12),
    ) {
        let mut program = vec!["M83".to_owned(), "G91".to_owned(), "M211 S0".to_owned()];
        for (x, y, z, e, f) in moves {
            let [x, y, z, e] = [x, y, z, e].map(|v| f64::from(v) * scale);
            program.push(format!("G1 X{x:.3} Y{y:.3} Z{:.3} E{:.4} F{f}", z / 20.0, e / 100.0));
        }
        program.extend(["G90", "G1 X50 Y60 Z10 F9000", "M400", "M114 R"].map(str::to_owned));
        let word = |(at, percent, is_feed)| (at, format!("M22{} S{percent}", if is_feed { 0 } else { 1 }));
        let mut words: Vec<_> = changes.into_iter().map(word).collect();
        words.sort();
        let print = print(program, words);
        prop_assert_eq!(print.findings.total, 0, "{:?}", print.findings.first);
        let told = print.heard.iter().find(|line| line.starts_with("X:")).unwrap();
        prop_assert!(told.starts_with("X:50.00 Y:60.00 Z:10.00 "), "{}", told);
    }
}
