//! Diagnosis: which motor has skipped, from where the switches are met and from the residual.
//!
//! A rotor that skips settles an electrical turn of four full steps beside its field. Of a motor whose row is (x, y) the tool goes aside
//! in the direction of that row, and the residual changes by the motor's part of it. The signs of the three differ for every motor and
//! either direction; how far the tool goes aside depends on where it is, and is less than half the skip.

use crate::kinematics::{Mechanism, Residual};
use crate::machine::answers::belt_answer::Diagnosis;
use crate::motors::Motor;

/// Full steps of an electrical turn of any two-phase motor.
pub(in crate::machine) const FULL_STEPS_A_TURN: i32 = 4;

/// What was found, in steps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Touched {
    /// How far beside its place each switch was met: the tool stands so far beside where the steps say.
    pub aside: [i32; 2],
    /// What the rotors strain the belt by: the sum of the residual.
    pub residual: i32,
}

/// Which way a tool is aside along x and y, if it is, given the microsteps of a full step. What is less than three sixteenths of one may
/// be friction and the switch; the least that a skip does is twice that (at the corner of the reach; `boards/sim/tests/belt`).
pub(in crate::machine) fn ways_aside(mechanism: &Mechanism, aside: [i32; 2], full_step: i32) -> [i32; 2] {
    of_motors(mechanism, aside).map(|steps| if steps.abs() * 16 >= 3 * full_step { steps.signum() } else { 0 })
}

/// Steps of x and y as those of the motors that turn farthest for them.
fn of_motors(mechanism: &Mechanism, [x, y]: [i32; 2]) -> [i32; 2] {
    [x.saturating_mul(mechanism.most_times(0).into()), y.saturating_mul(mechanism.most_times(1).into())]
}

/// Says what has happened, given the microsteps of a full step.
pub(in crate::machine) fn diagnose(
    mechanism: &Mechanism,
    residual: &Residual,
    touched: Touched,
    full_step: i32,
) -> Diagnosis {
    let turn = FULL_STEPS_A_TURN * full_step;
    let signs = ways_aside(mechanism, touched.aside, full_step);
    let [x, y] = signs;
    let turns = (2 * touched.residual + turn).div_euclid(2 * turn);
    if (touched.residual - turns * turn).abs() > full_step {
        return Diagnosis::Several;
    }
    match (turns, x, y) {
        (0, 0, 0) => return Diagnosis::Nothing,
        (0, ..) => return Diagnosis::Alike,
        (-1 | 1, ..) => {}
        _ => return Diagnosis::Several,
    }
    let is_one_skip = of_motors(mechanism, touched.aside).iter().all(|aside| 2 * aside.abs() <= turn);
    let motors = Motor::ALL.into_iter().zip(residual).zip(mechanism.rows);
    let mut explaining = motors.filter_map(|((motor, times), [its_x, its_y, ..])| {
        // The way that this motor must have gone to strain the belt so.
        let way = turns * times.signum();
        let explains = way != 0 && [its_x, its_y].map(|row| i32::from(row.signum()) * way) == signs;
        explains.then_some(Diagnosis::Skip { motor, full_steps: way * FULL_STEPS_A_TURN })
    });
    match (explaining.next(), explaining.next()) {
        (Some(skip), None) if is_one_skip => skip,
        _ => Diagnosis::Several,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::Residuals;

    const FULL_STEP: i32 = 16;

    fn corehbot(aside: [i32; 2], residual: i32) -> Diagnosis {
        let mechanism = Mechanism::corehbot();
        let residuals = Residuals::new(&mechanism, true);
        diagnose(&mechanism, residuals.iter().next().unwrap(), Touched { aside, residual }, FULL_STEP)
    }

    #[test]
    fn each_skip_of_the_table_names_its_motor() {
        // By a turn forward: motor, its way in x and y, its part of the residual (equations 8 to 11 of the paper).
        for (motor, x, y, part) in
            [(Motor::M1, -1, 1, 1), (Motor::M4, -1, -1, -1), (Motor::M8, 1, -1, 1), (Motor::M11, 1, 1, -1)]
        {
            for way in [-1, 1] {
                let found = corehbot([7 * x * way, 25 * y * way], 64 * part * way + 5);
                assert_eq!(found, Diagnosis::Skip { motor, full_steps: 4 * way });
            }
        }
    }

    /// Where motors turn four and five steps for a step of an axis, a step of it is a long way.
    #[test]
    fn a_tool_is_aside_by_steps_of_motors() {
        let mut mechanism = Mechanism::corehbot();
        assert_eq!(ways_aside(&mechanism, [2, -3], FULL_STEP), [0, -1]);
        mechanism.rows = mechanism.rows.map(|[x, y, z, e]| [4 * x, 5 * y, z, e]);
        assert_eq!(ways_aside(&mechanism, [1, -1], FULL_STEP), [1, -1]);
        assert_eq!(ways_aside(&mechanism, [0, 0], FULL_STEP), [0, 0]);
    }

    #[test]
    fn what_no_single_skip_explains_has_no_name() {
        assert_eq!(corehbot([1, -1], 3), Diagnosis::Nothing);
        assert_eq!(corehbot([25, 1], -3), Diagnosis::Alike);
        // Between two turns; two turns; a way that is too long; a tool that stands.
        for (aside, residual) in [([7, 7], 30), ([14, 14], 128), ([80, 80], -64), ([0, 0], 64), ([7, 0], 64)] {
            assert_eq!(corehbot(aside, residual), Diagnosis::Several, "{aside:?} {residual}");
        }
    }
}
