//! M410: the machine slows down along its path, as its accelerations allow, and knows where it is.

use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Host, Outcome, Sink, run};
use proptest::prelude::*;
use std::cell::RefCell;
use std::rc::Rc;

/// The edges on the step lines.
struct Bench {
    checker: Checker,
    tick: u64,
    /// Steps of u = x + y, v = x - y, z and e.
    counts: [i64; 4],
    /// Length of the tool's path, in mm.
    path: f64,
}

impl Bench {
    fn tool(&self) -> [f64; 3] {
        let [u, v, z, _] = self.counts.map(|n| n as f64);
        [(u + v) / 160.0, (u - v) / 160.0, z / 800.0]
    }
}

#[derive(Clone)]
struct Steps(Rc<RefCell<Bench>>);

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        let mut bench = self.0.borrow_mut();
        bench.checker.event(tick, steps, forward);
        bench.tick = tick;
        let before = bench.tool();
        for (count, motor) in bench.counts.iter_mut().zip([prototype::M11, prototype::M8, prototype::Z1, prototype::E0])
        {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
        let after = bench.tool();
        bench.path += before.iter().zip(after).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    }

    fn stopped(&mut self, tick: u64) {
        self.0.borrow_mut().checker.stopped(tick);
    }
}

/// Motion time, path and place.
#[derive(Clone, Copy, Debug)]
struct Mark {
    ms: f64,
    path: f64,
    at: [f64; 3],
}

/// Prints `lines`, says `word` when so much motion time has passed or the printer is busy, and then `after`.
struct Stopper {
    steps: Steps,
    lines: Vec<String>,
    after: Vec<String>,
    word: &'static str,
    at: u64,
    asked: Option<Mark>,
    rested: Option<Mark>,
    awaiting: usize,
    heard: Vec<String>,
}

impl Stopper {
    fn mark(&self) -> Mark {
        let bench = self.steps.0.borrow();
        Mark { ms: bench.tick as f64 / 1e4, path: bench.path, at: bench.tool() }
    }

    fn next(&mut self, out: &mut Vec<u8>) {
        let lines = if self.asked.is_some() { &mut self.after } else { &mut self.lines };
        if !lines.is_empty() {
            out.extend(lines.remove(0).bytes());
            out.push(b'\n');
            self.awaiting += 1;
        }
    }
}

impl Host for Stopper {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting == 0 {
            self.next(out);
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        let is_time = self.steps.0.borrow().tick >= self.at;
        let is_busy = self.heard.last().is_some_and(|line| line.starts_with("echo:busy"));
        let is_over = self.lines.is_empty() && self.awaiting == 0;
        if self.asked.is_none() && (is_time || is_busy || is_over) {
            self.asked = Some(self.mark());
            out.extend(self.word.bytes());
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        if line == "ok" {
            self.awaiting -= 1;
            if self.asked.is_some() && self.awaiting == 0 && self.rested.is_none() {
                self.rested = Some(self.mark());
            }
        }
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.asked.is_some() && self.after.is_empty() && self.awaiting == 0
    }
}

struct Stop {
    asked: Mark,
    rested: Mark,
    heard: Vec<String>,
    findings: Findings,
    outcome: Outcome,
}

impl Stop {
    fn ms(&self) -> f64 {
        self.rested.ms - self.asked.ms
    }

