//! Runs at one speed each, of a machine with known errors of its motors: the motors' profile and the symmetry.
//!
//! The tool is a mass on a spring and a damper, and the motors' fields are off their places by known amounts once,
//! twice and four times an electrical turn. It is integrated in time, so nothing here knows a response.

use crate::plant::{Noise, through_text};
use corehbot_resonance::motors::{Drive, Motors, Repeat};
use corehbot_resonance::profile::{Profile, profile};
use corehbot_resonance::recording::Recording;
use corehbot_resonance::run::{Run, run};
use std::f64::consts::{SQRT_2, TAU};

const RATE_HZ: f64 = 1600.0;
const FINE: usize = 16;

/// A CoreXY with 20 teeth of 2 mm and 200 full steps a turn: five full steps a mm of belt.
fn drives() -> [Drive; 2] {
    let drive = |motors: &str, full_steps_per_mm| Drive { motors: motors.to_owned(), full_steps_per_mm };
    [drive("a", [5.0, 5.0]), drive("b", [5.0, -5.0])]
}

/// A side of the machine: frequency and damping of the tool, and errors of the field in mm once, twice and four times
/// an electrical turn.
struct Side {
    hz: f64,
    damping: f64,
    errors_mm: [f64; 3],
}

/// The tool while this side's motors turn at a speed along their diagonal; the acceleration is along x and y.
fn recording(side: &Side, speed: f64, angle: f64, noise: f64) -> Recording {
    // Their belt runs by 2^(1/2) of the tool's way, and an electrical turn is 0.8 mm of it.
    let turns_hz = SQRT_2 * speed / 0.8;
    let (w, dt) = (TAU * side.hz, 1.0 / (RATE_HZ * FINE as f64));
    let (mut place, mut v, mut samples) = (0.0, 0.0, Vec::new());
    // A second to settle, and two that are recorded.
    for i in 0..(3.0 * RATE_HZ) as usize * FINE {
        let turns = turns_hz * i as f64 * dt;
        let field = |(times, mm): (f64, &f64)| mm * (TAU * times * turns + 0.7 * times).sin();
        let error: f64 = [1.0, 2.0, 4.0].into_iter().zip(&side.errors_mm).map(field).sum();
        let a = w * w * (error - place) - 2.0 * side.damping * w * v;
        v += a * dt;
        place += v * dt;
        if i % FINE == 0 && i as f64 * dt >= 1.0 {
            samples.push(a);
        }
    }
    let (sin, cos) = angle.to_radians().sin_cos();
    let mut source = Noise(1 + (speed * 100.0 + angle) as u64);
    let mut along = |part: f64, rest: f64| samples.iter().map(|a| part * a + rest + noise * source.normal()).collect();
    let axes = [along(cos, 0.0), along(sin, 0.0), along(0.0, 9806.65)];
    Recording { rate_hz: RATE_HZ, axes, remarks: Vec::new() }
}

/// Runs of both sides from 10 mm/s on.
fn measured(sides: [&Side; 2], speeds: usize, step: f64, noise: f64) -> Profile {
    let mut runs: Vec<Run> = Vec::new();
    for (side, angle) in sides.into_iter().zip([45.0, 135.0]) {
        for i in 0..speeds {
            let speed = 10.0 + step * i as f64;
            runs.push(run("run", [angle, speed], &through_text(&recording(side, speed, angle, noise))).unwrap());
        }
    }
    profile(runs, &drives())
}

const GOOD: Side = Side { hz: 62.0, damping: 0.05, errors_mm: [0.004, 0.002, 0.001] };

fn order(motors: &Motors, repeats: Repeat) -> &corehbot_resonance::motors::Order {
    motors.orders.iter().find(|order| order.repeats == repeats).unwrap()
}

