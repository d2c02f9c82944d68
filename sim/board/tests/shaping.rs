//! M593 and M900 through the whole simulator: ends of prints, the checker's findings, and commands that wait for the
//! motion.

use corehbot::motors::{MotorSet, prototype};
use corehbot::port::{NoStorage, Storage};
use corehbot::settings::{Settings, ShaperKind};
use corehbot::units::{Hertz, Mm, Seconds};
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Host, Outcome, Sink, run_with};
use std::cell::Cell;

/// Checks the played events, and counts them.
struct Steps<'a> {
    checker: Checker,
    tick: &'a Cell<u64>,
    /// Steps of u = x + y, v = x - y, z and e.
    counts: [i64; 4],
}

impl Sink for Steps<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.checker.event(tick, steps, forward);
        self.tick.set(tick);
        for (count, motor) in self.counts.iter_mut().zip([prototype::M11, prototype::M8, prototype::Z1, prototype::E0])
        {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
    }

    fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }
}

/// Sends a line for each `ok`, and M410 when so much motion time has passed.
struct Printer<'a> {
    lines: std::str::Lines<'a>,
    tick: &'a Cell<u64>,
    stop_at: Option<u64>,
    awaiting: usize,
    heard: Vec<String>,
}

impl Host for Printer<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting == 0
            && let Some(line) = self.lines.next()
        {
            out.extend(line.bytes().chain([b'\n']));
            self.awaiting = 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.stop_at.is_some_and(|at| self.tick.get() >= at) {
            self.stop_at = None;
            self.lines = "M400\nM114\nM114 R\nG90\nG1 X100 Y100 Z10 F6000\nM400\n".lines();
            out.extend(b"M410\n");
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        self.awaiting -= usize::from(line.starts_with("ok"));
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.awaiting == 0 && self.lines.clone().next().is_none()
    }
}

struct Print {
    /// How far x, y, z and e have gone, in steps.
    way: [i64; 4],
    /// Motion time, in ticks.
    time: u64,
    heard: Vec<String>,
    findings: Findings,
    outcome: Outcome,
}

fn play(settings: &Settings, storage: impl Storage, gcode: &str, stop_at: Option<u64>) -> Print {
    let tick = Cell::new(0);
    let mut host = Printer { lines: gcode.lines(), tick: &tick, stop_at, awaiting: 0, heard: Vec::new() };
    let mut steps =
        Steps { checker: Checker::new(settings, &Limits::new(settings, None, gcode)), tick: &tick, counts: [0; 4] };
    let start = Some([100, 100, 10].map(Mm::from_num));
    let outcome = run_with(settings, start, storage, &mut [&mut host], &mut steps).unwrap();
    let [u, v, z, e] = steps.counts;
    let findings = steps.checker.finish(None);
    Print { way: [(u + v) / 2, (u - v) / 2, z, e], time: tick.get(), heard: host.heard, findings, outcome }
}

fn print(gcode: &str) -> Print {
    play(&Settings::prototype(), NoStorage, gcode, None)
}

/// A print of corners, curves, travels and retractions, which comes back to where it began; `between` stands before
/// each of its rounds.
fn rounds(between: impl Fn(u32) -> String) -> String {
    let mut gcode = "M83\nG1 X110 Y100 F9000\n".to_owned();
    for round in 0..8 {
        gcode += &between(round);
        gcode += "G1 X130 E1 F6000\nG1 Y120 E1\nG1 X120 Y123 E.5\nG3 X110 Y110 I-5 J-8 E1\nG1 X111 Y109 E.05\n";
        gcode += "G1 E-.8 F2100\nG0 X150 Y90 Z10.2 F12000\nG0 X110 Y100\nG1 E.8 F2100\n";
    }
    gcode + "G1 Z10\nM400\n"
}

/// Eight rounds end 10 mm to the right, with 8 x 3.55 mm of filament.
const WAY: [i64; 4] = [800, 0, 0, 11_360];

