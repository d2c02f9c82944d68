//! Absurd lines (F50 to F55): wherever they would go, the tool stays inside the machine. No move is endless, and the
//! next right line reaches its place to the step.

use corehbot::motors::{MOTORS, Motor, MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::check::Checker;
use corehbot_sim::host::FileHost;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Outcome, Sink, run};
use std::fmt::Write as _;

/// Where the tool stands at the begin, in mm.
const START: [i32; 3] = [100, 100, 10];

/// Steps per mm of the prototype's x and y, z, and e.
const STEPS: [f64; 3] = [80.0, 800.0, 400.0];

/// Follows the tool, and holds every step to the machine's limits.
struct Steps {
    checker: Checker,
    counts: [i64; MOTORS],
    /// The least and the greatest x, y and z, in mm.
    reach: [[f64; 2]; 3],
    /// All steps of the extruder, forwards and back.
    extruder: u64,
}

/// x, y, z in mm and e in mm from the begin.
fn tool(counts: [i64; MOTORS]) -> [f64; 4] {
    // 11 turns for x + y, 8 for x - y.
    let [_, _, m8, m11, z1, _, e0, ..] = counts.map(|count| count as f64);
    let [x, y, z] = START.map(f64::from);
    let xy = STEPS[0] * 2.0;
    [x + (m11 + m8) / xy, y + (m11 - m8) / xy, z + z1 / STEPS[1], e0 / STEPS[2]]
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.checker.event(tick, steps, forward);
        for (count, motor) in self.counts.iter_mut().zip(Motor::ALL) {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
        self.extruder += u64::from(steps.has(prototype::E0));
        for (reach, at) in self.reach.iter_mut().zip(tool(self.counts)) {
            *reach = [reach[0].min(at), reach[1].max(at)];
        }
    }

    fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }
}

struct Printed {
    at: [f64; 4],
    /// Moves that the lines made.
    moves: u32,
    extruder: u64,
    outcome: Outcome,
    resends: u32,
}

/// Prints lines from [`START`], and then goes back there: every step is legal, every step counts, and every place is
/// inside.
fn print(lines: &str) -> Printed {
    let settings = Settings::prototype();
    let after = |lines: &str| {
        let checker = Checker::new(&settings, &Limits::new(&settings, None, ""));
        let reach = START.map(|mm| [f64::from(mm); 2]);
        let mut steps = Steps { checker, counts: [0; MOTORS], reach, extruder: 0 };
        let mut host = FileHost::new(&format!("M83\n{lines}\n"));
        let outcome = run(&settings, Some(START.map(Mm::from_num)), &mut host, &mut steps).unwrap();
        assert!(host.failure().is_none() && !outcome.halted, "{lines}: {:?}", host.failure());
        for (reach, most) in steps.reach.iter().zip([390.0, 417.6, 335.0]) {
            assert!(reach[0] > -0.02 && reach[1] < most + 0.02, "{lines}: from {} to {}", reach[0], reach[1]);
        }
        let findings = steps.checker.finish(Some(outcome.counts));
        assert_eq!(findings.total, 0, "{lines}: {:?}", findings.first);
        let resends = host.resends();
        Printed { at: tool(steps.counts), moves: outcome.moves, extruder: steps.extruder, outcome, resends }
    };
    let back = after(&format!("{lines}\nG90\nM83\nG21\nM220 S100\nG1 X100 Y100 Z10 F6000"));
    let [x, y, z, _] = back.at;
    assert_eq!([x, y, z], START.map(f64::from), "{lines}: the way back");
    after(lines)
}

/// Prints a line that must not move anything.
fn moves_nothing(line: &str) {
    let printed = print(line);
    assert_eq!((printed.moves, printed.outcome.counts, printed.resends), (0, [0; MOTORS], 0), "{line}");
}

#[test]
fn f50_what_is_no_number_moves_nothing() {
    for number in
        ["nan", "NaN", "inf", "-inf", "", "-", "+", ".", "..", "+-1", "--1", "1.2.3", "1,5", "=5", "1/2", "\"1\""]
    {
        for letter in ["X", "Y", "Z", "E"] {
            moves_nothing(&format!("G1 {letter}{number} F6000"));
            moves_nothing(&format!("G1 X150 Y150 {letter}{number}").replace(&format!("{letter}150 "), ""));
        }
        moves_nothing(&format!("G2 X150 Y100 I{number} J0"));
    }
}

