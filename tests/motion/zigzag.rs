//! Short zig-zags: with a minimum cruise ratio the machine no longer falls from accelerating into braking in every
//! move, and shakes its frame less. Long moves stay as they are.

use crate::line::plan;
use corehbot::motion::{Move, WHOLE};
use corehbot::settings::Settings;
use corehbot::units::{Length, Ratio};
use std::f64::consts::TAU;

fn with(ratio: f64) -> Settings {
    Settings { minimum_cruise_ratio: Ratio::from_num(ratio), ..Settings::prototype() }
}

/// Infill between two walls `width` mm apart, at 0.4 mm from line to line, wanted at 300 mm/s.
fn infill(width: f64) -> Vec<([f64; 4], f64)> {
    let mut targets = Vec::new();
    let (mut x, mut e) = (0.0, 0.0);
    for line in 0..100 {
        let y = 0.4 * f64::from(line);
        if line > 0 {
            e += 0.4 * 0.033;
            targets.push(([x, y, 0.0, e], 300.0));
        }
        x = width - x;
        e += width * 0.033;
        targets.push(([x, y, 0.0, e], 300.0));
    }
    targets
}

fn seconds(time: u64) -> f64 {
    time as f64 / 65536.0 / 1e7
}

fn total(moves: &[Move]) -> f64 {
    moves.iter().map(|m| seconds(m.time().0)).sum()
}

/// Changes a second from accelerating straight into braking, with less than a millisecond between.
fn flips(moves: &[Move]) -> f64 {
    let is_flip = |m: &&Move| m.accelerate.0 > 0 && m.decelerate.0 > 0 && seconds(m.cruise.0) < 1e-3;
    moves.iter().filter(is_flip).count() as f64 / total(moves)
}

/// The greatest speed along x, in mm/s.
fn fastest(moves: &[Move], width: f64) -> f64 {
    let part = |fraction: u32| f64::from(fraction) / f64::from(WHOLE);
    let peak = |m: &Move| part(m.accelerated) * width / seconds(m.accelerate.0) * (2.0 - part(m.entry_share));
    moves.iter().step_by(2).map(peak).fold(0.0, f64::max)
}

/// The swing of a frame with that frequency along x, as the root of the mean square, in mm: x'' = -w^2 x - 2 d w x' -
/// a.
fn swing(moves: &[Move], width: f64, frequency: f64) -> f64 {
    let (w, d) = (TAU * frequency, 0.05);
    let (mut x, mut v, mut sum, mut count) = (0.0f64, 0.0f64, 0.0, 0.0);
    let mut sign = 1.0;
    for m in moves {
        // Every other move goes along x; in those along y the tool has no acceleration there.
        let is_along = (m.length.0 as f64 / 2f64.powi(32) - width).abs() < 0.05;
        let a = m.acceleration.to_num::<f64>() * if is_along { sign } else { 0.0 };
        for (time, a) in [(m.accelerate, a), (m.cruise, 0.0), (m.decelerate, -a)] {
            let steps = (seconds(time.0) / 20e-6).ceil();
            let dt = seconds(time.0) / steps.max(1.0);
            for _ in 0..steps as u32 {
                v += (-w * w * x - 2.0 * d * w * v - a) * dt;
                x += v * dt;
                sum += x * x * dt;
                count += dt;
            }
        }
        if is_along {
            sign = -sign;
        }
    }
    (sum / count).sqrt()
}

#[test]
fn short_zigzags_do_not_fall_from_accelerating_into_braking() {
    for width in [1.0, 2.0, 4.0] {
        let [off, on] = [0.0, 0.5].map(|ratio| plan(&infill(width), &with(ratio)));
        let (before, after) = (flips(&off), flips(&on));
        let slower = total(&on) / total(&off) - 1.0;
        let speed = fastest(&on, width) / fastest(&off, width);
        println!("{width} mm: {before:.1} and {after:.1} flips/s, {speed:.3} as fast, {:.1} % longer", 100.0 * slower);
        assert!(before > 15.0, "{width} mm: {before} flips a second");
        assert!(after == 0.0, "{width} mm: {after} flips a second");
        // From rest to rest the speed would be 1/sqrt(2), and the time 3/(2 sqrt(2)) = 1.061. Corners are not at rest.
        assert!((0.70..0.80).contains(&speed), "{width} mm: {speed}");
        assert!((0.0..0.07).contains(&slower), "{width} mm: {slower}");
    }
}

#[test]
fn frames_swing_less_under_short_zigzags() {
    for width in [1.0, 2.0, 4.0] {
        let [off, on] = [0.0, 0.5].map(|ratio| plan(&infill(width), &with(ratio)));
        // Every frequency that a frame may have: one alone may be met by chance, or missed.
        let mean = |moves: &[Move]| {
            let frequencies = (30..150).step_by(5).map(f64::from);
            frequencies.map(|f| (swing(moves, width, f) * f * f).powi(2)).sum::<f64>().sqrt()
        };
        let part = mean(&on) / mean(&off);
        println!("{width} mm: {part:.3} of the swing");
        assert!(part < 0.9, "{width} mm: {part}");
    }
}

#[test]
fn long_moves_and_chains_of_short_ones_stay_as_they_are() {
    let long: Vec<_> = (1..40u8).map(|i| ([f64::from(i % 2) * 60.0, f64::from(i), 0.0, 0.0], 100.0)).collect();
    // 30 mm in 300 moves: one ramp up, one down, no matter how many corners are in them.
    let chain: Vec<_> = (1..=300u16).map(|i| ([f64::from(i) * 0.1, 0.0, 0.0, 0.0], 80.0)).collect();
    let retractions: Vec<_> = (1..20u8).map(|i| ([0.0, 0.0, 0.0, -0.8 * f64::from(i % 2)], 70.0)).collect();
    for path in [long, chain, retractions] {
        let [off, on] = [0.0, 0.5].map(|ratio| plan(&path, &with(ratio)));
        assert_eq!(off.len(), on.len());
        // The hop from line to line of 1 mm is too short to cruise at 100 mm/s.
        for (off, on) in off.iter().zip(&on).filter(|(off, _)| off.length != Length(1 << 32)) {
            assert_eq!(off, on);
        }
    }
}
