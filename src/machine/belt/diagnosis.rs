//! Diagnosis: which motor has skipped, from the switches and the residual.
//!
//! A rotor that skips settles an electrical turn of four full steps away from its field. If the motor's row is (x, y),
//! the tool is displaced in the direction of this row, and the residual changes by the motor's share. The three signs
//! differ for every motor and direction. The displacement depends on the tool's place and is less than half the skip.

use crate::kinematics::{Mechanism, Residual};
use crate::motors::Motor;

/// Full steps of an electrical turn of any two-phase motor.
pub(in crate::machine) const FULL_STEPS_A_TURN: i32 = 4;

/// How the motors of one belt have changed since they were aligned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Diagnosis {
    /// Nothing changed: the switches are in place, and no motor strains the belt.
    Nothing,
    /// The tool is elsewhere, the motors agree, and no skip moves it so far.
    Aside,
    /// The tool is elsewhere, and the motors agree: some have skipped alike, or a switch has moved.
    Alike,
    /// The belt is strained as no skip does it, and nothing else is wrong.
    Moved,
    /// One motor has skipped, by this many full steps.
    Skip { motor: Motor, full_steps: i32 },
    /// More than one skip, or a state that skips cannot explain.
    Several,
}

impl Diagnosis {
    /// Of two residuals' diagnoses, the one that explains more.
    pub const fn graver(self, other: Self) -> Self {
        if self.rank() > other.rank() { self } else { other }
    }

    const fn rank(self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::Aside => 1,
            Self::Alike => 2,
            Self::Moved => 3,
            Self::Skip { .. } => 4,
            Self::Several => 5,
        }
    }
}

/// The measurements, in steps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Touched {
    /// The distance of each switch from its place: the tool's displacement from the step counts.
    pub aside: [i32; 2],
    /// The residual of the rotors: their strain on the belt.
    pub residual: i32,
}

/// Direction of the tool's displacement along x and y, or 0, given the microsteps of a full step. Less than three
/// sixteenths of a full step may be friction and the switch. A skip does at least twice that (at the corner of the
/// reach; `sim/board/tests/belt`).
pub(in crate::machine) fn ways_aside(mechanism: &Mechanism, aside: [i32; 2], full_step: i32) -> [i32; 2] {
    of_motors(mechanism, aside).map(|steps| if steps.abs() * 16 >= 3 * full_step { steps.signum() } else { 0 })
}

/// Steps of x and y as steps of the motors that turn farthest for them.
fn of_motors(mechanism: &Mechanism, [x, y]: [i32; 2]) -> [i32; 2] {
    [x.saturating_mul(mechanism.most_times(0).into()), y.saturating_mul(mechanism.most_times(1).into())]
}

/// Whether motors that skip together, and strain nothing, move the tool so far: by half turns along x and y, the effect
/// of a pair. Belts give way, and switches have a size: half a full step beside that.
fn is_by_skips(mechanism: &Mechanism, aside: [i32; 2], full_step: i32) -> bool {
    let half_turn = FULL_STEPS_A_TURN * full_step / 2;
    let each = of_motors(mechanism, aside).map(|steps| {
        let halves = (2 * steps + half_turn).div_euclid(2 * half_turn);
        (halves, 2 * (steps - halves * half_turn).abs() <= full_step)
    });
    each.iter().all(|(_, is_near)| *is_near) && each.iter().any(|(halves, _)| *halves != 0)
}

/// The same if the phase of the residual says that a pulley has moved on the belt or its shaft. Without a whole turn of
/// strain, no skip is needed to move the tool by up to half of the strain. But a tooth that jumped while motors had
/// power is two turns or more, and no belt bears them: motors have skipped (`has_skipped`).
pub(in crate::machine) fn with_moved_pulley(
    mechanism: &Mechanism,
    found: Diagnosis,
    touched: Touched,
    full_step: i32,
    has_skipped: bool,
) -> Diagnosis {
    let turn = FULL_STEPS_A_TURN * full_step;
    let strain = touched.residual.abs();
    let is_alone = 4 * strain <= 3 * turn
        && of_motors(mechanism, touched.aside).iter().all(|aside| 2 * aside.abs() <= strain + full_step / 2);
    if !has_skipped && (is_alone || found == Diagnosis::Nothing) { Diagnosis::Moved } else { Diagnosis::Several }
}

