//! Corner speeds against the paper's geometry, in double precision: the speed at which the released moves really pass a
//! corner, for corners of all angles in x, y and z.
//!
//! The reference shares neither code nor formulas with the planner, which works with half angles and no circle. Here
//! the circle is constructed: it touches both moves, its centre lies on the line that halves the angle between them,
//! and it leaves the corner by the deviation. The limits of axes and motors are taken along that line, the direction of
//! the acceleration in the middle of the arc.

use super::speeds::speeds;
use crate::dice::Dice;
use crate::line::plan;
use corehbot::motion::Move;
use corehbot::settings::{CornerRule, Settings};
use corehbot::units::{Mm, MmPerSec, MmPerSec2, Ratio, Steps};

/// Speeds are planned in single precision, from directions of 30 bits: over 200,000 corners that makes 1e-5 of the
/// speed at most.
const TOLERANCE: f64 = 5e-5;

type Vector = [f64; 3];

fn dot(p: Vector, q: Vector) -> f64 {
    p.iter().zip(q).map(|(p, q)| p * q).sum()
}

fn scaled(p: Vector, by: f64) -> Vector {
    p.map(|p| p * by)
}

fn plus(p: Vector, q: Vector) -> Vector {
    std::array::from_fn(|i| p[i] + q[i])
}

fn unit(p: Vector) -> Vector {
    scaled(p, 1.0 / dot(p, p).sqrt())
}

/// A move as it was emitted: direction and length in mm, filament a mm.
struct Way {
    unit: Vector,
    length: f64,
    extrusion: f64,
}

fn way(from: [Steps; 4], m: &Move, s: &Settings) -> Way {
    let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
    let d: [f64; 4] = std::array::from_fn(|i| m.end[i].wrapping_sub(from[i]).to_num::<f64>() / pitch[i]);
    let tool = [d[0], d[1], d[2]];
    let length = dot(tool, tool).sqrt();
    Way { unit: scaled(tool, 1.0 / length), length, extrusion: d[3] / length }
}

/// The least of the wanted value and the limits of each axis and motor along `direction`.
fn bounded(wanted: f64, direction: Vector, axes: Vector, motor: f64) -> f64 {
    let [x, y, z] = direction;
    let [ax, ay, az] = axes;
    [(ax, x), (ay, y), (az, z), (motor, x + y), (motor, x - y)]
        .into_iter()
        .map(|(most, share)| most / share.abs())
        .fold(wanted, f64::min)
}

/// The greatest speed from `p` into `q`, both commanded with `feed`.
fn reference(p: &Way, q: &Way, feed: f64, s: &Settings) -> f64 {
    let accelerations = s.axes.map(|a| a.max_acceleration.to_num::<f64>());
    let speeds = s.axes.map(|a| a.max_speed.to_num::<f64>());
    let motor = s.motor_max_acceleration.to_num::<f64>();
    let axes = [accelerations.x, accelerations.y, accelerations.z];
    let purpose =
        |w: &Way| if w.extrusion == 0.0 { s.travel_acceleration } else { s.print_acceleration }.to_num::<f64>();
    let along = |w: &Way, purpose: f64| bounded(purpose, w.unit, axes, motor).min(accelerations.e / w.extrusion.abs());
    let fast = |w: &Way| {
        let v = bounded(feed, w.unit, [speeds.x, speeds.y, speeds.z], s.motor_max_speed.to_num());
        v.min(speeds.e / w.extrusion.abs())
    };

    // The line that halves the angle points from the corner to the centre.
    let inwards = unit(plus(scaled(p.unit, -1.0), q.unit));
    let [before, after] = [p, q].map(|w| along(w, purpose(w)));
    let bears = bounded(after, inwards, axes, motor);
    // A circle of radius 1 with its centre so far in that it touches both moves: its distance from the corner.
    let turn = dot(p.unit, q.unit).clamp(-1.0, 1.0).acos();
    let centre = 1.0 / (turn / 2.0).cos();
    // Its distance grows with its radius. For small angles 1/cos - 1 cancels, so it is computed from the sine.
    let deviation = (turn / 2.0).sin().powi(2) / ((turn / 2.0).cos() * (1.0 + (turn / 2.0).cos()));
    assert!((centre - 1.0 - deviation).abs() < 1e-9 * centre);
    let bend = match s.corner {
        CornerRule::JunctionDeviation(d) => bears * d.to_num::<f64>() / deviation,
        // The deviation for which a corner of 90 degrees gives that speed at the commanded acceleration. Each move has
        // its own, and what it bears.
        CornerRule::SquareCorner(w) => {
            let square = |w: f64, bears: f64, commanded: f64| w.powi(2) * (2f64.sqrt() - 1.0) * bears / commanded;
            let w = w.to_num();
            square(w, before, purpose(p)).min(square(w, bears, purpose(q))) / deviation
        }
    };
    // A circle that touches both moves at the same distance from the corner, at most half the shorter one.
    let curve = bears * p.length.min(q.length) / 2.0 / (turn / 2.0).tan();
    let jerk = s.extruder_jerk.to_num::<f64>() / (p.extrusion - q.extrusion).abs();
    // The slope changes by this at least, with each of the three points rounded to a thousandth.
    let rise = (q.unit[2] - p.unit[2]).abs() - 0.001 / p.length - 0.001 / q.length;
    let z_jerk = if rise > 0.0 { s.z_jerk.to_num::<f64>() / rise } else { f64::INFINITY };

    let reach = (2.0 * before * p.length).sqrt();
    let rest = (2.0 * after * q.length).sqrt();
    [bend.sqrt(), curve.sqrt(), jerk, z_jerk, fast(p), fast(q), reach, rest].into_iter().fold(feed, f64::min)
}

