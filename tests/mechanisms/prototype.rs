//! The prototype's mechanism against the paper's equations.

use crate::belt_equations::{BeltSteps, ToolSteps, forward, inverse, residual};
use corehbot::kinematics::{Group, Groups, Mechanism};
use corehbot::motors::{MotorSet, per_motor, prototype};

/// The paper's table of signs. Along +x motors 1 and 4 turn clockwise, 8 and 11 counter-clockwise. Along +y motors 1
/// and 11 turn counter-clockwise, 4 and 8 clockwise.
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
fn the_mechanism_says_what_the_equations_say() {
    let tool = ToolSteps { x: 7, y: 3, c: 0 };
    let BeltSteps { n1, n4, n8, n11 } = inverse(tool);
    assert_eq!(Mechanism::corehbot().inverse([tool.x, tool.y, 5, 2]), per_motor(&[n1, n4, n8, n11, 5, 5, 2], 0));
    assert_eq!(Mechanism::corehbot().check(), Ok(()));
}

#[test]
fn a_step_of_one_motor_alone_strains_the_belt() {
    let pair = MotorSet::of(prototype::M1).with(MotorSet::of(prototype::M8));
    let is_unstrained = |steps, forward| Mechanism::corehbot().is_unstrained(steps, forward);
    assert!(is_unstrained(pair, MotorSet::of(prototype::M8)));
    assert!(!is_unstrained(pair, pair));
    assert!(!is_unstrained(MotorSet::of(prototype::M8), pair));
    assert!(is_unstrained(prototype::Z, MotorSet::NONE));
    assert!(!is_unstrained(prototype::Z, MotorSet::of(prototype::Z1)));
    // A motor that is not there does not step.
    let mut bare = Mechanism::corehbot();
    bare.rows[prototype::E0.index()] = [0; 4];
    assert!(!bare.is_unstrained(prototype::E, prototype::E) && bare.is_unstrained(pair, MotorSet::of(prototype::M8)));
}

/// u = x + y leads with motor 11, v = x - y with motor 8.
#[test]
fn the_motors_come_in_two_pairs() {
    let groups = Groups::new(&Mechanism::corehbot());
    let of = |lead, row, with, against| Group { row, with, against, lead };
    let one = MotorSet::of;
    let expected = [
        of(prototype::M11, [1, 1, 0, 0], one(prototype::M11), one(prototype::M4)),
        of(prototype::M8, [1, -1, 0, 0], one(prototype::M8), one(prototype::M1)),
        of(prototype::Z1, [0, 0, 1, 0], prototype::Z, MotorSet::NONE),
        of(prototype::E0, [0, 0, 0, 1], prototype::E, MotorSet::NONE),
    ];
    assert_eq!(groups.iter().take(4).copied().collect::<Vec<_>>(), expected);
    assert!(!groups.is_redundant());
}