    fn path(&self) -> f64 {
        self.rested.path - self.asked.path
    }
}

fn stop(word: &'static str, lines: &[String], at_ms: f64, after: &[&str]) -> Stop {
    let settings = Settings::prototype();
    let mut limits = Limits::new(&settings, None, "");
    // No switch stops anything here.
    limits.of.iter_mut().for_each(|limit| limit.hard_stop = 0.0);
    let counts = [16000, 0, 8000, 0];
    let bench = Bench { checker: Checker::new(&settings, &limits), tick: 0, counts, path: 0.0 };
    let mut steps = Steps(Rc::new(RefCell::new(bench)));
    let mut host = Stopper {
        steps: steps.clone(),
        lines: lines.to_vec(),
        after: after.iter().map(|line| (*line).to_owned()).collect(),
        word,
        at: (at_ms * 1e4) as u64,
        asked: None,
        rested: None,
        awaiting: 0,
        heard: Vec::new(),
    };
    let outcome = run(&settings, Some([100, 100, 10].map(Mm::from_num)), &mut host, &mut steps).unwrap();
    let (asked, rested, heard) = (host.asked.unwrap(), host.rested.unwrap_or_else(|| host.mark()), host.heard.clone());
    drop(host);
    let bench = Rc::into_inner(steps.0).unwrap().into_inner();
    Stop { asked, rested, heard, findings: bench.checker.finish(Some(outcome.counts)), outcome }
}

/// Stops, and continues to a place where the position shows any lost step.
fn stop_and_go_on(lines: &[String], at_ms: f64) -> Stop {
    let after = ["M114 R", "M114", "G90", "G1 X50 Y60 Z10 F9000", "M400", "M114 R"];
    let stop = stop("M410", lines, at_ms, &after);
    assert_eq!(stop.findings.total, 0, "at {at_ms} ms: {:?}", stop.findings.first);
    let told: Vec<_> = stop.heard.iter().filter(|line| line.starts_with("X:")).collect();
    assert_eq!(told[0], told[1], "what is commanded is what is");
    assert!(told[2].starts_with("X:50.00 Y:60.00 Z:10.00 "), "{told:?}");
    assert!(!stop.outcome.halted);
    // 80 steps/mm: u = 110 mm and v = -10 mm from u = 200 mm, v = 0.
    let [_, _, m8, m11, ..] = stop.outcome.counts;
    assert_eq!((m11, m8), (-7200, -800), "{:?}", stop.outcome.counts);
    stop
}

fn lines(text: &[&str]) -> Vec<String> {
    text.iter().map(|line| (*line).to_owned()).collect()
}

#[test]
fn the_measure_has_teeth() {
    // An emergency stop is as sudden as a stop can be.
    let stop = stop("M112", &lines(&["G1 X300 F12000", "M400"]), 300.0, &[]);
    assert!(stop.outcome.halted && stop.findings.total > 0);
}

#[test]
fn a_fast_move_slows_down_on_its_way() {
    for (feed, acceleration) in
        [(18000.0, 5000.0), (12000.0, 5000.0), (6000.0, 5000.0), (3000.0, 5000.0), (600.0, 5000.0)]
    {
        let stop = stop_and_go_on(&lines(&[&format!("G1 X380 F{feed}"), "M400"]), 320.0);
        let speed = feed / 60.0;
        let (least_ms, least_mm) = (speed / acceleration * 1e3, speed * speed / 2.0 / acceleration);
        println!("{speed} mm/s: {:.1} ms ({least_ms:.1}), {:.2} mm ({least_mm:.2})", stop.ms(), stop.path());
        // 10 ms are made already, and a command is heard within 1 ms.
        assert!(stop.ms() < least_ms + 14.0 && stop.ms() > least_ms * 0.9, "{feed}");
        assert!(stop.path() < least_mm + speed * 0.014 + 0.1 && stop.path() > least_mm * 0.9, "{feed}");
        assert!((stop.rested.at[1] - 100.0).abs() < 1e-9);
    }
}

#[test]
fn a_slanted_move_ends_on_its_line() {
    let stop = stop_and_go_on(&lines(&["G1 X300 Y150 Z14 F9000", "M400"]), 500.0);
    let [x, y, z] = stop.rested.at;
    assert!((y - 100.0 - (x - 100.0) / 4.0).abs() < 0.03, "{x} {y}");
    assert!((z - 10.0 - (x - 100.0) / 50.0).abs() < 0.01, "{x} {z}");
}

#[test]
fn a_stop_leads_round_corners_that_are_too_near_to_stop_before() {
    // A circle of 20 mm at 100 mm/s, in chords of half a millimetre.
    let mut circle = lines(&["G1 F6000"]);
    for i in 1..=200 {
        let a = f64::from(i) * std::f64::consts::TAU / 250.0;
        circle.push(format!("G1 X{:.3} Y{:.3}", 80.0 + 20.0 * a.cos(), 100.0 + 20.0 * a.sin()));
    }
    circle.push("M400".to_owned());
    for at in [100.0, 333.0, 500.0, 700.0] {
        let stop = stop_and_go_on(&circle, at);
        let [x, y, _] = stop.rested.at;
        assert!(((x - 80.0).hypot(y - 100.0) - 20.0).abs() < 0.03, "{x} {y}");
        println!("circle at {at} ms: {:.1} ms, {:.2} mm", stop.ms(), stop.path());
        assert!(stop.ms() < 60.0 && stop.path() < 3.5);
    }
}

#[test]
fn screws_and_filament_slow_down_too() {
    let stop = stop_and_go_on(&lines(&["G1 Z40 F1200", "M400"]), 700.0);
    println!("Z at 20 mm/s: {:.1} ms, {:.2} mm", stop.ms(), stop.path());
    assert!(stop.ms() < 115.0 && stop.ms() > 90.0, "{}", stop.ms());
    stop_and_go_on(&lines(&["M83", "G1 E60 F4800", "M400"]), 400.0);
    stop_and_go_on(&lines(&["M83", "G1 X300 E20 F6000", "M400"]), 400.0);
}

#[test]
fn a_stop_at_rest_is_one_at_once() {
    let stop = stop_and_go_on(&lines(&["G1 X110 F6000", "G4 S20"]), 1e9);
    assert!(stop.ms() < 1.0 && stop.path() < 1e-9);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_stop_asks_too_much(
        moves in proptest::collection::vec((-300i32..300, -300i32..300, -6i32..6, 0u32..200, 600u32..18000), 3..80),
        scale in prop_oneof![Just(0.1), Just(0.02), Just(0.005)],
        at_ms in 1.0..900.0,
    ) {
        let mut program = lines(&["M83", "G91", "M211 S0"]);
        for (x, y, z, e, f) in moves {
            let [x, y, z, e] = [x, y, z, e.cast_signed()].map(|v| f64::from(v) * scale);
            program.push(format!("G1 X{x:.3} Y{y:.3} Z{:.3} E{:.4} F{f}", z / 20.0, e / 100.0));
        }
        let after = ["M114 R", "M114", "G90", "G1 X50 Y60 Z10 F9000", "M400", "M114 R"];
        let stop = stop("M410", &program, at_ms, &after);
        prop_assert_eq!(stop.findings.total, 0, "{:?}", stop.findings.first);
        let told: Vec<_> = stop.heard.iter().filter(|line| line.starts_with("X:")).collect();
        prop_assert_eq!(told[0], told[1]);
        prop_assert!(told[2].starts_with("X:50.00 Y:60.00 Z:10.00 "), "{:?}", told);
    }
}
