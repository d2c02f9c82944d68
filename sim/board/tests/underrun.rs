//! Hosts that are too slow: the machine slows down before it starves, goes on without a blob, adapts to its host's
//! speed, and reports that in M122. Hosts that are just fast enough leave no trace.

use corehbot::motors::{MOTORS, MotorSet, prototype};
use corehbot::port::NoStorage;
use corehbot::settings::{Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Mm, Seconds, TICKS_PER_MS};
use corehbot_sim::check::Checker;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Desk, Outcome, Sink, World};

/// Every event: motion time, and the counts of v = x - y (which is x here) and e after it. Checks them too.
struct Steps {
    checker: Checker,
    at: [i64; 2],
    all: Vec<(u64, [i64; 2])>,
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.checker.event(tick, steps, forward);
        for (at, motor) in self.at.iter_mut().zip([prototype::M8, prototype::E0]) {
            if steps.has(motor) {
                *at += if forward.has(motor) { 1 } else { -1 };
            }
        }
        self.all.push((tick, self.at));
    }

    fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }
}

impl Steps {
    fn new(settings: &Settings) -> Self {
        Self { checker: Checker::new(settings, &Limits::new(settings, None, "")), at: [0; 2], all: Vec::new() }
    }

    /// The speed along x in mm/s, over windows of `ms` ms.
    fn speeds(&self, ms: u64) -> Vec<f64> {
        let window = ms * u64::from(TICKS_PER_MS);
        let end = self.all.last().map_or(0, |(tick, _)| *tick);
        let at = |time: u64| match self.all.partition_point(|(tick, _)| *tick <= time) {
            0 => 0,
            next => self.all[next - 1].1[0],
        };
        (0..end / window).map(|i| (at((i + 1) * window) - at(i * window)) as f64 / 80.0 * 1e3 / ms as f64).collect()
    }
}

/// The result of a print.
struct Print {
    outcome: Outcome,
    heard: Vec<String>,
    /// The counts of the motors before each line that came later than 500 ms.
    rests: Vec<[i32; MOTORS]>,
}

/// Sends a line for each `ok`, but none before its time: `pace` gives the ms after the previous line.
fn send(settings: &Settings, lines: &[String], pace: impl Fn(usize) -> u64, sink: &mut dyn Sink) -> Print {
    let drivers = Drivers::new();
    let mut desk = Desk::new(1);
    let start = Some([0, 100, 10].map(Mm::from_num));
    let mut world = World::new(&mut desk, settings, start, NoStorage, &drivers, sink);
    let (mut sent, mut answered, mut due) = (0, 0, 0);
    let (mut heard, mut rests) = (String::new(), Vec::new());
    while answered < lines.len() {
        world.poll();
        let news = world.wires()[0].heard();
        if !news.is_empty() {
            heard.push_str(&String::from_utf8(news).unwrap());
            let is_ok = |line: &&str| line.starts_with("ok") && line.ends_with('\n');
            answered = heard.split_inclusive('\n').filter(is_ok).count();
        }
        if sent == answered && sent < lines.len() && world.now() >= due {
            if sent > 0 && pace(sent) > 500 {
                rests.push(world.outcome().counts);
            }
            world.wires()[0].put(lines[sent].bytes().chain([b'\n']));
            sent += 1;
            due = world.now() + pace(sent) * u64::from(TICKS_PER_MS);
        }
        world.advance();
    }
    Print { outcome: world.outcome(), heard: heard.lines().map(str::to_owned).collect(), rests }
}

/// The way is 380 mm along x in moves of `length` mm at 100 mm/s, with 0.05 mm of filament a mm: a step of e for four
/// of x.
fn lines(length: f64) -> Vec<String> {
    let mut lines = vec!["M83".to_owned(), "G1 F6000".to_owned()];
    for i in 0..(380.0 / length) as usize {
        lines.push(format!("G1 X{:.3} E{:.5}", length * (i + 1) as f64, 0.05 * length));
    }
    lines.push("M400".to_owned());
    lines
}

#[test]
fn a_print_comes_to_be_as_fast_as_its_host() {
    // 100 mm/s are commanded; the host supplies moves for `supply` mm/s.
    for (length, ms, supply) in
        [(0.5, 6, 83.0), (0.5, 8, 62.0), (0.5, 12, 42.0), (0.5, 20, 25.0), (2.0, 25, 80.0), (2.0, 40, 50.0)]
    {
        let settings = Settings::prototype();
        let mut steps = Steps::new(&settings);
        let print = send(&settings, &lines(length), |_| ms, &mut steps);
        let speeds = steps.speeds(10);
        let findings = steps.checker.finish(Some(print.outcome.counts));
        assert_eq!(findings.total, 0, "{:?}", findings.first);
        // At first it is as fast as commanded, because it has gathered moves, until the stream runs dry for the first
        // time.
        assert!(speeds[..20].iter().any(|speed| *speed > 99.0));
        let slow = speeds.iter().skip(10).position(|speed| *speed < 0.95 * 100.0).unwrap() + 10;
        // A second later it has found its speed, as long as the host keeps its pace.
        let settled = &speeds[slow + 100..speeds.len() - 40];
        let least = settled.iter().copied().fold(f64::MAX, f64::min);
        let most = settled.iter().copied().fold(0.0, f64::max);
        println!("{length} mm in {ms} ms: {least:.0} to {most:.0} mm/s, {} underruns", print.outcome.underruns);
        assert!(settled.len() > 50);
        assert!(least > 0.75 * supply, "{length} mm in {ms} ms: {least} mm/s");
        assert!(most < 1.25 * supply, "{length} mm in {ms} ms: {most} mm/s");
        assert!(print.outcome.underruns <= 3, "{length} mm in {ms} ms: {} underruns", print.outcome.underruns);
    }
}