#[test]
fn shaped_prints_end_where_they_were_sent_and_keep_the_limits() {
    let shapers = ["M593 F0", "M593 F60 D.1 T0", "M593 F60 T1", "M593 X F107.5 T2\nM593 Y F61.1 T2"];
    for shaper in shapers.into_iter().chain(["M593 F40 T3", "M593 F45 T4"]) {
        for advance in ["M900 K0", "M900 K.03", "M572 S.06 W.02"] {
            let print = print(&format!("{shaper}\n{advance}\n{}", rounds(|_| String::new())));
            assert_eq!(print.way, WAY, "{shaper} {advance}");
            assert_eq!(print.findings.total, 0, "{shaper} {advance}: {:?}", print.findings.first);
            assert!(!print.outcome.halted);
        }
    }
}

#[test]
fn the_checker_knows_how_fast_the_advance_may_push() {
    for advance in ["M900 K.05", "M572 S.3 W.02", "M900 K1"] {
        let print = print(&format!("{advance}\nM83\nG1 X150 E20 F6000\nG1 X150 Y150 E20\nG1 X140 E4\nM400\n"));
        assert_eq!(print.way, [3200, 4000, 0, 17_600], "{advance}");
        assert_eq!(print.findings.total, 0, "{advance}: {:?}", print.findings.first);
    }
}

/// One row of lines at 150 mm/s and 5 m/s2, after the setup line.
fn fast_lines(setup: &str) -> Print {
    let line = |i: u32| format!("G1 X{} E2 F9000\n", if i.is_multiple_of(2) { 160 } else { 100 });
    print(&format!("M204 P5000\n{setup}\nM83\n{}M400\n", (0..8).map(line).collect::<String>()))
}

/// 115 mm/s of an extruder that has 80, before the planner knew of the advance.
#[test]
fn a_long_advance_stays_within_the_extruders_limits() {
    for setup in ["M900 K.9", "M572 S.9 W.04", "M572 S.9 W.005", "M572 S4 W.2", "M593 F57.8 T2\nM900 K.9"] {
        let print = fast_lines(setup);
        assert_eq!(print.way, [0, 0, 0, 6400], "{setup}");
        assert_eq!(print.findings.total, 0, "{setup}: {:?}", print.findings.first);
    }
    // A direct drive's advance costs only the time of a longer delay.
    let [plain, advanced] = ["M900 K0", "M900 K.05"].map(|setup| fast_lines(setup).time);
    assert!(advanced < plain + 130_000, "{advanced} {plain}");
}

#[test]
fn an_advance_that_changes_does_not_wait_for_the_motion() {
    let time = |between: &dyn Fn(u32) -> String| {
        let print = print(&format!("M900 K.03\n{}", rounds(between)));
        assert_eq!(print.way, WAY);
        assert_eq!(print.findings.total, 0, "{:?}", print.findings.first);
        print.time
    };
    let steady = time(&|_| String::new());
    let changed = time(&|round| format!("M900 K{}\n", f64::from(round % 4) * 0.015));
    let waited = time(&|_| "M400\n".to_owned());
    println!("steady {steady}, changed {changed}, waited {waited} ticks");
    // Where the flow jumps, a corner is slower with more of it; eight waits would cost ten times as much.
    assert!(steady.abs_diff(changed) < 200_000, "{steady} {changed}");
    assert!(waited > steady + 7 * 100_000, "{waited} {steady}");
    // Neither does a shaper that stays the same.
    assert_eq!(time(&|_| "M593 F0\n".to_owned()), steady);
}

/// Brakes at a time, in ms of motion, and goes back to where the print began.
fn brake_at(settings: &Settings, setup: &str, at: u64) {
    let gcode = format!("{setup}\n{}", rounds(|_| String::new()));
    let print = play(settings, NoStorage, &gcode, Some(at * 10_000));
    let told: Vec<_> = print.heard.iter().filter(|line| line.starts_with("X:")).collect();
    let [x, y, z, e] = print.way;
    assert_eq!([x, y, z], [0; 3], "{setup} {at}: the way back is not that which was told");
    assert_eq!(told.len(), 2);
    assert_eq!(told[0], told[1]);
    let filament = told[0].split(['E', ' ']).find_map(|word| word.strip_prefix(':')?.parse::<f64>().ok()).unwrap();
    // M114 rounds to two decimals.
    assert!((e as f64 / 400.0 - filament).abs() < 0.0051, "{e} {filament}");
    assert_eq!(print.findings.total, 0, "{setup} {at}: {:?}", print.findings.first);
}