#[test]
fn f50_numbers_beyond_any_measure_are_the_greatest() {
    let forty = "9".repeat(40);
    let negative = format!("-{forty}");
    for (x, end) in [(forty.as_str(), 390.0), (&negative, 0.0), ("-0", 0.0), ("0.00000000001", 0.0)] {
        let printed = print(&format!("G1 X{x} F12000"));
        assert_eq!(printed.at, [end, 100.0, 10.0, 0.0], "X{x}");
    }
    // E is a letter: X1 and E39, as by Marlin.
    assert_eq!(print("G1 X1e39 F12000").at, [1.0, 100.0, 10.0, 39.0]);
    // As fast as the machine may, and no faster.
    let ticks = ["F17987547480000", "F999999999", "F18000"].map(|feed| print(&format!("G1 X300 {feed}")).outcome.ticks);
    assert!(ticks.iter().all(|each| *each == ticks[2]), "{ticks:?}");
}

#[test]
fn f51_coordinates_beyond_the_machine_end_at_its_edge() {
    for (line, at) in [
        ("G1 X1000000000 Y1000000000 F12000", [390.0, 417.6, 10.0, 0.0]),
        ("G1 X-1000000000 Y-1000000000 F12000", [0.0, 0.0, 10.0, 0.0]),
        ("G91\nG1 X1000000000 F12000", [390.0, 100.0, 10.0, 0.0]),
        ("G91\nG1 Z-1000000000", [100.0, 100.0, 0.0, 0.0]),
        ("G20\nG1 X1000000000 F12000", [390.0, 100.0, 10.0, 0.0]),
        ("G1 X110 F0", [110.0, 100.0, 10.0, 0.0]),
        ("G1 X110 F-6000", [110.0, 100.0, 10.0, 0.0]),
    ] {
        let printed = print(line);
        let off = printed.at.iter().zip(at).map(|(is, at)| (is - at).abs()).fold(0.0, f64::max);
        assert!(off <= 0.5 / STEPS[0], "{line}: at {:?}", printed.at);
    }
}

#[test]
fn f51_filament_by_the_kilometre_is_not_extruded() {
    for line in ["G1 E1000000 F3000", "G1 E-1000000", "G1 X110 E1000000 F6000"] {
        assert_eq!(print(line).extruder, 0, "{line}");
    }
}

/// Pieces of 1 to 20 um, out and back and in zig-zag, at the greatest feed. `cargo xtask soak` prints millions of them.
#[test]
fn f52_segments_of_micrometres_lose_no_step() {
    let mut state = 1_u64;
    let mut random = |most: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let mut lines = "G91\nG1 F18000\n".to_owned();
    let (mut x, mut e) = (0_i64, 0_i64);
    let segments = std::env::var("COREHBOT_SOAK_SEGMENTS").map_or(20_000, |count| count.parse().unwrap());
    for i in 0..segments {
        let um = 1 + random(20) as i64;
        // In one direction for a while, then to and fro, then in the other direction.
        let side = if i / 4000 % 2 == 0 { um } else { -um };
        let way = if i % 4000 < 2000 || i % 2 == 0 { side } else { -side };
        x += way;
        e += 1;
        writeln!(lines, "G1 X{:.3} E0.001", way as f64 / 1000.0).unwrap();
    }
    let printed = print(&lines);
    assert_eq!(printed.outcome.underruns, 0);
    let off = (printed.at[0] - 100.0 - x as f64 / 1000.0).abs();
    assert!(off <= 0.5 / STEPS[0], "{off} mm off");
    assert!((printed.at[3] - e as f64 / 1000.0).abs() <= 0.5 / STEPS[2], "{}", printed.at[3]);
    println!("{segments} segments");
}

