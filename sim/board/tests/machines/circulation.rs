//! C: a closed belt runs round, with the tool standing or moving.

use super::print::{Print, Steps, machines, print, steps_of};
use super::stops::Counted;
use corehbot::motors::{MOTORS, MotorSet, per_motor};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::host::FileHost;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Host, Sink, run};
use std::cell::Cell;
use std::collections::VecDeque;

struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _: u64, _: MotorSet, _: MotorSet) {}
}

/// The replies to these lines, on a machine that stands at X100 Y100 Z10.
fn said(s: &Settings, gcode: &str) -> Vec<String> {
    struct Listening(FileHost, Vec<String>);
    impl Host for Listening {
        fn send(&mut self, out: &mut Vec<u8>) {
            self.0.send(out);
        }
        fn hear(&mut self, line: &str) {
            self.1.push(line.to_owned());
            self.0.hear(line);
        }
        fn is_done(&self) -> bool {
            self.0.is_done()
        }
    }
    let mut host = Listening(FileHost::new(gcode), Vec::new());
    run(s, Some([100, 100, 10].map(Mm::from_num)), &mut host, &mut Deaf).unwrap();
    host.1
}

fn printed(gcode: &str) -> Print {
    let print = print(&Settings::prototype(), Some([100, 100, 10].map(Mm::from_num)), gcode);
    assert_eq!(print.findings, Findings::default(), "{gcode}");
    print
}

/// Steps of the four belt motors.
fn belt(print: &Print) -> [i64; 4] {
    *print.counts.first_chunk().unwrap()
}

#[test]
fn all_four_turn_alike_while_the_tool_stands() {
    let there = printed("G1 C12.5 F3000\n");
    assert_eq!(there.counts, per_motor(&[1000; 4], 0));
    assert_eq!(there.events, 1000, "four motors in one edge");
    assert_eq!(belt(&printed("G1 C12.5 F3000\nG1 C12.5\nG91\nG1 C-2.5\nG90\nG1 C0\n")), [0; 4]);
    // 12.5 mm at 50 mm/s with ramps of 1500 mm/s2.
    let seconds = there.outcome.ticks as f64 / 1e7;
    assert!((seconds - (12.5 / 50.0 + 50.0 / 1500.0)).abs() < 0.002, "{seconds} s");
}

#[test]
fn the_belt_keeps_to_limits_of_its_own() {
    let seconds = printed("G1 C200 F60000\n").outcome.ticks as f64 / 1e7;
    assert!((seconds - (200.0 / 100.0 + 100.0 / 1500.0)).abs() < 0.002, "{seconds} s");
}

/// Equation 8 of the paper: each motor makes its sum of x, y and c.
#[test]
fn it_runs_round_while_the_tool_moves() {
    let s = Settings::prototype();
    let print = printed("G1 X103.007 Y98.511 F3000\nG1 X140 Y90 C-30\nG1 X120.5 Y120.25 F6000\n");
    let from = steps_of(&s, [100.0, 100.0, 0.0, 0.0]);
    let to = steps_of(&s, [120.5, 120.25, 0.0, 0.0]);
    let (from, to) = (s.mechanism.inverse(from), s.mechanism.inverse(to));
    let wanted: [i64; 4] = std::array::from_fn(|motor| to[motor] - from[motor] - 30 * 80);
    assert_eq!(belt(&print), wanted);
}

/// Lines before and after are as without it: the same steps except for the belt's.
#[test]
fn prints_go_on_as_if_nothing_had_been() {
    let body = "G1 X120 Y110 F6000\nG2 X140 Y110 I10 J0\nG1 Z11\nG1 X150.013 Y97.007 E1\n";
    let plain = printed(body);
    let ran = printed(&format!("{body}G1 C33.3\nG1 X100 Y100\n{body}M400\n"));
    let twice = printed(&format!("{body}G1 X100 Y100\n{body}"));
    assert!(plain.events > 1000);
    let round = (33.3_f64 * 80.0).round() as i64;
    assert_eq!(belt(&ran), belt(&twice).map(|count| count + round));
    assert_eq!(ran.counts[4..], twice.counts[4..]);
}

/// A move along an axis ends up to half a step from the requested place. Circulation starts where the motors are.
#[test]
fn nothing_adds_up_behind_moves_along_an_axis() {
    let round = "G1 X100 Y100.004 F6000\nG1 X120.0025\nG1 C0\nG1 X100 Y100\nG1 Y119.9973\nG1 C1\n";
    let gcode = round.repeat(40) + "G1 X100 Y100 C0\n";
    assert_eq!(belt(&printed(&gcode)), [0; 4]);
}

#[test]
fn fractions_of_relative_ways_are_kept_and_far_ways_end_at_the_edge() {
    let small = "G1 C0.007 F3000\n".repeat(100);
    assert_eq!(belt(&printed(&format!("G91\n{small}"))), [56; 4]);
    let told = said(&Settings::prototype(), "G1 C99999 F60000\nM114\n");
    assert!(told.iter().any(|line| line.starts_with("echo:target out of reach")), "{told:?}");
    assert!(told.iter().any(|line| line.contains(" C:10000.00 ")), "{told:?}");
    // Other steps, the same way.
    let told = said(&Settings::prototype(), "G1 C10 F6000\nM92 X160 Y160\nM114 R\nG1 C20\nM400\nM114 R\n");
    let positions: Vec<_> = told.iter().filter(|line| line.starts_with("X:")).collect();
    assert!(positions[0].contains(" C:10.00 ") && positions[1].contains(" C:20.00 "), "{positions:?}");
}