#[test]
fn a_brake_ends_at_a_true_position() {
    for setup in ["M593 F60 T2\nM900 K.05", "M900 K.05", "M593 X F107.5 T3\nM593 Y F61.1 T4\nM572 S.3 W.02"] {
        for at in (0..1500).step_by(61) {
            brake_at(&Settings::prototype(), setup, at);
            brake_at(&stiffening(), setup, at);
        }
    }
}

/// Belts that are much stiffer at the ends of an axis, where these prints are, than in its middle.
fn stiffening() -> Settings {
    let mut s = Settings::prototype();
    (s.shapers.x.span, s.shapers.y.span) = (Mm::from_num(500), Mm::from_num(600));
    s
}

#[test]
fn taps_that_stand_closer_off_the_middle_change_no_end_and_no_limit() {
    for shaper in ["M593 F40 T0", "M593 F60 T1", "M593 F20 T2", "M593 F40 T3", "M593 F30 T4"] {
        let gcode = format!("{shaper}\nM900 K.03\n{}", rounds(|_| String::new()));
        let [even, closer] = [Settings::prototype(), stiffening()].map(|s| play(&s, NoStorage, &gcode, None));
        assert_eq!((even.way, closer.way), (WAY, WAY), "{shaper}");
        assert_eq!(even.time, closer.time, "{shaper}: the mean of the taps is as late as before");
        assert_eq!(closer.findings.total, 0, "{shaper}: {:?}", closer.findings.first);
    }
}

#[test]
fn a_shaper_waits_for_the_motion_and_makes_it_longer() {
    let set = print("G1 X150 F6000\nM593 X F60 T2\nG1 X160\nM400\nM593\n");
    let waited = print("G1 X150 F6000\nM400\nG1 X160\nM400\n");
    assert!(set.heard.iter().any(|line| line == "  M593 X F60 D0.1 T2"), "{:?}", set.heard);
    // By three quarters of a period, and its last step is further from its end: the last impulse moves it alone.
    let longer = (set.time - waited.time) as f64 / 1e4;
    assert!((10.5..12.56).contains(&longer), "{longer} ms");
}

#[test]
fn homing_with_shapers_finds_the_endstops() {
    let print = print("M593 F40 T3\nM900 K.05\nG28\nG1 X20 Y30 Z5 F6000\nM400\nM114 R\n");
    let told = print.heard.iter().find(|line| line.starts_with("X:")).unwrap();
    assert!(told.starts_with("X:20.00 Y:30.00 Z:5.00 "), "{told}");
    assert_eq!(print.findings.total, 0, "{:?}", print.findings.first);
}

/// The window of M503.
fn window(heard: &[String]) -> &str {
    heard.iter().rev().find_map(|line| line.strip_prefix("echo:  M572 ")).unwrap()
}

#[test]
fn the_window_follows_the_shapers_in_the_middle_of_a_print() {
    let shapers =
        ["M593 F57.8 T2", "M593 F57.8 T0", "M593 F57.8 T3", "M593 F0", "M593 X F107.5 T2", "M572 W.03", "M572 W0"];
    let between = |round: u32| format!("{}\nM503\n", shapers[round as usize % shapers.len()]);
    let print = print(&format!("M900 K.05\n{}", rounds(between)));
    assert_eq!((print.way, print.findings.total), (WAY, 0), "{:?}", print.findings.first);
    let told: Vec<_> = print.heard.iter().filter_map(|line| line.strip_prefix("echo:  M572 ")).collect();
    let auto = |seconds: &str| format!("W0 ; auto: {seconds} s");
    let expected = ["0.0133", "0.0116", "0.017", "0.012", "0.012"].map(auto).into_iter();
    let expected: Vec<_> = expected.chain(["W0.03".to_owned(), auto("0.012"), auto("0.0133")]).collect();
    assert_eq!(told, expected);
}

#[test]
fn a_second_print_is_as_the_first() {
    let setup = "M593 F57.8 T2\nM900 K.05\n";
    let [once, twice, thrice] = [1, 2, 3].map(|times| {
        // Each begins where the previous one began, with its own lines, as slicers write them.
        let all = vec![format!("{setup}{}G1 X110 Y100\nG1 X100\nM400\n", rounds(|_| String::new())); times].concat();
        let print = print(&all);
        assert_eq!(print.findings.total, 0, "{:?}", print.findings.first);
        (print.time, print.way)
    });
    assert_eq!(thrice.0 - twice.0, twice.0 - once.0);
    assert_eq!(twice.1[3], 2 * once.1[3]);
}

