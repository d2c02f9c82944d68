//! The CoreH-bot: four motors on one closed belt, coupled in two pairs.
//!
//! With x to the right, y to the back, counter-clockwise positive seen from above, and belt travel
//! `r * theta` in steps, the paper's kinematics (its equation 8 with the coupling of equation 12) read
//!
//! ```text
//! n1 = c - x + y      n4 = c - x - y      n8 = c + x - y      n11 = c + x + y
//! ```
//!
//! `c` is the circulation: all four motors turn alike, the belt runs round and the head stands still. The
//! fourth combination, the residual `n1 - n4 + n8 - n11`, is the one that a belt cannot follow: it must
//! stay 0 at every instant, or the motors strain the belt against each other. The four rows are orthogonal
//! and of equal length, so the way back is the transpose over four.
//!
//! With c held at 0 the motors move in two exact pairs, `n1 = -n8` and `n4 = -n11`: v = x - y drives 8
//! (forward) and 1 (backward), u = x + y drives 11 (forward) and 4 (backward). In CoreXY's words A is 11
//! and 4, B is 8 and 1.

use crate::motors::MOST_GROUPS;
use crate::port::{GroupSet, Motor, MotorSet};
use crate::units::Steps;

/// Belt travel of motors 1, 4, 8 and 11, in steps or any other unit of length.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BeltSteps {
    /// Motor 1.
    pub n1: i64,
    /// Motor 4.
    pub n4: i64,
    /// Motor 8.
    pub n8: i64,
    /// Motor 11.
    pub n11: i64,
}

/// Position of the tool and circulation of the belt, in the unit of [`BeltSteps`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ToolSteps {
    /// To the right.
    pub x: i64,
    /// To the back.
    pub y: i64,
    /// Belt circulation, counter-clockwise.
    pub c: i64,
}

/// What each motor must have turned for the tool to be there.
#[must_use]
pub const fn inverse(tool: ToolSteps) -> BeltSteps {
    let ToolSteps { x, y, c } = tool;
    BeltSteps { n1: c - x + y, n4: c - x - y, n8: c + x - y, n11: c + x + y }
}

/// Four times where the tool is, given what the motors turned: exact for any integers, also for steps that
/// no position of the tool can explain (their [`residual`] is not 0).
#[must_use]
pub const fn forward(belt: BeltSteps) -> ToolSteps {
    let BeltSteps { n1, n4, n8, n11 } = belt;
    ToolSteps { x: -n1 - n4 + n8 + n11, y: n1 - n4 - n8 + n11, c: n1 + n4 + n8 + n11 }
}

/// The strain that the motors put into the belt; 0 in a sound machine.
#[must_use]
pub const fn residual(belt: BeltSteps) -> i64 {
    belt.n1 - belt.n4 + belt.n8 - belt.n11
}

/// Whether steps taken in one instant leave the belt as it was: motors 1 and 8 mirror each other, 4 and 11
/// too, and the residual does not change.
#[must_use]
pub const fn is_unstrained(steps: MotorSet, forward: MotorSet) -> bool {
    let belt = BeltSteps {
        n1: signed_step(Motor::M1, steps, forward),
        n4: signed_step(Motor::M4, steps, forward),
        n8: signed_step(Motor::M8, steps, forward),
        n11: signed_step(Motor::M11, steps, forward),
    };
    belt.n1 == -belt.n8 && belt.n4 == -belt.n11 && residual(belt) == 0
}

const fn signed_step(motor: Motor, steps: MotorSet, forward: MotorSet) -> i64 {
    match (steps.has(motor), forward.has(motor)) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    }
}

/// Motors that always step in the same instant, because one coordinate drives them all.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Group {
    /// The coordinate as a sum of x, y, z and e, each taken this many times.
    pub row: [i8; 4],
    /// Motors that turn forward when the coordinate grows.
    pub with: MotorSet,
    /// Motors that turn backward when the coordinate grows.
    pub against: MotorSet,
    /// The motor whose count is the coordinate.
    pub lead: Motor,
}

impl Group {
    /// The group's coordinate at a position in steps of x, y, z and e.
    #[must_use]
    pub fn coordinate(&self, position: [Steps; 4]) -> Steps {
        let mut sum = Steps::ZERO;
        for (times, steps) in self.row.iter().zip(position) {
            sum = sum.wrapping_add(steps.wrapping_mul_int(i64::from(*times)));
        }
        sum
    }
}

/// The count of steps of a group at a coordinate: the nearest whole step, halves upwards.
#[must_use]
pub const fn count_at(coordinate: Steps) -> i32 {
    const HALF: i64 = 1 << 31;
    (coordinate.to_bits().wrapping_add(HALF) >> 32) as i32
}

/// All motors of the machine: u = x + y, v = x - y, z and e.
pub const GROUPS: [Group; MOST_GROUPS] = [
    Group { row: [1, 1, 0, 0], with: MotorSet::of(Motor::M11), against: MotorSet::of(Motor::M4), lead: Motor::M11 },
    Group { row: [1, -1, 0, 0], with: MotorSet::of(Motor::M8), against: MotorSet::of(Motor::M1), lead: Motor::M8 },
    Group { row: [0, 0, 1, 0], with: MotorSet::Z, against: MotorSet::NONE, lead: Motor::Z1 },
    Group { row: [0, 0, 0, 1], with: MotorSet::E, against: MotorSet::NONE, lead: Motor::E0 },
];