#[test]
fn hosts_see_where_the_belt_is() {
    let said = said(&Settings::prototype(), "G1 C5 F3000\nG1 C2.5 X110\nM114\nM114 R\nG91\nG1 C1\nM400\nM114\nM503\n");
    let positions: Vec<_> = said.iter().filter(|line| line.starts_with("X:")).collect();
    let [one, real, two] = positions[..] else { panic!("{said:?}") };
    assert!(one.starts_with("X:110.00 Y:100.00 Z:10.00 E:0.00 C:2.50 Count"), "{one}");
    assert!(real.starts_with("X:110.00 Y:100.00 Z:10.00 E:0.00 C:2.50 Count"), "{real}");
    assert!(two.starts_with("X:110.00 Y:100.00 Z:10.00 E:0.00 C:3.50 Count"), "{two}");
    assert!(said.iter().any(|line| line.contains("closed belt: C up to 100 mm/s, 1500 mm/s2")), "{said:?}");
}

#[test]
fn other_machines_have_no_axis_c_and_other_axes_do_not_go_with_it() {
    for (name, s) in machines() {
        let said = said(&s, "G1 X110 C5 F3000\nM400\nM114\n");
        let is_refused = said.iter().any(|line| line == "echo:line ignored: there is no axis C");
        assert_eq!(is_refused, !s.belt.is_closed, "{name}: {said:?}");
        let x = if is_refused { "X:100.00" } else { "X:110.00" };
        assert!(said.iter().any(|line| line.starts_with(x)), "{name}: {said:?}");
    }
    for line in ["G1 C5 Z11", "G1 C5 E1"] {
        let said = said(&Settings::prototype(), &format!("{line}\nM400\nM114\n"));
        assert!(said.iter().any(|line| line == "echo:line ignored: C goes with X, Y and F alone"), "{said:?}");
        assert!(said.iter().any(|line| line.starts_with("X:100.00 Y:100.00 Z:10.00 E:0.00 C:0.00")), "{said:?}");
    }
}

#[test]
fn a_belt_runs_on_after_homing_if_it_is_to() {
    let mut s = Settings::prototype();
    let homed = print(&s, None, "G28\n");
    s.belt.homing_advance = Mm::from_num(2);
    let ran = print(&s, None, "G28\n");
    assert_eq!((homed.findings, &ran.findings), (Findings::default(), &Findings::default()));
    let way: [i64; MOTORS] = std::array::from_fn(|motor| ran.counts[motor] - homed.counts[motor]);
    assert_eq!(way, per_motor(&[160; 4], 0));
}

/// Sends lines one by one, and M410 in the middle of the first.
struct Stopper<'t> {
    lines: VecDeque<&'static str>,
    events: &'t Cell<u64>,
    stop_at: u64,
    awaiting: u32,
    heard: Vec<String>,
}

impl Host for Stopper<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting == 0
            && let Some(line) = self.lines.pop_front()
        {
            out.extend(line.bytes().chain([b'\n']));
            self.awaiting += 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.events.get() >= self.stop_at {
            self.stop_at = u64::MAX;
            self.awaiting += 1;
            out.extend(b"M410\n");
        }
    }

    fn hear(&mut self, line: &str) {
        self.awaiting -= u32::from(line.starts_with("ok"));
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && self.awaiting == 0
    }
}

/// Wherever it is stopped, the motors rest where their counts agree, z is where it was, and the way back is known to
/// the step.
#[test]
fn a_quick_stop_loses_neither_belt_nor_tool_nor_z() {
    let s = Settings::prototype();
    let gcode = "G1 X140.013 Y120.007 C50 F6000\nM114 R\nG1 X100 Y100 C0\nG1 Z11\nG1 Z10\nM400\n";
    for stop_at in (1..9_000).step_by(487) {
        let events = Cell::new(0);
        let lines = gcode.lines().collect();
        let mut host = Stopper { lines, events: &events, stop_at, awaiting: 0, heard: Vec::new() };
        let checker = Checker::new(&s, &Limits::new(&s, None, gcode));
        let mut steps = Counted(Steps { checker, counts: [0; MOTORS], events: 0 }, &events);
        let outcome = run(&s, Some([100, 100, 10].map(Mm::from_num)), &mut host, &mut steps).unwrap();
        let Counted(Steps { checker, counts, .. }, _) = steps;
        assert_eq!(checker.finish(Some(outcome.counts)), Findings::default(), "{stop_at}");
        assert_eq!(counts, [0; MOTORS], "{stop_at}: {:?}", host.heard);
        let position = host.heard.iter().find(|line| line.starts_with("X:")).unwrap();
        assert!(position.contains(" Z:10.00 "), "{stop_at}: {position}");
    }
}
