//! Together: motors that hold one coordinate have made the same steps, and no belt is strained.
//!
//! After an event in which whole groups step, each of its motors in its own direction, groups that were together still
//! are. So their counts are compared only after other events. On a closed belt the same holds for the residuals of the
//! belt, and for events that change none of them.

use super::Findings;
use crate::counts::{Counts, HALF, STEPS, places};
use crate::limits::Limits;
use corehbot::kinematics::{Group, Groups, Residual, Residuals};
use corehbot::motors::{MOST_GROUPS, MOTORS, Motor, MotorName, MotorSet};
use corehbot::settings::Settings;

/// Motors that may turn alone.
fn trims(s: &Settings, limits: &Limits) -> MotorSet {
    let belt = if limits.trims { Residuals::new(&s.mechanism, s.belt.is_closed).motors() } else { MotorSet::NONE };
    let screws = s.screw_motors().into_iter().filter(|_| limits.levels);
    screws.fold(belt, |motors, screw| motors.with(MotorSet::of(screw)))
}

/// The mechanism's demands on the counts.
pub(super) struct Together {
    /// Names of the motors.
    names: [MotorName; MOTORS],
    groups: Groups,
    whole: Whole,
    /// The constraint from [`Groups::constraint`].
    constraint: Option<[i32; MOST_GROUPS]>,
    /// The strain of a closed belt.
    residuals: Option<BeltResiduals>,
    /// Motors that may be trimmed, and how far each was trimmed: a motor that steps alone in an instant.
    trims: MotorSet,
    trimmed: [i64; MOTORS],
    is_consistent: bool,
}

impl Together {
    pub fn new(s: &Settings, limits: &Limits) -> Self {
        let groups = Groups::new(&s.mechanism);
        Self {
            names: s.motor_names,
            whole: Whole::new(&groups),
            constraint: groups.constraint(),
            groups,
            residuals: limits.circulates.then(|| BeltResiduals::new(Residuals::new(&s.mechanism, true))),
            trims: trims(s, limits),
            trimmed: [0; MOTORS],
            is_consistent: true,
        }
    }

    /// One instant in which `steps` have moved, and the counts after it.
    #[inline]
    pub fn event(&mut self, findings: &mut Findings, tick: u64, steps: MotorSet, forward: MotorSet, counts: &Counts) {
        let may_trim = steps.intersects(self.trims);
        if may_trim {
            self.note_trim(steps, forward);
        }
        let is_plain = match &self.residuals {
            Some(belt) => !may_trim && belt.keeps(steps, forward),
            None => self.constraint.is_none() && self.whole.is_whole(steps, forward),
        };
        if !self.is_consistent || !is_plain {
            self.check(findings, tick, steps, counts);
        }
    }

    /// At the end: a constraint's sum with its bound, and the greatest residual.
    pub fn at_rest(&self, counts: &Counts) -> (Option<(i64, i64)>, i64) {
        let counts = self.untrimmed(counts);
        (self.strain(&counts), self.residual(&counts))
    }

    fn note_trim(&mut self, steps: MotorSet, forward: MotorSet) {
        for (motor, trimmed) in Motor::ALL.into_iter().zip(&mut self.trimmed) {
            if self.trims.has(motor) && steps == MotorSet::of(motor) {
                *trimmed += if forward.has(motor) { 1 } else { -1 };
            }
        }
    }

    /// The steps of each motor without its trims.
    fn untrimmed(&self, counts: &Counts) -> Counts {
        std::array::from_fn(|motor| counts[motor] - self.trimmed[motor])
    }

    #[cold]
    fn check(&mut self, findings: &mut Findings, tick: u64, steps: MotorSet, counts: &Counts) {
        let counts = self.untrimmed(counts);
        let is_consistent = match &self.residuals {
            // Four counts are rounded to half a step each.
            Some(_) => self.residual(&counts) <= 2,
            None => {
                let is_strained = self.strain(&counts).is_some_and(|(sum, most)| sum.abs() > most);
                // Groups that were together and rest still are.
                let may_differ = |group: &&Group| !self.is_consistent || group.motors().intersects(steps);
                let mut groups = self.groups.iter().filter(may_differ);
                !is_strained && groups.all(|group| is_together(group, &counts))
            }
        };
        // Once per episode: a lost step strains the machine until the end.
        if self.is_consistent && !is_consistent {
            let counts = self.names.iter().zip(counts).filter(|(name, _)| !name.is_none());
            let counts = counts.map(|(name, count)| format!(" {name} {count}"));
            let counts: String = counts.collect();
            findings.add(tick, || format!("motors out of step:{counts}"));
        }
        self.is_consistent = is_consistent;
    }