#[test]
fn a_longer_window_is_waited_for_once() {
    // From 0.2 s on, the extruder needs more than 12 ms.
    let time = |between: &dyn Fn(u32) -> String| {
        let print = print(&format!("M900 K.3\n{}", rounds(between)));
        assert_eq!((print.way, print.findings.total), (WAY, 0), "{:?}", print.findings.first);
        print.time
    };
    let steady = time(&|_| "M900 K.3\n".to_owned());
    // Nothing waits for an advance that goes down and comes back.
    let changed = time(&|round| format!("M900 K{}\n", [".3", ".05"][round as usize % 2]));
    assert!(changed <= steady, "{changed} {steady}");
    let grown = time(&|round| format!("M900 K.3{round}\n"));
    assert!(grown < steady + 8 * 600_000, "{grown} {steady}");
}

#[test]
fn stored_windows_come_back() {
    let mut eeprom = Eeprom::blank();
    let lines = "M593 F57.8 T2\nM900 K.05\nM572 W.03\nM500\nM503\nM502\nM503\nM501\nM503\nM572 W0\nM500\nM503\n";
    let heard = play(&Settings::prototype(), &mut eeprom, lines, None).heard;
    let told: Vec<_> = heard.iter().filter_map(|line| line.strip_prefix("echo:  M572 ")).collect();
    assert_eq!(told, ["W0.03", "W0 ; auto: 0.012 s", "W0.03", "W0 ; auto: 0.0133 s"]);
    let gcode = format!("M501\n{}M503\n", rounds(|_| String::new()));
    let print = play(&Settings::prototype(), &mut eeprom, &gcode, None);
    assert_eq!((print.way, print.findings.total), (WAY, 0), "{:?}", print.findings.first);
    assert_eq!(window(&print.heard), "W0 ; auto: 0.0133 s");
}

#[test]
fn settings_are_reported_as_the_lines_that_set_them() {
    let lines = "M593 X F60 T2\nM593 Y F61.1 D.055 T4\nM900 K1e-05\nM900\nM900 K.05\nM572 W.03\n";
    let heard = print(&format!("{lines}M503\n")).heard;
    for line in ["echo:  M593 X F60 D0.1 T2", "echo:  M593 Y F61.1 D0.055 T4", "echo:  M900 K0.05", "echo:  M572 W0.03"]
    {
        assert!(heard.iter().any(|heard| heard == line), "{line}: {heard:?}");
    }
    assert!(heard.iter().any(|heard| heard == "echo:Advance K=0.00001"), "{heard:?}");
    let refused = print("M593 F5 D.9\nM593\nM572 S9 W1\nM503\nM502\nM593\nM900\n").heard;
    for line in ["echo:  M593 X F0", "echo:  M900 K0", "echo:  M572 W0 ; auto: 0.012 s", "  M593 Y F0"] {
        assert!(refused.iter().any(|heard| heard == line), "{line}: {refused:?}");
    }
    assert_eq!(refused.last().unwrap(), "ok");
}

#[test]
fn shaping_counts_from_the_start_whoever_set_it() {
    let (lines, gcode) = ("M593 F60 T2\nM900 K.05\n", rounds(|_| String::new()));
    let plain = print(&gcode).time;
    let told = print(&format!("{lines}{gcode}")).time;
    assert_ne!(plain, told);
    let mut made = Settings::prototype();
    for shaper in [&mut made.shapers.x, &mut made.shapers.y] {
        (shaper.kind, shaper.frequency) = (ShaperKind::Mzv, Hertz::from_num(60));
    }
    made.advance.time = Seconds::from_num(0.05);
    assert_eq!(play(&made, NoStorage, &gcode, None).time, told);
    let mut eeprom = Eeprom::blank();
    play(&Settings::prototype(), &mut eeprom, &format!("{lines}M500\n"), None);
    assert_eq!(play(&Settings::prototype(), &mut eeprom, &gcode, None).time, told);
    assert_eq!(play(&Settings::prototype(), &mut eeprom, &format!("M593 F0\nM900 K0\nM501\n{gcode}"), None).time, told);
}
