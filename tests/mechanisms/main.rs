//! Mechanisms as data: forward and inverse in whole numbers, what the motors may not do, and what stepping them in the same
//! instant buys.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

#[path = "../support/belt_equations.rs"]
mod belt_equations;
#[path = "../motion/line.rs"]
#[allow(dead_code, reason = "other tests need the rest of it")]
mod line;
mod prototype;

use belt_equations::{BeltSteps, residual};
use corehbot::kinematics::{ForwardKinematics, Groups, Mechanism, MechanismError, Row};
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::{MmPerSec, MmPerSec2, Ratio, Steps, StepsPerMm};
use line::{Step, generate_on, plan};
use proptest::prelude::*;

const NONE: Row = [0; 4];
const Z: Row = [0, 0, 1, 0];
const E: Row = [0, 0, 0, 1];

/// Motors 1, 4, 8, 11, both of z, and the extruder.
const MACHINES: [(&str, Mechanism); 8] = [
    ("corehbot", Mechanism::corehbot()),
    ("corexy", Mechanism { rows: [NONE, NONE, [1, -1, 0, 0], [1, 1, 0, 0], Z, NONE, E] }),
    ("corexyz", COREXYZ),
    ("corexyz, three motors", COREXYZ_THREE),
    ("corexz", Mechanism { rows: [[0, 1, 0, 0], NONE, [1, 0, -1, 0], [1, 0, 1, 0], NONE, NONE, E] }),
    ("cartesian", Mechanism { rows: [[1, 0, 0, 0], [0, 1, 0, 0], NONE, NONE, Z, Z, E] }),
    ("dual y", Mechanism { rows: [[1, 0, 0, 0], [0, 1, 0, 0], [0, -1, 0, 0], NONE, Z, NONE, E] }),
    // No belt goes this way, but the way back is over three.
    ("skew", Mechanism { rows: [NONE, [1, 1, 1, 0], [-1, 1, 0, 0], [-1, 0, 1, 0], NONE, NONE, E] }),
];

/// Carlyle's table: A in slot 11, B in 8, C in 4, D in 1.
const COREXYZ: Mechanism =
    Mechanism { rows: [[-1, 1, 1, 0], [-1, -1, 1, 0], [1, -1, 1, 0], [1, 1, 1, 0], NONE, NONE, E] };
const COREXYZ_THREE: Mechanism = Mechanism { rows: [NONE, [-1, -1, 1, 0], [1, -1, 1, 0], [1, 1, 1, 0], NONE, NONE, E] };

/// What motors with these counts say of the tool, if they agree on whole steps.
fn whole<const N: usize>(back: &ForwardKinematics<N>, counts: &[i64; N]) -> Option<[i64; 4]> {
    let fractions = back.fractions(counts);
    fractions.iter().all(|(sum, over)| sum % over == 0).then(|| fractions.map(|(sum, over)| sum / over))
}

/// The settings of a machine whose axes share a resolution.
fn settings(mechanism: Mechanism) -> Settings {
    let mut s = Settings { mechanism, ..Settings::prototype() };
    if mechanism.share(0, 2) || mechanism.share(1, 2) {
        s.axes.z = s.axes.x;
    }
    s.check_machine().unwrap();
    s
}

/// Reproducer: with halves rounded upwards one of two groups that mirror each other had a step more in the piece that ended
/// on half a step; found together with others, its steps then came a tick beside the other's.
#[test]
fn groups_that_mirror_each_other_round_alike() {
    for (whole, way) in (-5..6).flat_map(|whole| [0.25, 0.5, 0.75, 1.5, 2.5].map(|way| (f64::from(whole), way))) {
        let count = |at: f64| corehbot::kinematics::count_at(corehbot::units::Steps::from_num(at)) - whole as i32;
        assert_eq!(count(whole + way), -count(whole - way), "{way} beside {whole}");
    }
}