    /// The greatest residual of a belt that may run round, in steps.
    fn residual(&self, counts: &Counts) -> i64 {
        let residuals = self.residuals.iter().flat_map(|belt| belt.residuals.iter());
        residuals.map(|residual| total(residual, counts).abs()).max().unwrap_or_default()
    }

    /// The sum of counts that no position changes, if the mechanism has one, and its bound by rounding.
    fn strain(&self, counts: &Counts) -> Option<(i64, i64)> {
        let constraint = self.constraint?;
        let parts =
            self.groups.iter().zip(constraint).map(|(group, times)| i64::from(times) * counts[group.lead.index()]);
        let most = constraint.iter().map(|times| i64::from(times.abs())).sum::<i64>() / 2;
        Some((parts.sum(), most))
    }
}

/// The sum of a residual at these counts.
fn total(residual: &[i32], counts: &[i64]) -> i64 {
    residual.iter().zip(counts).map(|(times, count)| i64::from(*times) * count).sum()
}

/// The residuals of a closed belt.
struct BeltResiduals {
    residuals: Residuals,
    /// What an event adds to each of them, for each half of the motors, by the places of [`STEPS`].
    events: Vec<[[i64; STEPS.len()]; 2]>,
}

impl BeltResiduals {
    fn new(residuals: Residuals) -> Self {
        let half = |residual: &Residual, half: usize| STEPS.map(|steps| total(&residual[half * HALF..], &steps));
        let events = residuals.iter().map(|residual| [half(residual, 0), half(residual, 1)]).collect();
        Self { residuals, events }
    }

    /// Whether an event changes none of them.
    #[inline]
    fn keeps(&self, steps: MotorSet, forward: MotorSet) -> bool {
        let [low, high] = places(steps, forward);
        self.events.iter().all(|halves| halves[0][low] + halves[1][high] == 0)
    }
}

/// Which sets of motors are whole groups.
struct Whole {
    /// By the set: no group has motors both in it and out of it.
    sets: Box<[bool; 1 << MOTORS]>,
    /// The motors that go forward with their group.
    with: MotorSet,
}

impl Whole {
    fn new(groups: &Groups) -> Self {
        let is_whole =
            |set| groups.iter().map(|group| group.motors().0).all(|motors| set & motors == 0 || set & motors == motors);
        let with = groups.iter().fold(MotorSet::NONE, |motors, group| motors.with(group.with));
        Self { sets: Box::new(std::array::from_fn(|set| is_whole(set as u8))), with }
    }

    /// Whether each group rests, or all of it steps and each motor in its own direction.
    #[inline]
    fn is_whole(&self, steps: MotorSet, forward: MotorSet) -> bool {
        // Motors of groups that go back.
        let back = steps.0 & (forward.0 ^ self.with.0);
        self.sets[usize::from(steps.0)] && self.sets[usize::from(back)]
    }
}

/// Whether the motors of a group have made the same steps, and motors in the opposite direction the opposite ones.
fn is_together(group: &Group, counts: &Counts) -> bool {
    let at = counts[group.lead.index()];
    // A loop, because it runs at every event.
    for (motor, count) in Motor::ALL.into_iter().zip(counts) {
        if (group.with.has(motor) && *count != at) || (group.against.has(motor) && *count != -at) {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_groups_are_those_whose_motors_all_rest_or_all_step_in_their_own_direction() {
        let groups = Groups::new(&Settings::prototype().mechanism);
        let whole = Whole::new(&groups);
        for (steps, forward) in (0..=u8::MAX).flat_map(|steps| (0..=u8::MAX).map(move |forward| (steps, forward))) {
            let is_whole = groups.iter().all(|group| {
                let (moved, ahead) = (steps & group.motors().0, forward & group.motors().0);
                let in_its_direction = [group.with.0, group.against.0].contains(&ahead);
                moved == 0 || (moved == group.motors().0 && in_its_direction)
            });
            assert_eq!(whole.is_whole(MotorSet(steps), MotorSet(forward)), is_whole, "{steps:08b} {forward:08b}");
        }
    }
}
