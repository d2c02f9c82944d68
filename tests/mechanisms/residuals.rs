//! Residuals: strains that motors can put on a belt, but that no position needs.

use super::machines::{COREXYZ, MACHINES, ROUND, UNEQUAL, settings};
use corehbot::kinematics::{Groups, Mechanism, Residual, Residuals};
use corehbot::motors::{Motor, MotorSet, per_motor, prototype};
use proptest::prelude::*;

fn residuals(mechanism: &Mechanism) -> Residuals {
    Residuals::new(mechanism, mechanism.can_circulate())
}

fn set(motors: &[Motor]) -> MotorSet {
    motors.iter().fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(*motor)))
}

/// Equation 11 of the paper, and Carlyle's A - B + C - D; both belts of a CoreXY with four motors; two motors of y.
#[test]
fn machines_have_as_many_as_they_have_motors_too_many() {
    let of = |belt: &[i32]| per_motor(belt, 0);
    for (name, mechanism) in MACHINES {
        let wanted: Vec<Residual> = match name {
            "corehbot" | "corehbot, three screws" | "corexyz" => vec![of(&[1, -1, 1, -1])],
            "awd corexy" => vec![of(&[1, 0, -1, 0]), of(&[0, 1, 0, -1])],
            "dual y" => vec![of(&[0, 1, 1])],
            _ => vec![],
        };
        let found: Vec<_> = residuals(&mechanism).iter().copied().collect();
        assert_eq!(found, wanted, "{name}");
        assert_eq!(residuals(&mechanism).is_empty(), wanted.is_empty(), "{name}");
    }
    assert!(residuals(&UNEQUAL).is_empty());
}

/// Two belts that are wired like the one of the CoreH-bot: turning all alike is a strain then.
#[test]
fn rows_do_not_tell_one_belt_from_two() {
    let found: Vec<_> = Residuals::new(&Mechanism::corehbot(), false).iter().copied().collect();
    assert_eq!(found, [per_motor(&[1, 0, 1, 0], 0), per_motor(&[0, 1, 0, 1], 0)]);
}

#[test]
fn only_a_closed_belt_over_all_its_motors_runs_round() {
    for (name, mechanism) in MACHINES {
        assert_eq!(mechanism.can_circulate(), ROUND.contains(&name), "{name}");
    }
    let circulating = Mechanism::corehbot().circulating();
    assert_eq!(circulating.rows, COREXYZ.rows, "a CoreXYZ whose lift is the belt");
    assert!(Groups::new(&circulating).is_redundant());
}

#[test]
fn who_can_pull_against_others_gets_power_alone() {
    let belt = [prototype::M1, prototype::M4, prototype::M8, prototype::M11];
    let one_by_one = |mechanism: &Mechanism| {
        let residuals = residuals(mechanism);
        let mut missing = mechanism.fitted();
        let mut turns = Vec::new();
        while !missing.is_empty() {
            turns.push(residuals.first_of(missing));
            missing = missing.without(residuals.first_of(missing));
        }
        turns
    };
    let corehbot = one_by_one(&Mechanism::corehbot());
    let screws = set(&[prototype::Z1, prototype::Z2, prototype::E0]);
    assert_eq!(corehbot, [set(&belt[..1]).with(screws), set(&belt[1..2]), set(&belt[2..3]), set(&belt[3..])]);
    let awd = MACHINES.iter().find(|(name, _)| *name == "awd corexy").unwrap().1;
    let (first, second) = (set(&[prototype::M1, prototype::M4]), set(&[prototype::M8, prototype::M11]));
    assert_eq!(one_by_one(&awd), [first.with(set(&[prototype::Z1, prototype::E0])), second]);
    let corexy = MACHINES.iter().find(|(name, _)| *name == "corexy").unwrap().1;
    assert_eq!(one_by_one(&corexy), [corexy.fitted()]);
}

#[test]
fn opponents_are_the_motors_of_the_same_belt() {
    let of = |mechanism: &Mechanism, motor| residuals(mechanism).with_opponents(MotorSet::of(motor));
    assert_eq!(of(&Mechanism::corehbot(), prototype::M8), prototype::BELT);
    assert_eq!(of(&Mechanism::corehbot(), prototype::Z1), MotorSet::of(prototype::Z1));
    let awd = MACHINES.iter().find(|(name, _)| *name == "awd corexy").unwrap().1;
    assert_eq!(of(&awd, prototype::M11), set(&[prototype::M4, prototype::M11]));
    assert_eq!(residuals(&awd).motors(), prototype::BELT);
}

#[test]
fn a_belt_is_closed_only_where_it_can_run_round() {
    for (name, mechanism) in MACHINES {
        let mut s = settings(mechanism);
        s.belt.is_closed = true;
        assert_eq!(s.check_machine().is_ok(), ROUND.contains(&name), "{name}");
    }
}

proptest! {
    /// No position and no circulation changes a residual.
    #[test]
    fn no_position_asks_for_one(at in prop::array::uniform3(-100_000i64..100_000), round in -100_000i64..100_000) {
        for (name, mechanism) in MACHINES {
            let [x, y, z] = at;
            let mut turned = mechanism.inverse([x, y, z, 0]);
            if mechanism.can_circulate() {
                turned.iter_mut().take(4).for_each(|turned| *turned += round);
            }
            for residual in residuals(&mechanism).iter() {
                let sum: i64 = residual.iter().zip(turned).map(|(times, turned)| i64::from(*times) * turned).sum();
                prop_assert_eq!(sum, 0, "{}", name);
            }
        }
    }
}