proptest! {
    /// Forward undoes inverse on every machine, by motors and by groups.
    #[test]
    fn the_way_back_is_exact(position in prop::array::uniform4(-1_000_000_000i64..1_000_000_000)) {
        for (name, mechanism) in MACHINES {
            let turned = mechanism.inverse(position);
            prop_assert_eq!(whole(&mechanism.forward_kinematics().unwrap(), &turned), Some(position), "{}", name);
        }
    }

    #[test]
    fn the_groups_are_the_motors(position in prop::array::uniform4(-100_000_000i32..100_000_000)) {
        for (name, mechanism) in MACHINES {
            let groups = Groups::new(&mechanism);
            let mut counts = [0; 5];
            for (count, group) in counts.iter_mut().zip(groups.iter()) {
                *count = group.coordinate(position.map(Steps::from_num)).to_num::<i32>();
            }
            let turned = mechanism.inverse(position.map(i64::from));
            prop_assert_eq!(groups.motor_counts(counts).map(i64::from), turned, "{}", name);
            let back = groups.position(counts);
            prop_assert_eq!(back, position.map(Steps::from_num), "{}", name);
        }
    }

    /// Null spaces. Of the CoreH-bot: the belt runs round and the tool stands. Of both machines with four motors: what
    /// they must not do moves nothing either, and no position asks for it.
    #[test]
    fn what_moves_no_tool(at in prop::array::uniform3(-10_000i64..10_000), c in -1000i64..1000, strain in -1000i64..1000) {
        let [x, y, z] = at;
        for mechanism in [Mechanism::corehbot(), COREXYZ] {
            let back = mechanism.forward_kinematics().unwrap();
            let turned = mechanism.inverse([x, y, z, 0]);
            let [n1, n4, n8, n11, ..] = turned;
            // n1 - n4 + n8 - n11: the CoreH-bot's residual, and -(A - B + C - D).
            prop_assert_eq!(residual(BeltSteps { n1, n4, n8, n11 }), 0);
            let mut strained = turned;
            for (count, way) in strained.iter_mut().zip([strain, -strain, strain, -strain]) {
                *count += way;
            }
            prop_assert_eq!(whole(&back, &strained), Some([x, y, z, 0]));
        }
        let mechanism = Mechanism::corehbot();
        let mut round = mechanism.inverse([x, y, z, 0]);
        round.iter_mut().take(4).for_each(|count| *count += c);
        prop_assert_eq!(whole(&mechanism.forward_kinematics().unwrap(), &round), Some([x, y, z, 0]));
    }

}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Any path on any machine: motors of a group step together, what four coordinates of three axes must not do stays below
    /// two steps, and the end is met to half a step.
    #[test]
    fn a_path_is_stepped_as_the_rows_say(
        path in prop::collection::vec(((0.0..30.0f64, 0.0..30.0f64, 0.0..3.0f64), 5.0..200.0f64), 1..8),
    ) {
        for (name, mechanism) in MACHINES {
            let s = settings(mechanism);
            let targets: Vec<_> = path.iter().map(|((x, y, z), speed)| ([*x, *y, *z, x + z], *speed)).collect();
            let moves = plan(&targets, &s);
            let steps = generate_on(&moves, &s);
            let groups = Groups::new(&mechanism);
            let mut counts = [0i64; 7];
            for step in &steps {
                prop_assert!(mechanism.is_unstrained(step.steps, step.forward), "{} at {}", name, step.tick);
                prop_assert!(step.steps.without(mechanism.fitted()).is_empty(), "{} at {}", name, step.tick);
                add(&mut counts, step);
                prop_assert!(strain(&groups, &counts).abs() <= 2, "{} at {}", name, step.tick);
            }
            prop_assert!(strain(&groups, &counts).abs() < 2, "{}", name);
            let end = moves.last().map_or([Steps::ZERO; 4], |m| m.end);
            // Motors half a step beside leave the tool half a step beside; more of it where thirds hold it.
            let most = if name == "skew" { 0.67 } else { 0.501 };
            for (at, end) in tool(&mechanism, &counts).into_iter().zip(end) {
                prop_assert!((at - end.to_num::<f64>()).abs() <= most, "{}: {} instead of {} steps", name, at, end);
            }
            prop_assert!((counts[6] as f64 - end[3].to_num::<f64>()).abs() <= 0.501);
        }
    }
}

