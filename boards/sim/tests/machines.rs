//! Every machine of `examples/machines` prints: it homes, and every step is as its rows and limits say.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::kinematics::Mechanism;
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::{Cartesian, Settings};
use corehbot::units::Mm;
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::host::FileHost;
use corehbot_sim::limits::Limits;
use corehbot_sim::machine_file;
use corehbot_sim::world::{Host, Outcome, Sink, run};
use std::cell::Cell;
use std::collections::VecDeque;
use std::path::Path;

/// Every machine file, by name.
fn machines() -> Vec<(String, Settings)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let named = files.into_iter().map(|file| {
        let machine = machine_file::parse(&std::fs::read_to_string(&file).unwrap());
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let machine = machine.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(machine.name.is_some(), "{name}");
        (name, machine.settings)
    });
    named.collect()
}

/// Checks every step, and counts.
struct Steps {
    checker: Checker,
    counts: [i64; 7],
    events: u64,
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.checker.event(tick, steps, forward);
        for (motor, count) in Motor::ALL.into_iter().zip(&mut self.counts) {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
        self.events += u64::from(!steps.is_empty());
    }
}

struct Print {
    outcome: Outcome,
    counts: [i64; 7],
    events: u64,
    findings: Findings,
}

fn print(s: &Settings, start: Option<[Mm; 3]>, gcode: &str) -> Print {
    let checker = Checker::new(s, &Limits::new(s, None, gcode));
    let mut steps = Steps { checker, counts: [0; 7], events: 0 };
    let mut host = FileHost::new(gcode);
    let outcome = run(s, start, &mut host, &mut steps).unwrap();
    assert!(host.is_done() && host.failure().is_none() && !outcome.halted, "{:?}", host.failure());
    let Steps { checker, counts, events } = steps;
    Print { findings: checker.finish(Some(outcome.counts)), outcome, counts, events }
}

/// A position in whole steps.
fn steps_of(s: &Settings, position: [f64; 4]) -> [i64; 4] {
    let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
    std::array::from_fn(|i| (position[i] * pitch[i]).round() as i64)
}

/// A real file: homing, arcs, retractions, Z hops, and a long way home. It ends where it says, counted from where homing
/// found zero, which is told by what another print after the same homing counts.
#[test]
fn every_machine_prints_a_file_and_ends_where_it_says() {
    let gcode = include_str!("../../../examples/first-print.gcode");
    let body = gcode.split_once("G28 ; home all axes").unwrap().1;
    // X0 Y200 Z7 at the end, from a corner of the bed on a homed machine; the filament is the file's business.
    let start = [10.0, 20.0, 5.0];
    for (name, s) in machines() {
        let homed = print(&s, None, gcode);
        assert_eq!(homed.findings, Findings::default(), "{name}");
        assert_eq!(homed.outcome.underruns, 0, "{name}");
        let print = print(&s, Some(start.map(Mm::from_num)), body);
        assert_eq!(print.findings, Findings::default(), "{name}");
        assert!(print.events > 100_000, "{name}: {} events", print.events);
        let [sx, sy, sz] = start;
        let from = s.mechanism.inverse(steps_of(&s, [sx, sy, sz, 0.0]));
        let to = s.mechanism.inverse(steps_of(&s, [0.0, 200.0, 7.0, 0.0]));
        for (motor, row) in s.mechanism.motors().filter(|(_, row)| row[3] == 0) {
            let way = to[motor as usize] - from[motor as usize];
            assert_eq!(print.counts[motor as usize], way, "{name}: {} {row:?}", motor.name());
        }
    }
}

/// Homing meets each switch where it is: the way to a point is that from the first switch-on position, whatever the motors.
#[test]
fn every_axis_of_every_machine_finds_its_switch() {
    let far = [31.7, 23.3, 12.4];
    for (name, s) in machines() {
        for (gcode, home) in [
            ("G28\nG28 Y\nG28 Z X\n", [true; 3]),
            ("G28 X\n", [true, false, false]),
            ("G28 Z\nG28 Y", [false, true, true]),
        ] {
            let print = print(&s, None, gcode);
            assert_eq!(print.findings, Findings::default(), "{name}: {gcode}");
            let back = s.mechanism.forward_kinematics().unwrap();
            let way = back.fractions(&print.counts).map(|(sum, over)| sum as f64 / over as f64);
            let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
            for axis in 0..3 {
                // A switch is pressed at or below 0; the step that the machine takes with it is one.
                let expected = if home[axis] { -(far[axis] * pitch[axis]).floor() } else { 0.0 };
                assert!((way[axis] - expected).abs() <= 1.0, "{name}: {gcode}: axis {axis} went {way:?}");
            }
        }
    }
}

