//! Steps on time: every step against the model's crossing, over ten thousand moves.

use super::model::{crossings, trapezoids};
use crate::dice::Dice;
use crate::line::{Step, generate, plan};
use corehbot::kinematics::{Group, Groups, Mechanism};
use corehbot::motion::MIN_STEP_INTERVAL;
use corehbot::settings::Settings;
use corehbot::units::MmPerSec2;

/// A wandering path with long and short moves, corners of all angles, hops and retractions.
pub fn wander(count: usize, seed: u64) -> Vec<([f64; 4], f64)> {
    let mut dice = Dice(seed);
    let mut at = [200.0, 200.0, 5.0, 0.0];
    let mut heading = 0.0f64;
    let mut targets = vec![(at, 200.0)];
    for i in 0..count {
        heading += (dice.roll() - 0.5) * if dice.roll() < 0.2 { 6.0 } else { 0.6 };
        let length = 0.05 * 400f64.powf(dice.roll());
        match i % 50 {
            17 => at[3] -= 1.5,
            18 => at[2] += 0.4,
            31 => at[2] -= 0.4,
            32 => at[3] += 1.5,
            _ => {
                at[0] = (at[0] + length * heading.cos()).clamp(10.0, 380.0);
                at[1] = (at[1] + length * heading.sin()).clamp(10.0, 400.0);
                at[3] += length * 0.03;
            }
        }
        // Speeds that the firmware can hold exactly, so that they are not part of the error.
        targets.push((at, (65536.0 * (20.0 + 280.0 * dice.roll())).round() / 65536.0));
    }
    targets
}

/// The groups of the CoreH-bot: u, v, z and e.
pub fn groups() -> Vec<Group> {
    Groups::new(&Mechanism::corehbot()).iter().take(4).copied().collect()
}

/// The steps of one group, with their signs.
pub fn steps_of(steps: &[Step], group: usize) -> Vec<(u64, i8)> {
    let lead = groups()[group].lead;
    steps.iter().filter(|s| s.steps.has(lead)).map(|s| (s.tick, if s.forward.has(lead) { 1 } else { -1 })).collect()
}

/// The error of each step in ticks, given where on the time axis each move of the model begins.
fn errors(targets: &[([f64; 4], f64)], begin: impl Fn(usize) -> f64) -> (usize, f64) {
    errors_of(targets, &Settings::prototype(), begin)
}

fn errors_of(targets: &[([f64; 4], f64)], settings: &Settings, begin: impl Fn(usize) -> f64) -> (usize, f64) {
    let model = trapezoids(targets, settings);
    let moves = plan(targets, settings);
    assert_eq!(moves.len(), model.len());
    let steps = generate(&moves);
    let (mut count, mut worst) = (0, 0f64);
    for (g, group) in groups().iter().enumerate() {
        let row = group.row.map(f64::from);
        let ideal: Vec<(f64, i8)> = model
            .iter()
            .enumerate()
            .flat_map(|(i, t)| crossings(t, row).into_iter().map(move |(s, way)| (i, s, way)))
            .map(|(i, s, way)| (begin(i) + s * 1e7, way))
            .collect();
        let real = steps_of(&steps, g);
        assert_eq!(real.len(), ideal.len(), "group {g}: steps are neither lost nor invented");
        let mut free = f64::MIN;
        for ((tick, way), (exact, expected)) in real.iter().zip(&ideal) {
            assert_eq!(way, expected, "group {g} at {tick}");
            // A motor that turns back right behind a step waits with the next one.
            worst = worst.max((*tick as f64 - exact.max(free)).abs());
            free = (*tick + MIN_STEP_INTERVAL) as f64;
            count += 1;
        }
    }
    (count, worst)
}

#[test]
fn every_step_is_within_a_tick_of_the_model_in_its_move() {
    let targets = wander(3000, 0x1234_5678_9ABC_DEF1);
    let moves = plan(&targets, &Settings::prototype());
    let begins: Vec<f64> = moves
        .iter()
        .scan(0u64, |t, m| {
            let begin = *t;
            *t += m.time().0;
            Some(begin as f64 / 65536.0)
        })
        .collect();
    let (count, worst) = errors(&targets, |i| begins[i]);
    assert!(count > 500_000, "{count} steps");
    // Rounding to a tick is half of one; the rest is the rounding of speeds to 15 um/s.
    assert!(worst <= 1.0, "worst of {count} steps: {worst} ticks");
}

#[test]
fn no_error_adds_up_over_ten_thousand_moves() {
    let targets = wander(10_000, 0xFEED_FACE_CAFE_BEEF);
    let settings = Settings::prototype();
    let model = trapezoids(&targets, &settings);
    let begins: Vec<f64> = model
        .iter()
        .scan(0.0, |t, m| {
            let begin = *t;
            *t += m.time() * 1e7;
            Some(begin)
        })
        .collect();
    let (count, worst) = errors(&targets, |i| begins[i]);
    assert!(count > 1_000_000, "{count} steps");
    // Positions cannot drift: each step is one of the model's. Time is summed from roundings of a 2^-16th of a tick, of
    // speeds and ramps to 24 bits and of accelerations to 0.004 mm/s2. That adds up to less than 3 us in more than 400
    // s, a thousandth of the error of a crystal of 5 ppm.
    println!("worst of {count} steps: {worst} ticks");
    assert!(worst <= 32.0, "worst of {count} steps in {} moves: {worst} ticks", model.len());
}

/// Reproducer: fractions of a move have 31 bits, and so had its length. One bit is 6 ticks in a move of 23 minutes.
#[test]
fn moves_of_many_minutes_are_as_exact() {
    for (length, speed) in
        [(390.0, 0.25), (417.0, 0.296_875), (300.0, 1.5), (30.0, 0.031_25), (390.0, 3.0), (2.0, 0.0625)]
    {
        for way in [[0.8, 0.6], [1.0, 0.0], [-0.28, 0.96]] {
            let (count, worst) = errors(&[([way[0] * length, way[1] * length, 0.0, 0.0], speed)], |_| 0.0);
            assert!(count > 200 && worst <= 1.0, "{length} mm at {speed} mm/s, {way:?}: {worst} ticks");
        }
    }
}

/// The time of a ramp is in single precision, and its slowest steps are where a fraction of its move is the longest
/// time.
#[test]
fn long_ramps_are_right_to_a_part_in_two_million() {
    for acceleration in [3000, 800, 200, 100, 20, 5] {
        let mut s = Settings::prototype();
        s.travel_acceleration = MmPerSec2::from_num(acceleration);
        for (x, y) in [(311.0, 247.3), (390.0, 0.0), (38.2, 380.9), (50.0, 33.0)] {
            let target = [([x, y, 0.0, 0.0], 200.0)];
            let (count, worst) = errors_of(&target, &s, |_| 0.0);
            let ramp = (trapezoids(&target, &s)[0].peak / f64::from(acceleration)) * 1e7;
            println!("{acceleration} mm/s2: {worst} ticks, ramps of {ramp} ticks");
            assert!(count > 5000 && worst <= 1.0 + 5e-7 * ramp, "{acceleration} mm/s2: {worst} ticks");
        }
    }
}