fn add(counts: &mut [i64; 7], step: &Step) {
    for (motor, count) in Motor::ALL.into_iter().zip(counts) {
        if step.steps.has(motor) {
            *count += if step.forward.has(motor) { 1 } else { -1 };
        }
    }
}

/// The sum of counts that no position changes; 0 where there is none.
fn strain(groups: &Groups, counts: &[i64; 7]) -> i64 {
    let constraint = groups.constraint().unwrap_or_default();
    groups.iter().zip(constraint).map(|(group, times)| i64::from(times) * counts[group.lead as usize]).sum()
}

#[test]
fn the_only_constraint_is_that_of_four_coordinates() {
    for (name, mechanism) in MACHINES {
        let expected = (name == "corexyz").then_some([1, -1, 1, -1, 0]);
        let found = Groups::new(&mechanism).constraint();
        // The sign says nothing.
        assert!(found == expected || found.map(|c| c.map(|times| -times)) == expected, "{name}: {found:?}");
        assert_eq!(Groups::new(&mechanism).is_redundant(), expected.is_some(), "{name}");
    }
}

/// Steps of a CoreXYZ as its makers give them, a step of x, y and z.
#[test]
fn four_motors_turn_as_carlyles_table_says() {
    let turned = |position| {
        let [d, c, b, a, ..] = COREXYZ.inverse(position);
        [a, b, c, d]
    };
    assert_eq!(turned([1, 0, 0, 0]), [1, 1, -1, -1]);
    assert_eq!(turned([0, 1, 0, 0]), [1, -1, -1, 1]);
    assert_eq!(turned([0, 0, 1, 0]), [1, 1, 1, 1]);
    // With three of them: X = (B - C) / 2, Y = (A - B) / 2, Z = (A + C) / 2.
    let back = COREXYZ_THREE.forward_kinematics().unwrap();
    let (a, b, c) = (37, 11, -5);
    let [x, y, z, _] = back.fractions(&[0, c, b, a, 0, 0, 0]);
    for ((sum, over), twice) in [(x, b - c), (y, a - b), (z, a + c)] {
        assert_eq!(2 * sum, over * twice);
    }
}

/// Counts that no position has are read as the one that is nearest to all of them.
#[test]
fn counts_that_do_not_agree_are_read_by_least_squares() {
    let groups = Groups::new(&COREXYZ);
    let quarter = Steps::from_num(0.25);
    assert_eq!(groups.position([1, 0, 0, 0, 0]), [quarter, quarter, quarter, Steps::ZERO]);
    // And counted again they are the same.
    for counts in [[1, 0, 0, 0, 0], [5, 3, -2, 1, 7], [-4, -4, 2, 1, 0]] {
        let at = groups.position(counts);
        let again = groups.iter().map(|group| corehbot::kinematics::count_at(group.coordinate(at)));
        assert_eq!(again.collect::<Vec<_>>(), counts);
    }
}

#[test]
fn what_is_no_machine_is_refused() {
    let with = |motor: Motor, row: Row| {
        let mut mechanism = Mechanism::corehbot();
        mechanism.rows[motor as usize] = row;
        mechanism.check()
    };
    for (name, mechanism) in MACHINES {
        assert_eq!(mechanism.check(), Ok(()), "{name}");
    }
    assert_eq!(with(Motor::M8, [2, 0, 0, 0]), Err(MechanismError::Entry(Motor::M8)));
    assert_eq!(with(Motor::Z1, [0, 0, 1, 1]), Err(MechanismError::Mixed(Motor::Z1)));
    assert_eq!(with(Motor::E0, NONE), Err(MechanismError::NotDriven("e")));
    // Three pairs and the screws are four coordinates, but the second screw is a fifth beside the extruder.
    assert_eq!(with(Motor::M1, [1, 0, 0, 0]), Ok(()));
    let crowd = Mechanism { rows: [[1, 0, 0, 0], [0, 1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], Z, NONE, E] };
    assert_eq!(crowd.check(), Err(MechanismError::TooManyGroups));
    let loose = Mechanism { rows: [[1, 1, 0, 0], [-1, -1, 0, 0], NONE, NONE, Z, Z, E] };
    assert_eq!(loose.check(), Err(MechanismError::Loose));
}