fn direction(dice: &mut Dice) -> Vector {
    loop {
        let v: Vector = std::array::from_fn(|_| 2.0 * dice.roll() - 1.0);
        if (0.01..1.0).contains(&dot(v, v)) {
            return unit(v);
        }
    }
}

/// A direction that `p` may turn to: any, one in the bed plane, a slight turn, nearly back, or along one axis.
fn turned(p: Vector, dice: &mut Dice) -> Vector {
    let other = direction(dice);
    match (dice.roll() * 6.0) as u8 {
        0 => other,
        1 => unit([other[0], other[1], 0.0]),
        2 => unit(plus(p, scaled(other, 0.003 * 100f64.powf(dice.roll())))),
        3 => unit(plus(scaled(p, -1.0), scaled(other, 0.003 * 100f64.powf(dice.roll())))),
        4 => [1.0f64.copysign(other[0]), 0.0, 0.0],
        _ => [0.0, 0.0, 1.0f64.copysign(other[2])],
    }
}

/// A machine of random limits.
pub fn machine(dice: &mut Dice) -> Settings {
    let mut s = Settings::prototype();
    let cruise = 0.9 * dice.roll();
    let mut between = |least: f64, most: f64| least * (most / least).powf(dice.roll());
    s.print_acceleration = MmPerSec2::from_num(between(300.0, 20_000.0));
    s.travel_acceleration = MmPerSec2::from_num(between(300.0, 20_000.0));
    s.axes.x.max_acceleration = MmPerSec2::from_num(between(500.0, 20_000.0));
    s.axes.y.max_acceleration = MmPerSec2::from_num(between(500.0, 20_000.0));
    s.axes.z.max_acceleration = MmPerSec2::from_num(between(50.0, 5000.0));
    s.motor_max_acceleration = MmPerSec2::from_num(between(500.0, 20_000.0));
    s.motor_max_speed = MmPerSec::from_num(between(100.0, 900.0));
    s.minimum_cruise_ratio = Ratio::from_num(cruise);
    s.extruder_jerk = MmPerSec::from_num(between(0.5, 20.0));
    s.z_jerk = MmPerSec::from_num(between(0.1, 1000.0));
    let rules: Vec<CornerRule> = CornerRule::all().collect();
    let from_the_last = (between(1.0, std::f64::consts::E).ln() * rules.len() as f64) as usize;
    s.corner = match rules[rules.len() - 1 - from_the_last.min(rules.len() - 1)] {
        CornerRule::SquareCorner(_) => CornerRule::SquareCorner(MmPerSec::from_num(between(1.0, 20.0))),
        CornerRule::JunctionDeviation(_) => CornerRule::JunctionDeviation(Mm::from_num(between(0.001, 0.5))),
    };
    s
}

#[test]
fn corners_in_space_are_passed_at_the_speed_of_the_geometry() {
    let mut dice = Dice(0xC0FF_EE00_D15E_A5E5);
    let (mut corners, mut worst) = (0, 0f64);
    for _ in 0..200_000 {
        let s = machine(&mut dice);
        let first = direction(&mut dice);
        let second = turned(first, &mut dice);
        let mut length = || 10.0 + 20.0 * dice.roll();
        let (p, q) = (scaled(first, length()), scaled(second, length()));
        let mut extrusion = || if dice.roll() < 0.3 { 0.0 } else { 3.0 * dice.roll() };
        let (ep, eq) = (extrusion(), extrusion());
        let feed = 10.0 * 60f64.powf(dice.roll());
        let end = plus(p, q);
        let moves = plan(&[([p[0], p[1], p[2], ep], feed), ([end[0], end[1], end[2], ep + eq], feed)], &s);
        let [before, after] = moves.as_slice() else { panic!("{} moves", moves.len()) };
        let (p, q) = (way([Steps::ZERO; 4], before, &s), way(before.end, after, &s));
        let ([real, ..], exact) = (speeds(after, q.length), reference(&p, &q, feed, &s));
        // For a move straight back the directions, which have 30 bits, show that it is one.
        if exact < 0.05 {
            assert!(real < 0.06, "{real} mm/s, {exact}");
            continue;
        }
        corners += 1;
        worst = worst.max((real / exact - 1.0).abs());
        assert!(
            (real / exact - 1.0).abs() < TOLERANCE,
            "{real} mm/s, {exact} by geometry, from {:?} to {:?} with {s:?}",
            p.unit,
            q.unit
        );
    }
    println!("{corners} corners, off by {worst:e} at most");
    assert!(corners > 190_000, "{corners}");
}