#[test]
fn frequency_damping_and_errors_of_each_side_are_those_of_the_machine() {
    let other = Side { hz: 55.0, damping: 0.08, errors_mm: [0.002, 0.002, 0.001] };
    let found = measured([&GOOD, &other], 60, 2.0, 20.0);
    let names: Vec<(&str, f64)> = found.motors.iter().map(|m| (m.motors.as_str(), m.angle_deg)).collect();
    assert_eq!(names, [("a", 45.0), ("b", 135.0)]);
    for (motors, side) in found.motors.iter().zip([&GOOD, &other]) {
        let mode = motors.modes[0];
        println!("{mode:?} {:?}", motors.fit_error_db);
        assert_eq!(motors.modes.len(), 1, "{:?}", motors.modes);
        assert!((mode.frequency_hz / side.hz - 1.0).abs() < 0.005, "{mode:?}");
        assert!((mode.damping_ratio / side.damping - 1.0).abs() < 0.1, "{mode:?}");
        assert!((mode.damping_ratio - side.damping).abs() < 4.0 * mode.damping_ratio_error + 0.002, "{mode:?}");
        let orders = [Repeat::ElectricalTurn, Repeat::HalfTurn, Repeat::FullStep];
        for (repeats, mm) in orders.into_iter().zip(side.errors_mm) {
            let order = order(motors, repeats);
            let slow_um = order.slow_um.unwrap();
            assert!((slow_um / (1e3 * mm) - 1.0).abs() < 0.1, "{repeats:?}: {slow_um} um for {mm} mm");
            assert_eq!(order.fitted_um.len(), order.frequencies_hz.len());
        }
        assert!(motors.remarks.is_empty(), "{:?}", motors.remarks);
        // The mean over all speeds has its greatest density near the mode.
        let top = (0..motors.density.len()).max_by(|a, b| motors.density[*a].total_cmp(&motors.density[*b])).unwrap();
        assert!((top as f64 * motors.step_hz - side.hz).abs() < 4.0, "{top}");
    }
}

#[test]
fn a_side_that_is_three_times_as_loud_leaves_half_of_the_symmetry() {
    let loud = Side { errors_mm: GOOD.errors_mm.map(|mm| 3.0 * mm), ..GOOD };
    let same = measured([&GOOD, &GOOD], 20, 6.0, 0.0).symmetry.unwrap();
    assert!(same.symmetry_percent > 99.9 && same.level_difference_db.abs() < 0.01, "{same:?}");
    let found = measured([&loud, &GOOD], 20, 6.0, 0.0).symmetry.unwrap();
    // 1 - (3 - 1) / (3 + 1), and 20 log 3: linear machines have it at every speed.
    assert!((found.symmetry_percent - 50.0).abs() < 0.5, "{}", found.symmetry_percent);
    assert!((found.level_difference_db - 9.542).abs() < 0.05, "{}", found.level_difference_db);
    assert!(found.shape_percent.unwrap() > 99.9, "a correlation does not see it");
    assert_eq!((found.pairs.len(), found.worst.angles_deg), (20, [45.0, 135.0]));
    // Another frequency: as loud, but elsewhere.
    let moved = measured([&Side { hz: 45.0, ..GOOD }, &GOOD], 20, 6.0, 0.0).symmetry.unwrap();
    assert!(moved.symmetry_percent < 80.0 && moved.shape_percent.unwrap() < 70.0, "{moved:?}");
}

#[test]
fn what_cannot_be_told_is_said() {
    // Speeds so far apart that hardly one meets the mode.
    let sharp = Side { damping: 0.01, errors_mm: [0.004, 0.0, 0.0], ..GOOD };
    let coarse = measured([&sharp, &sharp], 12, 13.0, 0.0);
    assert!(coarse.motors[0].remarks.iter().any(|r| r.contains("smaller steps of speed")), "{:?}", coarse.motors[0]);
    // Motors without errors under the noise of the sensor.
    let still = measured([&Side { errors_mm: [0.0; 3], ..GOOD }, &GOOD], 12, 10.0, 100.0);
    assert!(still.motors[0].modes.is_empty() && still.motors[0].remarks[0].contains("above the noise"));
    // Along x and y both groups turn, and x is no mirror image of y.
    let rigid = recording(&GOOD, 50.0, 0.0, 1.0);
    let along_axes = profile([0.0, 90.0].map(|angle| run("run", [angle, 50.0], &rigid).unwrap()).into(), &drives());
    assert!(along_axes.motors.is_empty() && along_axes.symmetry.is_none());
}
