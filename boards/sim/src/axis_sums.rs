//! Axis sums: x, y, z and e as weighted sums of motor counts, each to be divided by one number.
//!
//! They are the fractions of [`ForwardKinematics`], which are linear in the counts. Here each motor's weights are known
//! beforehand, so a position takes a few products instead of the rows of the mechanism times the adjugate.

use crate::sampler::Counts;
use corehbot::kinematics::{ForwardKinematics, Mechanism};
use corehbot::motors::MOTORS;

/// The weights of a mechanism.
pub struct AxisSums {
    /// Of each motor, for x, y, z and e.
    weights: [[i64; 4]; MOTORS],
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
        Self {
            weights: std::array::from_fn(|motor| fractions(&one(motor)).map(|(sum, _)| sum)),
            over: fractions(&[0; MOTORS]).map(|(_, over)| over),
        }
    }

    /// x, y, z and e at these counts, in parts of a step.
    #[inline]
    #[must_use]
    pub fn at(&self, counts: &Counts) -> [i64; 4] {
        let mut sums = [0; 4];
        for (weights, count) in self.weights.iter().zip(counts) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += weight * count;
            }
        }
        sums
    }

    /// The parts of a step, for each axis.
    #[must_use]
    pub const fn over(&self) -> [i64; 4] {
        self.over
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
}
