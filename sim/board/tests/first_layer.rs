//! The first layer: Z is shifted while a print runs, exactly, within its limits, and without any other motor.

use crate::common::life::live_at;
use corehbot::motors::{MotorSet, prototype};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Desk, Host, Outcome, Sink, ZShift, ZShifts, run_at};
use std::cell::Cell;
use std::rc::Rc;

/// The edges on the step lines.
struct Steps {
    checker: Checker,
    /// Every event: its tick, steps and directions.
    all: Vec<(u64, u32, u32)>,
    tick: Rc<Cell<u64>>,
    /// Ticks and directions of all motors but those of z.
    others: Vec<(u64, u32, u32)>,
    z: i32,
    /// Ticks of the first and the last step of z.
    moved: Option<(u64, u64)>,
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.checker.event(tick, steps, forward);
        self.all.push((tick, steps.0.into(), u32::from(forward.0 & steps.0)));
        self.tick.set(tick);
        let of_z = MotorSet::of(prototype::Z1).with(MotorSet::of(prototype::Z2));
        let others = steps.without(of_z);
        if !others.is_empty() {
            self.others.push((tick, u32::from(others.0), u32::from(forward.0 & others.0)));
        }
        assert_eq!(steps.has(prototype::Z1), steps.has(prototype::Z2));
        if steps.has(prototype::Z1) {
            self.z += if forward.has(prototype::Z1) { 1 } else { -1 };
            let (first, _) = self.moved.unwrap_or((tick, tick));
            self.moved = Some((first, tick));
        }
    }

    fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }
}

