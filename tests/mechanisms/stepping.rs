//! Stepping: the generator keeps to the rows and to the limits of each motor.

use super::machines::{COREXYZ, MACHINES, UNEQUAL, all, settings, strain};
use super::zigzag::tool;
use crate::line::{Step, generate_on, plan};
use corehbot::kinematics::{Groups, Mechanism};
use corehbot::motors::{MOTORS, Motor, prototype};
use corehbot::units::{MmPerSec, MmPerSec2, Ratio, Steps, StepsPerMm};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Any path on any machine. Motors of a group step together, the forbidden motion of four coordinates of three axes
    /// stays below two steps, and the end is met to half a step.
    #[test]
    fn a_path_is_stepped_as_the_rows_say(
        path in prop::collection::vec(((0.0..30.0f64, 0.0..30.0f64, 0.0..3.0f64), 5.0..200.0f64), 1..8),
    ) {
        for (name, mechanism) in all() {
            let s = settings(mechanism);
            let targets: Vec<_> = path.iter().map(|((x, y, z), speed)| ([*x, *y, *z, x + z], *speed)).collect();
            let moves = plan(&targets, &s);
            let steps = generate_on(&moves, &s);
            let groups = Groups::new(&mechanism);
            let mut counts = [0i64; MOTORS];
            for step in &steps {
                prop_assert!(mechanism.is_unstrained(step.steps, step.forward), "{} at {}", name, step.tick);
                prop_assert!(step.steps.without(mechanism.fitted()).is_empty(), "{} at {}", name, step.tick);
                add(&mut counts, step);
                prop_assert!(strain(&groups, &counts).abs() <= 2, "{} at {}", name, step.tick);
            }
            prop_assert!(strain(&groups, &counts).abs() < 2, "{}", name);
            let end = moves.last().map_or([Steps::ZERO; 4], |m| m.end);
            // Motors that are half a step off put the tool half a step off; more of it where thirds hold it.
            let most = if name == "skew" { 0.67 } else { 0.501 };
            for (at, end) in tool(&mechanism, &counts).into_iter().zip(end) {
                prop_assert!((at - end.to_num::<f64>()).abs() <= most, "{}: {} instead of {} steps", name, at, end);
            }
            prop_assert!((counts[6] as f64 - end[3].to_num::<f64>()).abs() <= 0.501);
        }
    }
}

pub fn add(counts: &mut [i64; MOTORS], step: &Step) {
    for (motor, count) in Motor::ALL.into_iter().zip(counts) {
        if step.steps.has(motor) {
            *count += if step.forward.has(motor) { 1 } else { -1 };
        }
    }
}

/// Motor 11 has 80 steps/mm and motor 8 has 100; thousands of moves later neither is a step off.
#[test]
fn motors_of_different_pulleys_keep_their_places() {
    let mut s = settings(UNEQUAL);
    (s.axes.x.steps_per_mm, s.axes.y.steps_per_mm) = (StepsPerMm::from_num(20), StepsPerMm::from_num(20));
    assert_eq!([prototype::M11, prototype::M8].map(|motor| s.steps_per_mm(motor)), [80, 100].map(StepsPerMm::from_num));
    let counted = |targets: &[([f64; 4], f64)]| {
        let mut counts = [0i64; MOTORS];
        generate_on(&plan(targets, &s), &s).iter().for_each(|step| add(&mut counts, step));
        counts
    };
    assert_eq!(counted(&[([10.0, 0.0, 0.0, 0.0], 100.0)])[2..4], [1000, 800]);
    assert_eq!(counted(&[([0.0, 10.0, 0.0, 0.0], 100.0)])[2..4], [-1000, 800]);
    // None of these numbers has a finite number of binary places.
    let mut targets: Vec<_> =
        (0..3000).map(|n| ([0.1 * f64::from(n % 7), 0.3 * f64::from(n % 11), 0.0, 0.0], 150.0)).collect();
    targets.push(([0.1, 0.3, 0.0, 0.0], 150.0));
    assert_eq!(counted(&targets)[2..4], [-20, 32]);
}

/// A diagonal is as fast as the motors that it asks most of.
#[test]
fn every_machine_is_as_fast_as_its_motors() {
    let peak = |mechanism: Mechanism, to: [f64; 4]| {
        let mut s = settings(mechanism);
        for axis in [&mut s.axes.x, &mut s.axes.y, &mut s.axes.z] {
            (axis.max_speed, axis.max_acceleration) = (MmPerSec::from_num(1000), MmPerSec2::from_num(5000));
            axis.steps_per_mm = StepsPerMm::from_num(80);
        }
        // The peak of a move counts, not the time at it.
        s.minimum_cruise_ratio = Ratio::ZERO;
        let steps = generate_on(&plan(&[(to, 1000.0)], &s), &s);
        let rate = |motor: Motor| {
            let ticks: Vec<u64> = steps.iter().filter(|step| step.steps.has(motor)).map(|step| step.tick).collect();
            ticks.windows(65).map(|w| 64e7 / (w[64] - w[0]) as f64 / 80.0).fold(0.0, f64::max)
        };
        Motor::ALL.into_iter().filter(|m| !prototype::E.has(*m)).map(rate).fold(0.0, f64::max)
    };
    let most = 450.0;
    for (mechanism, to, expected) in [
        // x + y of the CoreH-bot, x + y + z of a CoreXYZ, y + z of nothing on a CoreXZ.
        (Mechanism::corehbot(), [200.0, 200.0, 0.0, 0.0], most),
        (COREXYZ, [100.0, 100.0, 100.0, 0.0], most),
        (COREXYZ, [0.0, 0.0, 200.0, 0.0], most),
        (MACHINES[4].1, [150.0, 0.0, 150.0, 0.0], most),
        (MACHINES[5].1, [0.0, 0.0, 300.0, 0.0], 1000.0),
        (MACHINES[5].1, [200.0, 200.0, 0.0, 0.0], most),
    ] {
        let found = peak(mechanism, to);
        assert!((found / expected - 1.0).abs() < 0.01, "{to:?} of {mechanism:?}: {found} mm/s");
    }
}
