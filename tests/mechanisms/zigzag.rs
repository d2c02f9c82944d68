//! Zig-zag: the path if motors stepped one after the other, and proof that the generator does not do that.

use super::machines::{COREXYZ, COREXYZ_THREE, MACHINES, settings, strain};
use super::stepping::add;
use crate::line::{generate_on, plan};
use corehbot::kinematics::{Groups, Mechanism};
use corehbot::motors::{MOTORS, Motor};

/// The tool's distance from the line of an axis move, in steps: the largest sideways motion between begin and end.
fn lateral(way: &[f64; 3], axis: usize) -> f64 {
    way.iter().enumerate().filter(|(i, _)| *i != axis).map(|(_, w)| w * w).sum::<f64>().sqrt()
}

/// The tool's position by the motors' counts, in steps.
pub fn tool(mechanism: &Mechanism, counts: &[i64; MOTORS]) -> [f64; 3] {
    let [x, y, z, _] =
        mechanism.forward_kinematics().unwrap().fractions(counts).map(|(sum, over)| sum as f64 / over as f64);
    [x, y, z]
}

/// The largest distance of the tool from its line, and of the motors from their constraint, in the middle of one step
/// along an axis. Its motors make the step one after the other, in this order.
fn sequential(mechanism: &Mechanism, axis: usize, order: &[Motor]) -> (f64, i64) {
    let mut position = [0; 4];
    position[axis] = 1;
    let wanted = mechanism.inverse(position);
    let mut counts = [0; MOTORS];
    let (mut worst, mut worst_strain) = (0f64, 0);
    for motor in order {
        counts[motor.index()] = wanted[motor.index()];
        worst = worst.max(lateral(&tool(mechanism, &counts), axis));
        let [n1, n4, n8, n11, ..] = counts;
        worst_strain = worst_strain.max((n1 - n4 + n8 - n11).abs());
    }
    assert_eq!(counts, wanted, "all motors have stepped");
    (worst, worst_strain)
}

/// All orders of some motors.
fn orders(motors: &[Motor]) -> Vec<Vec<Motor>> {
    let Some((first, rest)) = motors.split_first() else { return vec![Vec::new()] };
    let mut all = Vec::new();
    for order in orders(rest) {
        for place in 0..=order.len() {
            let mut with = order.clone();
            with.insert(place, *first);
            all.push(with);
        }
    }
    all
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

/// Carlyle's zig-zag: motors that step one after the other bring the tool aside by this many steps, by the order.
/// Stepping them in one instant, as the next test shows of our generator, makes it 0.
#[test]
fn sequential_steps_zig_zag() {
    use corehbot::motors::prototype::{M1, M4, M8, M11};
    let root = |x: f64| x.sqrt();
    // A CoreXY by half a step, whichever motor is first.
    for axis in 0..2 {
        for order in orders(&[M8, M11]) {
            assert!(is_near(sequential(&MACHINES[1].1, axis, &order).0, 0.5));
        }
    }
    // Three motors by 0.7071 in four orders of six, by half a step in two.
    for axis in 0..3 {
        let mut widths: Vec<f64> =
            orders(&[M11, M8, M4]).iter().map(|order| sequential(&COREXYZ_THREE, axis, order).0).collect();
        widths.sort_by(f64::total_cmp);
        let expected = [0.5, 0.5, root(0.5), root(0.5), root(0.5), root(0.5)];
        assert!(widths.iter().zip(expected).all(|(width, expected)| is_near(*width, expected)), "{widths:?}");
    }
    for (axis, order) in [
        (0, [M8, M11, M4]),
        (0, [M4, M11, M8]),
        (1, [M11, M4, M8]),
        (1, [M8, M4, M11]),
        (2, [M11, M8, M4]),
        (2, [M4, M8, M11]),
    ] {
        assert!(is_near(sequential(&COREXYZ_THREE, axis, &order).0, 0.5), "{axis} {order:?}");
    }
    // Four motors by 0.3536 if they are strained by two steps in between, by half a step if by one.
    for axis in 0..3 {
        for order in orders(&[M11, M8, M4, M1]) {
            let (width, strain) = sequential(&COREXYZ, axis, &order);
            let expected = if strain == 2 { root(0.125) } else { 0.5 };
            assert!(is_near(width, expected), "{axis} {order:?}: {width}, strained by {strain}");
        }
    }
    assert_eq!(sequential(&COREXYZ, 0, &[M11, M1, M8, M4]).1, 2);
    // The CoreH-bot by a quarter if each pair steps in turn, by half a step in the worst order.
    let corehbot = Mechanism::corehbot();
    for (axis, order) in [(0, [M1, M4, M8, M11]), (1, [M1, M11, M4, M8])] {
        let (width, strain) = sequential(&corehbot, axis, &order);
        assert!(is_near(width, 0.25) && strain == 1, "{axis}: {width}, strained by {strain}");
        let worst = orders(&order).iter().map(|order| sequential(&corehbot, axis, order).0).fold(0.0, f64::max);
        assert!(is_near(worst, 0.5), "{axis}: {worst}");
    }
}

/// The real events of our generator, also of moves to places between steps. In a move of one axis all its motors step
/// in the same instants, so that the tool never leaves the line and nothing is strained, on every machine.
#[test]
fn axis_moves_do_not_zig_zag() {
    for (name, mechanism) in MACHINES {
        let (s, groups) = (settings(mechanism), Groups::new(&mechanism));
        for axis in 0..3 {
            let mut targets = Vec::new();
            for (to, speed) in [(3.707, 20.0), (11.301, 90.0), (1.913, 150.0), (25.0, 13.0), (20.109, 300.0)] {
                let mut at = [0.0; 4];
                at[axis] = to;
                targets.push((at, speed));
            }
            let steps = generate_on(&plan(&targets, &s), &s);
            let mut counts = [0; MOTORS];
            for step in &steps {
                assert_eq!(step.steps, mechanism.motors_of(axis), "{name}, axis {axis} at {}", step.tick);
                add(&mut counts, step);
                assert!(
                    is_near(lateral(&tool(&mechanism, &counts), axis), 0.0),
                    "{name}, axis {axis} at {}",
                    step.tick
                );
                assert_eq!(strain(&groups, &counts), 0, "{name}, axis {axis} at {}", step.tick);
            }
            assert!(steps.len() > 3000, "{name}, axis {axis}: {} steps", steps.len());
            let end = tool(&mechanism, &counts)[axis];
            let wanted = 20.109 * [s.axes.x, s.axes.y, s.axes.z][axis].steps_per_mm.to_num::<f64>();
            assert!((end - wanted).abs() <= 0.5, "{name}, axis {axis}: {end} instead of {wanted}");
        }
    }
}