/// Homing from between two steps finds the same zero however often, and the motors never come to rest against each other.
#[test]
fn homing_again_and_again_adds_up_to_nothing() {
    for (name, s) in machines() {
        let mut gcode = "G28\n".to_owned();
        for i in 0..12 {
            let (x, y, z) = (20.013 + 3.0 * f64::from(i), 31.007 + f64::from(i), 3.0 + 0.317 * f64::from(i));
            gcode += &format!(
                "G1 X{x} Y{y} Z{z} F3000\nG91\nG1 X.013 Y.007 Z.004\nG90\nM400\nG28 {}\n",
                ["X", "Y", "Z"][i as usize % 3]
            );
        }
        gcode += "G28\nG1 X50 Y60 Z5 F3000\n";
        let print = print(&s, Some([0, 0, 0].map(Mm::from_num)), &gcode);
        assert_eq!(print.findings, Findings::default(), "{name}");
        let to = s.mechanism.inverse(steps_of(&s, [50.0, 60.0, 5.0, 0.0]));
        let end = print.counts;
        let way = s.mechanism.forward_kinematics().unwrap().fractions(&end).map(|(sum, over)| sum as f64 / over as f64);
        let wanted =
            s.mechanism.forward_kinematics().unwrap().fractions(&to).map(|(sum, over)| sum as f64 / over as f64);
        for axis in 0..3 {
            assert!((way[axis] - wanted[axis]).abs() <= 2.0, "{name}: axis {axis} {way:?} {wanted:?}");
        }
    }
}

/// Keeps the motors of every event.
#[derive(Default)]
struct Motors(Vec<MotorSet>);

impl Sink for Motors {
    fn event(&mut self, _tick: u64, steps: MotorSet, _forward: MotorSet) {
        self.0.push(steps);
    }
}

/// Homing one axis puts all that share motors with it on whole steps; from there a move of an axis takes all its motors
/// along at once, without zig-zag.
#[test]
fn after_homing_an_axis_moves_alone() {
    for (name, mut s) in machines() {
        for (axis, back_off) in [(0, 5.0), (1, 5.0), (2, 5.0), (0, 0.4), (1, 0.4), (2, 0.4)] {
            // Ways of less than a millimetre end where they are sent, on no whole step.
            let Cartesian { x, y, z } = &mut s.homing;
            [x, y, z].into_iter().for_each(|homing| homing.back_off = Mm::from_num(back_off));
            if !(0..3).any(|other| other != axis && s.mechanism.share(axis, other)) {
                continue;
            }
            let letter = ["X", "Y", "Z"][axis];
            let gcode = format!("G1 X10.006 Y20.012 Z5.0042 F600\nG28 {letter}\nG1 {letter}5 F600\n");
            let mut motors = Motors::default();
            let mut host = FileHost::new(&gcode);
            run(&s, Some([10, 20, 5].map(Mm::from_num)), &mut host, &mut motors).unwrap();
            let last = &motors.0[motors.0.len() - 390..];
            assert!(last.iter().all(|steps| *steps == s.mechanism.motors_of(axis)), "{name}: {letter} {last:?}");
        }
    }
}

/// M92 gives a place between new steps its name; the motors must not come to pull against each other, each time by a step
/// more.
#[test]
fn other_resolutions_strain_nothing() {
    for (name, s) in machines() {
        let mut gcode = String::new();
        for i in 1..40 {
            let per_mm = 80.0 - f64::from(i) * 0.137;
            gcode +=
                &format!("M92 X{per_mm} Y{per_mm} Z{per_mm}\nG1 X{} Y{} Z{} F3000\n", 10 + i, 20 + 2 * i, 5 + i % 7);
        }
        assert_eq!(print(&s, Some([10, 20, 5].map(Mm::from_num)), &gcode).findings, Findings::default(), "{name}");
    }
}

/// Stops slanted moves by M410 wherever they are, and asks for the position each time.
struct Stopper<'t> {
    lines: VecDeque<String>,
    /// Events so far, and at how many the next stop comes.
    events: &'t Cell<u64>,
    stop: u64,
    stops: u64,
    is_under_way: bool,
    awaiting: u32,
    heard: Vec<String>,
}