/// The steps of each motor, given those of the groups.
#[must_use]
pub fn motor_counts(groups: [i32; GROUPS.len()]) -> [i32; Motor::ALL.len()] {
    Motor::ALL.map(|motor| {
        let count = |(group, count): (&Group, i32)| match (group.with.has(motor), group.against.has(motor)) {
            (true, _) => Some(count),
            (_, true) => Some(count.wrapping_neg()),
            _ => None,
        };
        GROUPS.iter().zip(groups).find_map(count).unwrap_or_default()
    })
}

/// Sets of groups that there are.
const SETS: usize = 1 << GROUPS.len();

/// For every set of groups the motors that turn forward if these groups' coordinates grow and the others' fall; or
/// with `all` the motors of these groups.
const fn motors_of_sets(all: bool) -> [MotorSet; SETS] {
    let mut sets = [MotorSet::NONE; SETS];
    let mut set = 0;
    while set < SETS {
        let mut group = 0;
        while group < GROUPS.len() {
            let Group { with, against, .. } = GROUPS[group];
            let is_in = set >> group & 1 == 1;
            let motors = match (all, is_in) {
                (true, true) => with.with(against),
                (true, false) => MotorSet::NONE,
                (false, true) => with,
                (false, false) => against,
            };
            sets[set] = sets[set].with(motors);
            group += 1;
        }
        set += 1;
    }
    sets
}

/// The motors of these groups.
#[must_use]
pub const fn motors(groups: GroupSet) -> MotorSet {
    const MOTORS: [MotorSet; SETS] = motors_of_sets(true);
    MOTORS[groups.0 as usize % SETS]
}

/// The motors that turn forward if the coordinates of these groups grow and those of the others fall.
#[must_use]
pub const fn forward_motors(groups: GroupSet) -> MotorSet {
    const FORWARD: [MotorSet; SETS] = motors_of_sets(false);
    FORWARD[groups.0 as usize % SETS]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's table of signs: +x turns 1 and 4 clockwise, 8 and 11 counter-clockwise; +y turns 1 and
    /// 11 counter-clockwise, 4 and 8 clockwise.
    #[test]
    fn ten_millimetres_turn_the_motors_as_the_paper_says() {
        let right = inverse(ToolSteps { x: 800, y: 0, c: 0 });
        assert_eq!(right, BeltSteps { n1: -800, n4: -800, n8: 800, n11: 800 });
        let back = inverse(ToolSteps { x: 0, y: 800, c: 0 });
        assert_eq!(back, BeltSteps { n1: 800, n4: -800, n8: -800, n11: 800 });
        let round = inverse(ToolSteps { x: 0, y: 0, c: 800 });
        assert_eq!(round, BeltSteps { n1: 800, n4: 800, n8: 800, n11: 800 });
    }

    #[test]
    fn forward_undoes_inverse_and_the_belt_is_never_strained() {
        for x in -20..20 {
            for y in -20..20 {
                for c in -3..3 {
                    let belt = inverse(ToolSteps { x, y, c });
                    assert_eq!(forward(belt), ToolSteps { x: 4 * x, y: 4 * y, c: 4 * c });
                    assert_eq!(residual(belt), 0);
                }
            }
        }
    }

    #[test]
    fn a_motor_that_slips_shows_in_the_residual() {
        let mut belt = inverse(ToolSteps { x: 100, y: 50, c: 0 });
        belt.n4 += 4;
        assert_eq!(residual(belt), -4);
    }

    #[test]
    fn a_step_of_one_motor_alone_strains_the_belt() {
        let pair = MotorSet::of(Motor::M1).with(MotorSet::of(Motor::M8));
        assert!(is_unstrained(pair, MotorSet::of(Motor::M8)));
        assert!(!is_unstrained(pair, pair));
        assert!(!is_unstrained(MotorSet::of(Motor::M8), pair));
        assert!(is_unstrained(MotorSet::Z, MotorSet::NONE));
    }

    #[test]
    fn the_groups_say_what_the_equations_say() {
        let tool = ToolSteps { x: 7, y: 3, c: 0 };
        let belt = inverse(tool);
        let turned = |motor: Motor| {
            GROUPS.iter().find_map(|g| {
                let coordinate = i64::from(g.row[0]) * tool.x + i64::from(g.row[1]) * tool.y;
                if g.with.has(motor) {
                    Some(coordinate)
                } else if g.against.has(motor) {
                    Some(-coordinate)
                } else {
                    None
                }
            })
        };
        assert_eq!(turned(Motor::M1), Some(belt.n1));
        assert_eq!(turned(Motor::M4), Some(belt.n4));
        assert_eq!(turned(Motor::M8), Some(belt.n8));
        assert_eq!(turned(Motor::M11), Some(belt.n11));
    }
}