#[test]
fn f53_moves_without_a_way_are_none() {
    let zero = "G1 X100 Y100 Z10 F6000\nG1 E0\nG0 X100\nG1 F3000\nG91\nG1 X0 Y0 Z0\nG90\n".repeat(2000);
    moves_nothing(&zero);
    let filament = "G1 E0.01 F600\nG1 E0 F600\nG1 X100 Y100 E0.01\n".repeat(1000);
    let printed = print(&filament);
    assert_eq!((printed.at, printed.extruder), ([100.0, 100.0, 10.0, 20.0], 8000));
    let lift = "G91\n".to_owned() + &"G1 Z0.01 F600\nG1 Z0\n".repeat(500);
    assert_eq!(print(&lift).at, [100.0, 100.0, 15.0, 0.0]);
}

#[test]
fn f54_arcs_that_are_none_move_nothing() {
    for line in [
        "G2 X110 Y110",
        "G2 I0 J0",
        "G2 X110 I0 J0",
        "G3 X110 Y100 R0",
        "G2 X110 Y100 R1",
        "G2 X100 Y100 R10",
        "G2 R10",
        "G2 X110 R1 I5",
        "G2 X120 Y100 R1000000000 F6000",
        "G2 X120 Y100 I10 J-1000000 F6000",
        "G2 I0.000000001 F6000",
    ] {
        moves_nothing(line);
    }
}

#[test]
fn f54_arcs_of_any_size_are_bounded_and_end_where_they_should() {
    for (line, at, most) in [
        ("G2 I10 F6000", [100.0, 100.0, 10.0], 400),
        ("G3 I10 Z11 F6000", [100.0, 100.0, 11.0], 400),
        ("G2 X120 Y100 R10 F6000", [120.0, 100.0, 10.0], 400),
        ("G2 I0.001 F6000", [100.0, 100.0, 10.0], 400),
        ("G2 X100.001 Y100 I0.0005 F6000", [100.001, 100.0, 10.0], 400),
    ] {
        let printed = print(line);
        let off = (0..3).map(|i| (printed.at[i] - at[i]).abs()).fold(0.0, f64::max);
        assert!(off <= 0.5 / STEPS[0] && printed.moves <= most, "{line}: {:?}, {} moves", printed.at, printed.moves);
    }
    let tiny = "G91\n".to_owned() + &"G2 X0.02 I0.01 F3000\nG3 X-0.02 I-0.01\n".repeat(2500);
    assert_eq!(print(&tiny).at, [100.0, 100.0, 10.0, 0.0]);
}

#[test]
fn f55_malformed_parameters_and_indexes_move_nothing() {
    let (long, many) = ("A".repeat(90), "1".repeat(60));
    for line in [
        format!("M486 A{long}"),
        format!("M486 S{many}\nM486 S-1"),
        format!("M117 {long}"),
        "T99".to_owned(),
        format!("T{many}\nT0"),
        "M421 I999999999 J-999999999 Z1".to_owned(),
        "G10 L2 P99 X1e9".to_owned(),
        "M106 P250 S99999".to_owned(),
        "M569 T99 S9".to_owned(),
        "M906 X-1 I99".to_owned(),
        "M204 P- T..".to_owned(),
        format!("EXCLUDE_OBJECT_START NAME={long}\nEXCLUDE_OBJECT_END"),
        "SET_VELOCITY_LIMIT ACCEL=nan VELOCITY=inf".to_owned(),
        "M220 S-5\nM220 S0\nM220 S99999999999".to_owned(),
    ] {
        moves_nothing(&line);
    }
}

/// F87 by G-code: steps per mm, speeds and accelerations that no machine has. Whatever is taken, the machine keeps its
/// limits.
#[test]
fn f87_settings_that_no_machine_has_leave_it_within_its_limits() {
    for line in [
        "M92 X0",
        "M92 X-80",
        "M92 Xnan",
        "M201 X0",
        "M201 X-1",
        "M203 X0",
        "M203 X-1",
        "M203 X1e39",
        "M201 X1e39",
        "M204 S0",
        "M205 J-1",
    ] {
        let printed = print(&format!("{line}\nG1 X110 F6000"));
        assert_eq!(printed.at, [110.0, 100.0, 10.0, 0.0], "{line}");
    }
}