impl Host for Stopper<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting > 0 {
            return;
        }
        if let Some(line) = self.lines.pop_front() {
            if line.starts_with("G1 X1") || line.starts_with("G1 X3") {
                self.stops += 1;
                (self.stop, self.is_under_way) = (self.events.get() + 700 + 97 * self.stops, true);
            }
            out.extend(line.bytes());
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.is_under_way && self.events.get() >= self.stop {
            self.is_under_way = false;
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

/// A sink that tells how many events there were.
struct Told<'t>(Steps, &'t Cell<u64>);

impl Sink for Told<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.0.event(tick, steps, forward);
        self.1.set(self.0.events);
    }
}

/// After a quick stop the motors of a slanted move stand between positions. What is told is where they really are, and
/// nothing adds up over many stops.
#[test]
fn quick_stops_leave_the_position_true() {
    for (name, s) in machines() {
        let mut limits = Limits::new(&s, None, "");
        limits.of.iter_mut().for_each(|limit| (limit.hard_stop, limit.hard_stop_up) = (0.0, 0.0));
        let events = Cell::new(0);
        let mut told = Told(Steps { checker: Checker::new(&s, &limits), counts: [0; 7], events: 0 }, &events);
        let mut lines = VecDeque::new();
        for i in 0..20 {
            let slanted = if i % 2 == 0 { "G1 X150 Y170.37 Z9.123 F6000" } else { "G1 X31 Y12.37 Z2.123 F6000" };
            lines.extend([slanted, "M400", "M114 R"].map(str::to_owned));
        }
        // An axis alone counts from wherever the last stop was.
        lines.extend(["G91", "G1 Y7 F3000", "M400", "M114 R"].map(str::to_owned));
        let heard = Vec::new();
        let mut host = Stopper { lines, events: &events, stop: 0, stops: 0, is_under_way: false, awaiting: 0, heard };
        let start = [60.0, 60.0, 5.0];
        let outcome = run(&s, Some(start.map(Mm::from_num)), &mut host, &mut told).unwrap();
        let Told(Steps { checker, counts, .. }, _) = told;
        assert_eq!(checker.finish(Some(outcome.counts)), Findings::default(), "{name}");
        let positions: Vec<&String> = host.heard.iter().filter(|line| line.starts_with("X:")).collect();
        assert_eq!(positions.len(), 21, "{name}");
        let stopped = positions.iter().filter(|line| !line.contains("X:150.0 ") && !line.contains("X:31.00 ")).count();
        assert!(stopped > 15, "{name}: {positions:?}");
        let back =
            s.mechanism.forward_kinematics().unwrap().fractions(&counts).map(|(sum, over)| sum as f64 / over as f64);
        let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
        let mut last = positions[20].split([' ', ':']);
        for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            assert_eq!(last.next(), Some(letter), "{name}");
            let said: f64 = last.next().unwrap().parse().unwrap();
            let real = start[axis] + back[axis] / pitch[axis];
            assert!((said - real).abs() < 0.00501, "{name}: {letter}{said} is told, the motors say {real}");
        }
    }
}

/// Motors that are not fitted get neither steps nor power, and are not asked for a proof.
#[test]
fn motors_that_are_not_fitted_are_left_alone() {
    for (name, s) in machines() {
        let drivers = Drivers::new();
        let mut host = FileHost::new("G28\nG1 X10 Y10 Z1 E1 F3000\nM400\nM122\n");
        let mut steps = Steps { checker: Checker::new(&s, &Limits::new(&s, None, "G28")), counts: [0; 7], events: 0 };
        let storage = corehbot::port::NoStorage;
        let outcome = corehbot_sim::world::run_on(&s, None, storage, &drivers, &mut [&mut host], &mut steps).unwrap();
        assert!(!outcome.halted && host.failure().is_none(), "{name}");
        let fitted = s.mechanism.fitted();
        assert_eq!(drivers.enabled(), fitted, "{name}");
        for motor in Motor::ALL {
            let (is_fitted, chip) = (fitted.has(motor), drivers.chip(motor));
            assert_eq!(chip.replies() > 0, is_fitted, "{name}: {}", motor.name());
            assert!(is_fitted || steps.counts[motor as usize] == 0, "{name}: {}", motor.name());
        }
    }
}

/// Lines that a host sends; hears the answers.
struct Asker {
    lines: Vec<String>,
    awaiting: bool,
    heard: Vec<String>,
}

impl Host for Asker {
    fn send(&mut self, out: &mut Vec<u8>) {
        if !self.awaiting && !self.lines.is_empty() {
            out.extend(self.lines.remove(0).bytes());
            out.push(b'\n');
            self.awaiting = true;
        }
    }

    fn hear(&mut self, line: &str) {
        self.awaiting &= !line.starts_with("ok");
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && !self.awaiting
    }
}

