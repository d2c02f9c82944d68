//! Pulleys: what a phase that has changed says of them.
//!
//! A rotor that skips changes no phase: it settles whole electrical turns away. A belt that jumps a tooth of a pulley
//! is a tooth ahead of the motor, and a motor makes 50 turns (of 200 full steps) a revolution. So a tooth adds 50 turns
//! over the teeth. With 20 teeth this is two and a half, which shows as a half. With 16 it is three and an eighth. With
//! 20 teeth and motors of 400 full steps it is five, which nothing shows. Anything else is a pulley that has slipped on
//! its shaft.
//!
//! The teeth follow from steps/mm, microsteps and the pitch of the belt.

use crate::kinematics::Residual;
use crate::port::Motor;
use crate::settings::Settings;
use crate::units::Mm;

/// Places of a sine table: an electrical turn of four full steps.
pub(in crate::machine) const TURN: i32 = 1024;

/// Pitch of the belt: that of GT2 belts, which every machine with such steps/mm has (docs/explanation/belt/phases.md).
const TOOTH: Mm = Mm::const_from_int(2);

/// Teeth by which belts jump at most. More than four of 16 teeth would add what fewer add.
const MOST_TEETH: i32 = 4;

/// Error of a phase against another one: five sixteenths of a full step, far above that of two findings.
const SLACK: i32 = 5 * TURN / 64;

/// A tooth that adds less than this to whole turns, a sixteenth of a full step, adds nothing that can be told.
const UNTOLD: i32 = TURN / 64;

/// What has happened to the pulleys of a residual.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Shift {
    /// Nothing that a phase shows.
    None,
    /// What a jump of so many teeth does.
    Teeth(i32),
    /// What no jump of teeth does: one has slipped on its shaft.
    Slipped,
}

/// The difference of two phases, at most half a turn.
pub(in crate::machine) fn difference(a: i32, b: i32) -> i32 {
    (a - b + TURN / 2).rem_euclid(TURN) - TURN / 2
}

/// What a jump of a tooth on each motor's pulley adds to the phase, at most half a turn.
fn added_by_a_tooth<'a>(s: &'a Settings, residual: &'a Residual) -> impl Iterator<Item = i32> + Clone + 'a {
    let of_motor = |(motor, times): (Motor, &i32)| {
        let places = TOOTH.saturating_mul_int(i64::from(TURN) / 4) * s.steps_per_mm(motor);
        let places: i64 = places.wrapping_round().to_num();
        difference((i64::from(*times) * places / i64::from(s.drivers.belt.microsteps.max(1))) as i32, 0)
    };
    Motor::ALL.into_iter().zip(residual).filter(|(_, times)| **times != 0).map(of_motor)
}

/// Whether a jumped tooth of some motor changes the phase.
pub(in crate::machine) fn shows_a_tooth(s: &Settings, residual: &Residual) -> bool {
    added_by_a_tooth(s, residual).any(|added| added.abs() >= UNTOLD)
}

/// What a phase that has changed by so much says.
pub(in crate::machine) fn shift_of(s: &Settings, residual: &Residual, by: i32) -> Shift {
    let added = added_by_a_tooth(s, residual);
    let jumps =
        (1..=MOST_TEETH).flat_map(|teeth| added.clone().map(move |added| (teeth, difference(teeth * added, 0))));
    // Where teeth add little, a phase must be met better.
    let gap = jumps.clone().map(|(_, added)| added.abs()).filter(|added| *added >= UNTOLD).min().unwrap_or(TURN);
    let slack = SLACK.min(gap / 4);
    let is_met = |added: i32| difference(by, added).abs() <= slack;
    if is_met(0) {
        return Shift::None;
    }
    let mut jumps = jumps;
    let met = jumps.find(|(_, added)| is_met(*added) || is_met(-*added));
    met.map_or(Shift::Slipped, |(teeth, _)| Shift::Teeth(teeth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{Mechanism, Residuals};
    use crate::units::StepsPerMm;

    /// A CoreH-bot with pulleys of so many teeth on motors of so many full steps.
    fn machine(teeth: i32, full_steps: i32) -> (Settings, Residual) {
        let mut s = Settings::prototype();
        let steps_per_mm = StepsPerMm::from_num(f64::from(16 * full_steps) / f64::from(2 * teeth));
        (s.axes.x.steps_per_mm, s.axes.y.steps_per_mm) = (steps_per_mm, steps_per_mm);
        let residual = *Residuals::new(&Mechanism::corehbot(), true).iter().next().unwrap();
        (s, residual)
    }

    #[test]
    fn phases_differ_by_half_a_turn_at_most() {
        for (a, b, expected) in [(5, 3, 2), (3, 1020, 7), (1020, 3, -7), (512, 0, -512), (511, 0, 511), (0, 0, 0)] {
            assert_eq!(difference(a, b), expected, "{a} {b}");
        }
    }

    /// 50 turns over the teeth, by hand.
    #[test]
    fn a_tooth_is_told_by_what_it_adds_to_whole_turns() {
        for (teeth, full_steps, jumped, by) in [
            (20, 200, 1, TURN / 2),
            (20, 200, 1, -TURN / 2),
            (16, 200, 1, TURN / 8),
            (16, 200, 1, -TURN / 8),
            (16, 200, 2, TURN / 4),
            (16, 200, 3, -3 * TURN / 8),
            // 2.7778 and 100/16 turns.
            (18, 200, 1, -228),
            (16, 400, 1, TURN / 4),
        ] {
            let (s, residual) = machine(teeth, full_steps);
            assert!(shows_a_tooth(&s, &residual));
            for error in [-20, 0, 20] {
                assert_eq!(shift_of(&s, &residual, by + error), Shift::Teeth(jumped), "{teeth} {full_steps} {by}");
                assert_eq!(shift_of(&s, &residual, error), Shift::None);
            }
        }
        let (s, residual) = machine(20, 400);
        assert!(!shows_a_tooth(&s, &residual));
    }

    #[test]
    fn what_no_tooth_adds_is_a_pulley_that_slipped() {
        for (teeth, full_steps, by) in
            [(20, 200, 256), (20, 200, -100), (20, 200, 400), (16, 200, 64), (16, 200, 192), (20, 400, 512)]
        {
            let (s, residual) = machine(teeth, full_steps);
            assert_eq!(shift_of(&s, &residual, by), Shift::Slipped, "{teeth} {full_steps} {by}");
        }
    }
}