/// The diagnosis, given the microsteps of a full step.
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
        (0, ..) if is_by_skips(mechanism, touched.aside, full_step) => return Diagnosis::Alike,
        (0, ..) => return Diagnosis::Aside,
        (-1 | 1, ..) => {}
        _ => return Diagnosis::Several,
    }
    let is_one_skip = of_motors(mechanism, touched.aside).iter().all(|aside| 2 * aside.abs() <= turn);
    let motors = Motor::ALL.into_iter().zip(residual).zip(mechanism.rows);
    let mut explaining = motors.filter_map(|((motor, times), [its_x, its_y, ..])| {
        // The direction in which this motor must have skipped to cause this strain.
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
    use crate::motors::prototype;

    const FULL_STEP: i32 = 16;

    fn corehbot(aside: [i32; 2], residual: i32) -> Diagnosis {
        let mechanism = Mechanism::corehbot();
        let residuals = Residuals::new(&mechanism, true);
        diagnose(&mechanism, residuals.iter().next().unwrap(), Touched { aside, residual }, FULL_STEP)
    }

    #[test]
    fn each_skip_of_the_table_names_its_motor() {
        // A skip of one turn forward: motor, its direction in x and y, its part of the residual (equations 8 to 11 of
        // the paper).
        for (motor, x, y, part) in [
            (prototype::M1, -1, 1, 1),
            (prototype::M4, -1, -1, -1),
            (prototype::M8, 1, -1, 1),
            (prototype::M11, 1, 1, -1),
        ] {
            for way in [-1, 1] {
                let found = corehbot([7 * x * way, 25 * y * way], 64 * part * way + 5);
                assert_eq!(found, Diagnosis::Skip { motor, full_steps: 4 * way });
            }
        }
    }

    /// Where motors turn four and five steps for a step of an axis, one axis step is a large displacement.
    #[test]
    fn a_tool_is_aside_by_steps_of_motors() {
        let mut mechanism = Mechanism::corehbot();
        assert_eq!(ways_aside(&mechanism, [2, -3], FULL_STEP), [0, -1]);
        mechanism.rows = mechanism.rows.map(|[x, y, z, e]| [4 * x, 5 * y, z, e]);
        assert_eq!(ways_aside(&mechanism, [1, -1], FULL_STEP), [1, -1]);
        assert_eq!(ways_aside(&mechanism, [0, 0], FULL_STEP), [0, 0]);
    }

    #[test]
    fn a_pulley_that_moved_explains_strain_without_a_skip() {
        let mechanism = Mechanism::corehbot();
        let of = |found, aside, residual, has_skipped| {
            with_moved_pulley(&mechanism, found, Touched { aside, residual }, FULL_STEP, has_skipped)
        };
        assert_eq!(of(Diagnosis::Several, [0, 1], -32, false), Diagnosis::Moved);
        assert_eq!(of(Diagnosis::Nothing, [0, 0], 8, false), Diagnosis::Moved);
        assert_eq!(of(Diagnosis::Several, [27, 5], -32, false), Diagnosis::Several);
        assert_eq!(of(Diagnosis::Several, [11, 5], -32, true), Diagnosis::Several);
    }

    #[test]
    fn what_no_single_skip_explains_has_no_name() {
        assert_eq!(corehbot([1, -1], 3), Diagnosis::Nothing);
        assert_eq!(corehbot([25, 1], -3), Diagnosis::Alike);
        assert_eq!(corehbot([-64, 33], -3), Diagnosis::Alike);
        // Two steps are no skip of anything.
        for aside in [[4, 1], [1, 5], [0, 11], [16, 16], [32, 16]] {
            assert_eq!(corehbot(aside, 3), Diagnosis::Aside, "{aside:?}");
        }
        // Between two turns; two turns; a displacement that is too large; a tool at its place.
        for (aside, residual) in [([7, 7], 30), ([14, 14], 128), ([80, 80], -64), ([0, 0], 64), ([7, 0], 64)] {
            assert_eq!(corehbot(aside, residual), Diagnosis::Several, "{aside:?} {residual}");
        }
    }
}