#[test]
fn axes_that_share_motors_have_one_resolution() {
    let mut s = settings(COREXYZ);
    s.axes.z.steps_per_mm += StepsPerMm::ONE;
    assert_eq!(s.check().unwrap_err().to_string(), "x and z share motors: their steps_per_mm must be equal");
    let mut s = settings(MACHINES[5].1);
    s.axes.y.steps_per_mm = StepsPerMm::from_num(100);
    assert_eq!(s.check_machine(), Ok(()));
}

/// Settings are stored as what they are, the mechanism as one number.
#[test]
fn every_mechanism_is_stored() {
    for (name, mechanism) in MACHINES {
        let packed = i64::from(mechanism);
        assert_eq!(Mechanism::from(packed), mechanism, "{name}");
    }
    assert_eq!(Mechanism::from(0b10).check(), Err(MechanismError::Entry(Motor::M1)));
}

/// The tool's distance from the line of an axis move, in steps: how far the motors bring it to the side between begin and
/// end.
fn lateral(way: &[f64; 3], axis: usize) -> f64 {
    way.iter().enumerate().filter(|(i, _)| *i != axis).map(|(_, w)| w * w).sum::<f64>().sqrt()
}

/// What the motors make of the tool's way, in steps.
fn tool(mechanism: &Mechanism, counts: &[i64; 7]) -> [f64; 3] {
    let [x, y, z, _] =
        mechanism.forward_kinematics().unwrap().fractions(counts).map(|(sum, over)| sum as f64 / over as f64);
    [x, y, z]
}

/// How far the tool leaves its line, and the motors their constraint, in the middle of one step along an axis that its
/// motors make one after the other, in this order.
fn sequential(mechanism: &Mechanism, axis: usize, order: &[Motor]) -> (f64, i64) {
    let mut position = [0; 4];
    position[axis] = 1;
    let wanted = mechanism.inverse(position);
    let mut counts = [0; 7];
    let (mut worst, mut worst_strain) = (0f64, 0);
    for motor in order {
        counts[*motor as usize] = wanted[*motor as usize];
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

/// Carlyle's zig-zag: motors that step one after the other bring the tool aside by this many steps, by the order. Stepping
/// them in one instant, as the next test shows of our generator, makes it 0.
#[test]
fn sequential_steps_zig_zag() {
    use Motor::{M1, M4, M8, M11};
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
    // Four motors by 0.3536 if they are strained by two steps meanwhile, by half a step if by one.
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

/// Our generator's real events, also of moves to places between steps: in a move of one axis all motors that it needs step in the same instants, so that the tool
/// never leaves the line and nothing is strained, on every machine.
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
            let mut counts = [0; 7];
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

/// A diagonal is as fast as the motors that it asks most of.
#[test]
fn every_machine_is_as_fast_as_its_motors() {
    let peak = |mechanism: Mechanism, to: [f64; 4]| {
        let mut s = settings(mechanism);
        for axis in [&mut s.axes.x, &mut s.axes.y, &mut s.axes.z] {
            (axis.max_speed, axis.max_acceleration) = (MmPerSec::from_num(1000), MmPerSec2::from_num(5000));
            axis.steps_per_mm = StepsPerMm::from_num(80);
        }
        // What a move reaches, not how long it keeps that up.
        s.minimum_cruise_ratio = Ratio::ZERO;
        let steps = generate_on(&plan(&[(to, 1000.0)], &s), &s);
        let rate = |motor: Motor| {
            let ticks: Vec<u64> = steps.iter().filter(|step| step.steps.has(motor)).map(|step| step.tick).collect();
            ticks.windows(65).map(|w| 64e7 / (w[64] - w[0]) as f64 / 80.0).fold(0.0, f64::max)
        };
        Motor::ALL.into_iter().filter(|m| !MotorSet::E.has(*m)).map(rate).fold(0.0, f64::max)
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