#[test]
fn filament_keeps_to_the_path_however_slow_the_host_is() {
    for pace in
        [|_: usize| 8, |_: usize| 40, |i: usize| if i % 100 == 99 { 1000 } else { 3 }, |i: usize| (i % 7) as u64 * 6]
    {
        let settings = Settings::prototype();
        let mut steps = Steps::new(&settings);
        let print = send(&settings, &lines(0.5), pace, &mut steps);
        assert!(print.outcome.underruns > 0);
        for (tick, [x, e]) in &steps.all {
            assert!((4 * e - x).abs() <= 4, "at tick {tick}: {e} steps of e, {x} of x");
        }
        assert_eq!(steps.at, [380 * 80, 380 * 20]);
    }
}

#[test]
fn an_advance_leaves_no_blob_where_the_host_pauses() {
    let mut settings = Settings::prototype();
    settings.advance.time = Seconds::from_num(0.05);
    let mzv = Shaper { kind: ShaperKind::Mzv, frequency: Hertz::from_num(60), ..settings.shapers.x };
    (settings.shapers.x, settings.shapers.y) = (mzv, mzv);
    let mut steps = Steps::new(&settings);
    let print = send(&settings, &lines(0.5), |i| if i % 100 == 99 { 1000 } else { 3 }, &mut steps);
    assert!(print.outcome.underruns > 0);
    assert_eq!(print.rests.len(), 7);
    for rest in print.rests {
        let [m8, e] = [prototype::M8, prototype::E0].map(|motor| rest[motor.index()]);
        assert!((4 * e - m8).abs() <= 4, "{e} steps of e, {m8} of x at rest");
        // The host had sent moves for so far, and all of them were made.
        assert_eq!(m8 % 40, 0, "{m8} steps of x");
    }
    let findings = steps.checker.finish(Some(print.outcome.counts));
    assert_eq!(findings.total, 0, "{:?}", findings.first);
}

#[test]
fn hosts_that_are_fast_enough_leave_no_trace() {
    let settings = Settings::prototype();
    let trace = |pace: &dyn Fn(usize) -> u64| {
        let mut steps = Steps::new(&settings);
        let print = send(&settings, &lines(0.5), pace, &mut steps);
        assert_eq!(print.outcome.underruns, 0);
        steps.all
    };
    let at_once = trace(&|_| 0);
    for pace in [&(|_| 1u64) as &dyn Fn(usize) -> u64, &|_| 3, &|_| 4, &|i| if i % 50 == 49 { 90 } else { 2 }] {
        assert!(trace(pace) == at_once);
    }
}

/// The line of M122 about overload, after these lines.
fn overload(lines: &[String], pace: impl Fn(usize) -> u64) -> (Outcome, String) {
    let settings = Settings::prototype();
    let lines: Vec<_> = lines.iter().cloned().chain(["M122".to_owned()]).collect();
    let print = send(&settings, &lines, pace, &mut Steps::new(&settings));
    let line = print.heard.iter().find_map(|line| line.strip_prefix("echo:overload: ")).unwrap().to_owned();
    (print.outcome, line)
}

/// M122's text when nothing was too slow.
const NOTHING: &str =
    "0 steps late, worst 0 us; 0 spans stretched, worst 0 us; 0 times out of steps, 0 times out of moves";

/// Reproducer: 39 chords of a quarter circle at 0.2 mm/s were 23 times out of steps.
#[test]
fn slow_chords_are_never_out_of_steps() {
    for (feed, radius) in [(12, 5.0), (3, 1.0)] {
        let chord = |i: u32| {
            let angle = f64::from(i) / 39.0 * core::f64::consts::FRAC_PI_2;
            format!("G1 X{:.3} Y{:.3}", radius * angle.sin(), 100.0 + radius * (1.0 - angle.cos()))
        };
        let mut lines = vec![format!("G1 F{feed}")];
        lines.extend((1..=39).map(chord));
        lines.push("M400".to_owned());
        let (outcome, told) = overload(&lines, |_| 0);
        assert_eq!((told.as_str(), outcome.underruns), (NOTHING, 0), "F{feed}");
    }
}

#[test]
fn m122_tells_what_was_too_slow() {
    let (_, told) = overload(&lines(2.0), |_| 0);
    assert_eq!(told, NOTHING);
    let (outcome, told) = overload(&lines(0.5), |_| 40);
    assert!(told.ends_with(&format!("out of steps, {} times out of moves", outcome.underruns)), "{told}");
    assert!(outcome.underruns > 0);
    // Moves of 0.02 mm at 100 mm/s, 0.2 ms each, under a shaper that lasts 150 ms: more than it remembers. Two feeds
    // alternate, because moves with one feed would merge into one line.
    let mut dense = vec!["M593 F10 T4".to_owned()];
    dense.extend((1..4000).map(|i| format!("G1 X{:.2} F{}", 0.02 * f64::from(i), 6000 - i % 2)));
    dense.push("M400".to_owned());
    let (_, told) = overload(&dense, |_| 0);
    println!("{told}");
    let spans = told.split("; ").nth(1).unwrap();
    let numbers: Vec<u32> = spans.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
    assert!(numbers[0] > 100 && numbers[1] > 100, "{told}");
    assert!(told.starts_with("0 steps late"), "{told}");
}
