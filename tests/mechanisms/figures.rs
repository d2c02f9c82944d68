//! Figures of a mechanism and of its groups, as other rooms ask for them.

use super::machines::{E, NONE, UNEQUAL, Z};
use corehbot::kinematics::{Group, Groups, Mechanism, MechanismError, Residuals, Row, motors_in};
use corehbot::motors::{GroupSet, MOST_GROUPS, Motor, MotorSet};
use corehbot::units::Steps;

const X: Row = [1, 0, 0, 0];
const Y: Row = [0, 1, 0, 0];

#[test]
fn a_group_moves_the_tool_unless_it_moves_filament() {
    let group = |row| Group { row, with: MotorSet::ALL, against: MotorSet::NONE, lead: Motor::ALL[0] };
    let rows = [NONE, X, Y, Z, E, [1, 1, 0, 0], [0, -1, 1, 0]];
    assert_eq!(rows.map(|row| group(row).is_tool()), [false, true, true, true, false, true, true]);
    assert_eq!(rows.map(|row| group(row).axis()), [None, Some(0), Some(1), Some(2), Some(3), None, None]);
}

/// All sets of four rows, of which three hold the tool.
#[test]
fn no_position_has_a_strain() {
    let rows: Vec<Row> =
        (0..27).map(|n: i8| [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1, 0]).filter(|row| *row > NONE).collect();
    let mut tried = 0;
    for (a, b, c, d) in (0..13)
        .flat_map(|a| (0..a).flat_map(move |b| (0..b).map(move |c| (a, b, c))))
        .flat_map(|(a, b, c)| (0..c).map(move |d| (a, b, c, d)))
    {
        let mechanism = Mechanism::of(&[rows[a], rows[b], rows[c], rows[d], NONE, NONE, E]);
        if mechanism.check().is_err() {
            continue;
        }
        let groups = Groups::new(&mechanism);
        let constraint = groups.constraint().unwrap();
        for axis in 0..4 {
            let sum: i32 = groups.iter().zip(constraint).map(|(group, times)| i32::from(group.row[axis]) * times).sum();
            assert_eq!(sum, 0, "{:?}: {constraint:?}", mechanism.rows);
        }
        assert!(constraint.iter().any(|times| *times != 0), "{:?}", mechanism.rows);
        tried += 1;
    }
    assert!(tried > 500, "{tried}");
}

#[test]
fn a_trim_step_turns_one_motor() {
    let groups = Groups::new(&Mechanism::trimming());
    for motor in Motor::ALL {
        let coupling = groups.trim_coupling(motor);
        let turned: Vec<_> = (0..MOST_GROUPS).map(|number| coupling.motors(GroupSet(1 << number))).collect();
        let is_z = |number: usize| groups.iter().nth(number).is_some_and(|group| group.row == Z);
        let wanted = |number| if is_z(number) { MotorSet::of(motor) } else { MotorSet::NONE };
        assert_eq!(turned, (0..MOST_GROUPS).map(wanted).collect::<Vec<_>>());
    }
}

#[test]
fn a_motor_has_its_first_axis() {
    let mechanism = Mechanism::of(&[X, [0, 1, 1, 0], Z, NONE, E, E]);
    let axes = Motor::ALL.map(|motor| mechanism.axis_of(motor));
    assert_eq!(axes, [Some(0), Some(1), Some(2), None, Some(3), Some(3), None, None]);
    let fitted = Groups::new(&mechanism).fitted();
    assert!(Motor::ALL.into_iter().zip(axes).all(|(motor, axis)| fitted.has(motor) == axis.is_some()), "{fitted:?}");
    assert_eq!(mechanism.extruder(), Some(Motor::ALL[4]));
    assert_eq!(Mechanism::of(&[X, Y, Z]).extruder(), None);
    assert_eq!([0, 1, 2, 3].map(|axis| UNEQUAL.most_times(axis)), [5, 5, 1, 1]);
    assert_eq!(Mechanism::of(&[]).most_times(0), 0);
}

/// Two motors push the same filament, so their counts are averaged.
#[test]
fn two_motors_of_the_filament_agree() {
    let mechanism = Mechanism::of(&[X, Y, Z, E, E]);
    let position = [7, -3, 2, 5];
    let back = mechanism.forward_kinematics().unwrap();
    assert_eq!(back.position(&mechanism.inverse(position)), position.map(Steps::from_num));
}

#[test]
fn an_illegal_row_is_named() {
    let refused = |rows: &[Row]| Mechanism::of(rows).check().unwrap_err();
    let [second, third] = [1, 2].map(|index| Motor::ALL[index]);
    let cases = [
        (refused(&[X, [0, 1, 2, 0], Z, E]), MechanismError::Entry(second), Some(second)),
        (refused(&[X, Y, [0, 0, 1, 1], E]), MechanismError::Mixed(third), Some(third)),
        (refused(&[[2, 0, 0, 0], Y, Z, E]), MechanismError::Multiples, None),
        (refused(&[X, Y, E]), MechanismError::NotDriven("z"), None),
        (refused(&[[1, 1, 0, 0], [1, 1, 0, 0], Z, E]), MechanismError::Loose, None),
    ];
    for (found, wanted, motor) in cases {
        assert_eq!((found, found.motor()), (wanted, motor));
        assert!(!found.to_string().is_empty());
    }
}

/// One other motor of the four on the closed belt has to give way.
#[test]
fn a_motor_turns_alone_if_another_is_free() {
    let residuals = Residuals::new(&Mechanism::corehbot(), true);
    for motor in [0, 1, 2, 3].map(|index| Motor::ALL[index]) {
        let free = residuals.to_free(motor, MotorSet::NONE);
        assert!(!free.has(motor) && free.iter().count() == 1, "{free:?}");
        assert!(residuals.without(free).iter().all(|residual| !motors_in(residual).has(motor)));
    }
}