/// What a machine that stands at 10, 20, 5 answers to a line.
fn answers(s: &Settings, lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().map(|line| (*line).to_owned()).collect();
    let mut host = Asker { lines, awaiting: false, heard: Vec::new() };
    let mut steps = Steps { checker: Checker::new(s, &Limits::new(s, None, "")), counts: [0; 7], events: 0 };
    run(s, Some([10, 20, 5].map(Mm::from_num)), &mut host, &mut steps).unwrap();
    host.heard.retain(|line| line != "ok" && line != "start" && !line.starts_with("echo:busy"));
    host.heard
}

#[test]
fn positions_are_told_with_the_coordinates_of_the_machine() {
    let counted = |name: &str| {
        let (_, s) = machines().into_iter().find(|(file, _)| file == name).unwrap();
        answers(&s, &["G1 X11 F3000", "M400", "M114 R"]).last().unwrap().clone()
    };
    let at = "X:11.00 Y:20.00 Z:5.00 E:0.00 Count";
    assert_eq!(counted("prototype"), format!("{at} A:2480 B:-720 Z:4000"));
    assert_eq!(counted("corexy"), format!("{at} A:2480 B:-720 Z:2000"));
    assert_eq!(counted("corexyz"), format!("{at} A:2880 B:-320 C:-2080 D:1120"));
    assert_eq!(counted("corexyz-three"), format!("{at} A:2880 B:-320 C:-2080"));
    assert_eq!(counted("corexz"), format!("{at} A:1280 B:480 Y:1600"));
    assert_eq!(counted("cartesian"), format!("{at} Y:2000 X:880 Z:4000"));
}

/// M92 may not give axes that share motors different steps; where nothing is shared, it may.
#[test]
fn m92_respects_shared_motors() {
    let refused =
        |s: &Settings, line: &str| answers(s, &[line]).iter().any(|said| said.starts_with("echo:M92 ignored"));
    for (name, s) in machines() {
        let shares = s.mechanism.share(0, 1);
        assert_eq!(refused(&s, "M92 X90"), shares || s.mechanism.share(0, 2), "{name}");
        assert_eq!(refused(&s, "M92 Z90"), s.mechanism.share(0, 2) || s.mechanism.share(1, 2), "{name}");
        assert!(!refused(&s, "M92 X90 Y90 Z90"), "{name}");
    }
}

/// Settings that were stored on another machine are left where they are, and that is said.
#[test]
fn stored_settings_of_another_mechanism_are_not_used() {
    let mut eeprom = corehbot_sim::eeprom::Eeprom::blank();
    let mut ask = |s: &Settings, lines: &[&str]| {
        let lines = lines.iter().map(|line| (*line).to_owned()).collect();
        let mut host = Asker { lines, awaiting: false, heard: Vec::new() };
        let mut steps = Steps { checker: Checker::new(s, &Limits::new(s, None, "")), counts: [0; 7], events: 0 };
        corehbot_sim::world::run_with(s, None, &mut eeprom, &mut [&mut host], &mut steps).unwrap();
        host.heard
    };
    let (here, there) =
        (Settings::prototype(), Settings { mechanism: machines()[2].1.mechanism, ..Settings::prototype() });
    assert_ne!(here.mechanism, there.mechanism);
    assert!(ask(&here, &["M203 X123", "M500"]).iter().any(|said| said.starts_with("echo:Settings Stored")));
    let heard = ask(&there, &["M203"]);
    let why = "echo:storage slot A not used: for a machine with another mechanism";
    assert!(heard.iter().any(|said| said == why), "{heard:?}");
    assert!(heard.iter().any(|said| said.starts_with("echo:  M203 X300")), "{heard:?}");
    assert!(ask(&here, &["M203"]).iter().any(|said| said.starts_with("echo:  M203 X123")));
}

/// The examples are the machines that their names say.
#[test]
fn there_is_a_file_for_every_kind_of_machine() {
    let machines = machines();
    let of = |name: &str| machines.iter().find(|(file, _)| file == name).unwrap().1.mechanism;
    assert_eq!(of("prototype"), Mechanism::corehbot());
    // The firmware sees no difference between a CoreXY and an H-bot, and none in what part an axis moves.
    assert_eq!(of("corexy"), of("hbot"));
    assert_eq!(of("cartesian"), of("cartesian-xz"));
    let motors = |name: &str| of(name).fitted().0.count_ones();
    let counts = ["corexy", "corexyz", "corexyz-three", "corexz", "cartesian", "dual-y"].map(motors);
    assert_eq!(counts, [4, 5, 4, 4, 5, 5]);
}