/// Sends a line for each answer, and some lines when the motion has come so far, whatever was answered.
struct Printer {
    lines: Vec<String>,
    next: usize,
    /// Motion time in ms, and a line.
    besides: Vec<(f64, &'static str)>,
    tick: Rc<Cell<u64>>,
    sent: usize,
    oks: usize,
    heard: Vec<String>,
}

impl Printer {
    fn put(&mut self, line: &str, out: &mut Vec<u8>) {
        out.extend(line.bytes());
        out.push(b'\n');
        self.sent += 1;
    }
}

impl Host for Printer {
    fn send(&mut self, out: &mut Vec<u8>) {
        if let Some(line) = self.lines.get(self.next).filter(|_| self.oks == self.sent).cloned() {
            self.next += 1;
            self.put(&line, out);
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if let Some((ms, line)) = self.besides.first().copied()
            && self.tick.get() as f64 >= ms * 1e4
        {
            self.besides.remove(0);
            self.put(line, out);
        }
    }

    fn hear(&mut self, line: &str) {
        self.oks += usize::from(line.starts_with("ok"));
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.next == self.lines.len() && self.oks == self.sent && self.besides.is_empty()
    }
}

struct Printed {
    all: Vec<(u64, u32, u32)>,
    shifts: Vec<ZShift>,
    others: Vec<(u64, u32, u32)>,
    z: i32,
    moved: Option<(u64, u64)>,
    heard: Vec<String>,
    findings: Findings,
    outcome: Outcome,
}

impl Printed {
    fn said(&self, begin: &str) -> Vec<&str> {
        self.heard.iter().filter(|line| line.starts_with(begin)).map(String::as_str).collect()
    }
}

/// Prints on a machine that stands at X100 Y100 Z10 as if homed, with shifts to be made again.
fn print_with(again: &[ZShift], lines: &[String], besides: &[(f64, &'static str)]) -> Printed {
    let settings = &Settings::prototype();
    let tick = Rc::new(Cell::new(0));
    let mut limits = Limits::new(settings, None, "");
    // No switch stops anything in the middle of a print.
    limits.of.iter_mut().for_each(|limit| limit.hard_stop = 0.0);
    let checker = Checker::new(settings, &limits);
    let mut steps = Steps { checker, all: Vec::new(), tick: Rc::clone(&tick), others: Vec::new(), z: 0, moved: None };
    let (lines, besides) = (lines.to_vec(), besides.to_vec());
    let mut host = Printer { lines, next: 0, besides, tick, sent: 0, oks: 0, heard: Vec::new() };
    let mut desk = Desk::new(1);
    desk.z_shifts = ZShifts::again(again.iter().copied());
    let start = Some([100, 100, 10].map(Mm::from_num));
    let outcome = run_at(&mut desk, settings, start, NoStorage, &Drivers::new(), &mut [&mut host], &mut steps).unwrap();
    let Steps { checker, all, others, z, moved, .. } = steps;
    let findings = checker.finish(Some(outcome.counts));
    Printed { all, shifts: desk.z_shifts.made, others, z, moved, heard: host.heard, findings, outcome }
}

fn print(lines: &[String], besides: &[(f64, &'static str)]) -> Printed {
    print_with(&[], lines, besides)
}

/// Zigzags at 300 mm/s.
fn zigzags(count: u32) -> Vec<String> {
    let mut lines: Vec<String> =
        (1..=count).map(|i| format!("G1 X{} Y{:.1} F18000", 20 + 300 * (i % 2), 100.0 + f64::from(i) * 0.4)).collect();
    lines.push("M400".into());
    lines.push("M114".into());
    lines.push("M114 R".into());
    lines
}

/// A polygon of short edges.
fn circles(count: u32) -> Vec<String> {
    let edge = |i: u32| {
        let (sin, cos) = (f64::from(i) * 0.02).sin_cos();
        format!("G1 X{:.3} Y{:.3} F6000", 100.0 + 30.0 * sin, 130.0 - 30.0 * cos)
    };
    (0..=count).map(edge).chain(["M400", "M114", "M114 R"].map(String::from)).collect()
}

#[test]
fn twenty_shifts_in_a_fast_print_are_a_millimetre_and_no_other_step_changes() {
    // A line before it may wait for room: as long as a move lasts.
    for (lines, way, most_first) in [(zigzags(40), "zigzags", 1400.0), (circles(2000), "circles", 360.0)] {
        let before = print(&lines, &[]);
        let shifts: Vec<(f64, &str)> = (0..20).map(|i| (300.0 + 37.0 * f64::from(i), "M290 Z0.05")).collect();
        let after = print(&lines, &shifts);
        assert_eq!((before.z, after.z), (0, 800), "{way}");
        assert!(before.others == after.others, "{way}: other motors step as before");
        assert_eq!(after.findings.total, 0, "{way}: {:?}", after.findings.first);
        let (first, last) = after.moved.unwrap();
        println!("{way}: z moves from {:.1} to {:.1} ms", first as f64 / 1e4, last as f64 / 1e4);
        // It begins with the steps that are not made yet, and ends soon after the last line.
        assert!((300e4..most_first * 1e4).contains(&(first as f64)), "{way}: {first}");
        assert!(last as f64 <= (300.0 + 37.0 * 20.0 + 1500.0) * 1e4, "{way}: {last}");
        // The program's z is what it was, and the steps say where z is.
        for (old, new) in before.said("X:").iter().zip(after.said("X:")) {
            let (old, new) = (old.split_once(" Z:8000").unwrap().0, new.split_once(" Z:8800").unwrap().0);
            assert_eq!(old, new, "{way}");
        }
    }
}

/// Shaped axes are late, and z with them. A shift waits for no more than without shapers.
#[test]
fn a_shift_acts_in_motion_with_shapers_too() {
    let lines = [vec!["M593 X F30".to_owned(), "M593 Y F25 T4".to_owned()], circles(2000)].concat();
    let plain = print(&lines, &[]);
    let shifted = print(&lines, &[(300.0, "M290 Z0.05")]);
    assert_eq!((plain.z, shifted.z), (0, 40));
    assert!(plain.others == shifted.others);
    let (first, _) = shifted.moved.unwrap();
    assert!((300e4..400e4).contains(&(first as f64)), "{first}");
}

/// A lift at the full speed of z every 0.2 s: a shift waits for its end, and none of z's limits is passed.
#[test]
fn lifts_and_shifts_together_keep_to_the_limits_of_z() {
    let mut lines = Vec::new();
    for i in 0..40 {
        let x = 20 + 40 * (i % 2);
        lines.extend([format!("G1 X{x} F12000"), "G1 Z12 F1200".into(), format!("G1 Y{} F18000", 100 + i)]);
        lines.extend(["G1 Z10 F1200".to_owned(), format!("G1 X{} F9000", x + 3)]);
    }
    lines.push("M400".into());
    let plain = print(&lines, &[]);
    let shifts: Vec<(f64, &str)> = (0..15).map(|i| (200.0 + 61.0 * f64::from(i), "M290 Z-0.04")).collect();
    let shifted = print(&lines, &shifts);
    assert_eq!((plain.z, shifted.z), (0, -480));
    assert_eq!((plain.findings.total, shifted.findings.total), (0, 0), "{:?}", shifted.findings.first);
    assert!(plain.others == shifted.others);
}

/// A vase: z rises with every edge.
#[test]
fn a_spiral_goes_on_rising_while_it_is_shifted() {
    let mut lines = circles(1500);
    let mut z = 10.0;
    for line in lines.iter_mut().filter(|line| line.starts_with("G1")) {
        z += 0.0008;
        *line += &format!(" Z{z:.4}");
    }
    let plain = print(&lines, &[]);
    let shifted = print(&lines, &[(300.0, "M290 Z0.2"), (700.0, "M290 S-0.1"), (701.0, "M290 Z0.0125")]);
    assert_eq!(shifted.z - plain.z, 90);
    assert!(plain.others == shifted.others);
    assert_eq!(shifted.findings.total, 0, "{:?}", shifted.findings.first);
}

#[test]
fn at_rest_a_shift_is_made_at_once() {
    let lines = ["M290 Z2", "M400", "M114 R", "M290 Z-1.99", "G1 X120 F6000", "M400", "M114 R", "M290"];
    let printed = print(&lines.map(String::from), &[]);
    assert_eq!(printed.z, 8);
    assert_eq!(printed.findings.total, 0, "{:?}", printed.findings.first);
    let places = printed.said("X:");
    assert!(places[0].contains("Z:10.00") && places[0].ends_with("Z:9600"), "{places:?}");
    assert!(places[1].contains("X:120.00 Y:100.00 Z:10.00") && places[1].ends_with("Z:8008"), "{places:?}");
    let said = printed.said("echo:");
    assert_eq!(said[1..], ["echo:Babystep Z0.01", "echo:Z offset 0.01, not saved: M500 keeps it"]);
    assert!(!printed.outcome.halted);
}

#[test]
fn a_quick_stop_in_a_shift_keeps_position_and_offset_exact() {
    for ms in [312.0, 316.0, 320.0, 325.0, 330.0, 345.0, 360.0, 380.0] {
        let mut lines = circles(300);
        lines.truncate(300);
        lines.extend(["M400", "G1 X100 Y100 Z10 F6000", "M400", "M114 R", "M290"].map(String::from));
        let printed = print(&lines, &[(300.0, "M290 Z0.1"), (ms, "M410")]);
        assert_eq!(printed.z, 80, "{ms}: {:?}", printed.heard);
        assert_eq!(printed.findings.total, 0, "{ms}: {:?}", printed.findings.first);
        let place = printed.said("X:");
        assert!(place[0].starts_with("X:100.00 Y:100.00 Z:10.00"), "{place:?}");
        assert!(printed.said("echo:Babystep Z0.10").len() == 1);
    }
}

/// The ticks of shifts are inputs. With them the same program makes the same steps, without the host that shifted z.
#[test]
fn recorded_shifts_make_the_same_steps_again() {
    let rising = |mut lines: Vec<String>| {
        for (i, line) in lines.iter_mut().filter(|line| line.starts_with("G1")).enumerate() {
            *line += &format!(" Z{:.4}", 10.0 + 0.0008 * i as f64);
        }
        lines
    };
    let mut shaped = vec!["M593 X F40".to_owned(), "M593 Y F35 T4".to_owned()];
    shaped.extend(circles(600));
    let mut rests = circles(200);
    rests.truncate(200);
    let rests = [rests, vec!["M400".to_owned(), "G4 P300".to_owned()], zigzags(8)].concat();
    // M400 lets no later line by, so those shifts become one, at rest.
    let ways =
        [("zigzags", zigzags(20), 2), ("spiral", rising(circles(900)), 5), ("shaped", shaped, 3), ("rests", rests, 1)];
    for (way, lines, least) in ways {
        let shifts: Vec<(f64, &str)> = (0..9)
            .map(|i| (301.3 + 83.7 * f64::from(i), ["M290 Z0.05", "M290 Z-0.0125", "M290 Z0.00125"][i as usize % 3]))
            .collect();
        let first = print_with(&[], &lines, &shifts);
        assert!(first.shifts.len() >= least, "{way}: {:?}", first.shifts);
        let again = print_with(&first.shifts, &lines, &[]);
        assert_eq!(again.shifts, first.shifts, "{way}");
        let other = first.all.iter().zip(&again.all).position(|(a, b)| a != b);
        assert_eq!((other, again.all.len()), (None, first.all.len()), "{way}: the first event that differs");
    }
}

/// Reproducer: the next move passed before the shift, so the tool went to 0.25 mm and then to 5 mm.
#[test]
fn a_move_down_waits_for_a_shift_that_raises_the_tool() {
    for (lines, at) in [
        (&["SET_GCODE_OFFSET Z=5 MOVE=1", "G1 Z0 F1200"][..], 5.0),
        (&["SET_GCODE_OFFSET Z=3 MOVE=1", "G1 Z0.2 F600"], 3.2),
        (&["M290 Z2", "G1 Z0 F1200"], 2.0),
        (&["G1 Z5", "M290 Z1", "G1 X100 Z0.2 F9000"], 1.2),
        (&["G1 Z5", "M290 Z1", "G2 X110 Z0.2 I5 F9000"], 1.2),
    ] {
        live_at(&Settings::prototype(), Some([100, 100, 0].map(Mm::from_num)), 1, |life| {
            life.say("G28");
            life.say("G1 Z10 F1200");
            life.say("M400");
            lines.iter().for_each(|line| life.put(0, line));
            life.put(0, "M400");
            let mut lowest = f64::INFINITY;
            let oks = life.oks();
            while life.oks() < oks + lines.len() + 1 {
                life.rest(1);
                let [.., z] = life.nozzle();
                lowest = lowest.min(z);
            }
            let [.., z] = life.nozzle();
            assert!((z - at).abs() < 0.002 && lowest > at - 0.002, "{lines:?}: {lowest}, then {z}");
        });
    }
}
