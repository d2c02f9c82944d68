//! Axis sums: x, y, z and e as weighted sums of motor counts, each to be divided by one number.
//!
//! They are the fractions of [`ForwardKinematics`], which are linear in the counts. Here each motor's weights are known
//! beforehand, so an event adds what is looked up, instead of the rows of the mechanism times the adjugate.

use crate::counts::{Counts, HALF, STEPS, places};
use corehbot::kinematics::{ForwardKinematics, Mechanism};
use corehbot::motors::{MOTORS, MotorSet};

/// The sums of a mechanism.
#[derive(Clone)]
pub struct AxisSums {
    /// What an event adds, for each half of the motors, by the places of [`STEPS`].
    events: Box<[[[i64; 4]; STEPS.len()]; 2]>,
    /// What each sum is divided by.
    over: [i64; 4],
}

impl AxisSums {
    /// The sums of a mechanism; all 0 if its counts determine nothing.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let back = mechanism.forward_kinematics().unwrap_or(ForwardKinematics::NONE);
        let fractions = |counts: &Counts| back.fractions(counts);
        let one = |motor: usize| std::array::from_fn(|other| i64::from(other == motor));
        let weights: [[i64; 4]; MOTORS] = std::array::from_fn(|motor| fractions(&one(motor)).map(|(sum, _)| sum));
        let mut events = Box::new([[[0; 4]; STEPS.len()]; 2]);
        for (events, weights) in events.iter_mut().zip(weights.chunks_exact(HALF)) {
            for (sums, steps) in events.iter_mut().zip(&STEPS) {
                steps.iter().zip(weights).for_each(|(step, weights)| add(sums, weights.map(|weight| weight * step)));
            }
        }
        Self { events, over: fractions(&[0; MOTORS]).map(|(_, over)| over) }
    }

    /// Adds an event to the sums.
    #[inline]
    pub fn add_event(&self, sums: &mut [i64; 4], steps: MotorSet, forward: MotorSet) {
        let [low, high] = &*self.events;
        let [low_place, high_place] = places(steps, forward);
        add(sums, low[low_place]);
        add(sums, high[high_place]);
    }

    /// x, y, z and e at these counts, in parts of a step: so many times what a step of each motor alone adds.
    #[must_use]
    pub fn at(&self, counts: &Counts) -> [i64; 4] {
        let mut sums = [0; 4];
        for (motor, count) in corehbot::motors::Motor::ALL.into_iter().zip(counts) {
            let mut one = [0; 4];
            self.add_event(&mut one, MotorSet::of(motor), MotorSet::of(motor));
            add(&mut sums, one.map(|weight| weight * count));
        }
        sums
    }

    /// The parts of a step, for each axis.
    #[must_use]
    pub const fn over(&self) -> [i64; 4] {
        self.over
    }
}

fn add(sums: &mut [i64; 4], more: [i64; 4]) {
    sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counts::count;
    use corehbot_machine_file as machine_file;
    use proptest::prelude::*;
    use std::path::Path;

    fn mechanisms() -> Vec<Mechanism> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let machines = files.filter(|file| file.extension().is_some_and(|extension| extension == "toml"));
        let text = |file| std::fs::read_to_string(file).unwrap();
        machines.map(|file| machine_file::parse(&text(file)).unwrap().settings.mechanism).collect()
    }

    #[test]
    fn sums_are_the_fractions_of_the_forward_kinematics() {
        let mechanisms = mechanisms();
        assert!(mechanisms.len() > 10);
        proptest!(ProptestConfig::with_cases(64), |(counts: [i32; MOTORS])| {
            let counts = counts.map(i64::from);
            for mechanism in &mechanisms {
                let back = mechanism.forward_kinematics().unwrap_or(ForwardKinematics::NONE);
                let sums = AxisSums::new(mechanism);
                let fractions: Vec<_> = sums.at(&counts).into_iter().zip(sums.over()).collect();
                prop_assert_eq!(fractions, back.fractions(&counts));
            }
        });
    }

    #[test]
    fn events_add_what_their_steps_add_to_the_counts() {
        for mechanism in mechanisms() {
            let sums = AxisSums::new(&mechanism);
            let (mut counts, mut added) = ([0; MOTORS], [0; 4]);
            for (steps, forward) in (0..=u8::MAX).flat_map(|steps| (0..=u8::MAX).map(move |forward| (steps, forward))) {
                count(&mut counts, MotorSet(steps), MotorSet(forward));
                sums.add_event(&mut added, MotorSet(steps), MotorSet(forward));
                assert_eq!(added, sums.at(&counts));
            }
        }
    }
}
