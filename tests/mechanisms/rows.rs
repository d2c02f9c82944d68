//! Rows: motors from a position, a position from motors, and illegal machines.

use super::machines::{COREXYZ, COREXYZ_THREE, E, MACHINES, NONE, Z, all, settings};
use crate::belt_equations::{BeltSteps, residual};
use corehbot::kinematics::{ForwardKinematics, Groups, Mechanism, MechanismError, Row};
use corehbot::motors::{Motor, per_motor, prototype};
use corehbot::units::{Steps, StepsPerMm};
use proptest::prelude::*;

/// The tool's position for motors with these counts, if they agree on whole steps.
fn whole<const N: usize>(back: &ForwardKinematics<N>, counts: &[i64; N]) -> Option<[i64; 4]> {
    let fractions = back.fractions(counts);
    fractions.iter().all(|(sum, over)| sum % over == 0).then(|| fractions.map(|(sum, over)| sum / over))
}

/// Reproducer: halves were rounded upwards, so one of two groups that mirror each other had a step more in the piece
/// that ended on half a step. Found together with others, its steps then came a tick later or earlier than the other's.
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
        for (name, mechanism) in all() {
            let turned = mechanism.inverse(position);
            prop_assert_eq!(whole(&mechanism.forward_kinematics().unwrap(), &turned), Some(position), "{}", name);
        }
    }

    #[test]
    fn the_groups_are_the_motors(position in prop::array::uniform4(-100_000_000i32..100_000_000)) {
        for (name, mechanism) in all() {
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

    /// Null spaces. Of the CoreH-bot: the belt circulates and the tool stands. For both machines with four motors:
    /// their forbidden motion moves nothing either, and no position needs it.
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

#[test]
fn the_only_constraint_is_that_of_four_coordinates() {
    for (name, mechanism) in all() {
        let expected = (name == "corexyz").then_some([1, -1, 1, -1, 0]);
        let found = Groups::new(&mechanism).constraint();
        // The sign does not matter.
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
    let [x, y, z, _] = back.fractions(&per_motor(&[0, c, b, a], 0));
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
        mechanism.rows[motor.index()] = row;
        mechanism.check()
    };
    for (name, mechanism) in all() {
        assert_eq!(mechanism.check(), Ok(()), "{name}");
    }
    assert_eq!(with(prototype::M8, [2, 1, 0, 0]), Err(MechanismError::Entry(prototype::M8)));
    assert_eq!(with(prototype::M8, [17, 17, 0, 0]), Err(MechanismError::Entry(prototype::M8)));
    assert_eq!(with(prototype::M8, [i8::MIN, i8::MIN, 0, 0]), Err(MechanismError::Entry(prototype::M8)));
    assert_eq!(with(prototype::Z1, [0, 0, 4, 0]), Err(MechanismError::Multiples));
    // Two motors of one coordinate with different pulleys: more motors that differ than axes.
    assert_eq!(with(prototype::M8, [2, -2, 0, 0]), Err(MechanismError::Multiples));
    assert_eq!(with(prototype::Z1, [0, 0, 1, 1]), Err(MechanismError::Mixed(prototype::Z1)));
    assert_eq!(with(prototype::E0, NONE), Err(MechanismError::NotDriven("e")));
    // Three pairs and the screws are four coordinates, but the second screw is a fifth next to the extruder.
    assert_eq!(with(prototype::M1, [1, 0, 0, 0]), Ok(()));
    let crowd = Mechanism::of(&[[1, 0, 0, 0], [0, 1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], Z, NONE, E]);
    assert_eq!(crowd.check(), Err(MechanismError::TooManyGroups));
    let loose = Mechanism::of(&[[1, 1, 0, 0], [-1, -1, 0, 0], NONE, NONE, Z, Z, E]);
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

/// A stored row is one number.
#[test]
fn every_row_is_stored() {
    use corehbot::settings::rows::Field;
    let multiples = (1..=16).map(|times| [times, -times, 0, 0]);
    for row in all().flat_map(|(_, mechanism)| mechanism.rows).chain(multiples) {
        let mut read = NONE;
        assert!(read.set(&row.get()));
        assert_eq!(read, row);
    }
}
