//! Spacing: how far two pulses of a motor are apart.

use super::Findings;
use corehbot::motion::MIN_STEP_INTERVAL;
use corehbot::motors::{MOTORS, Motor, MotorName, MotorSet};

/// The last pulses.
#[derive(Default)]
pub(super) struct Spacing {
    /// Those that the next one may be too near, in their order, and the last of all: mostly one.
    near: Vec<(u64, MotorSet)>,
}

impl Spacing {
    /// These motors step; time does not fall.
    #[inline]
    pub fn event(&mut self, findings: &mut Findings, names: &[MotorName; MOTORS], tick: u64, steps: MotorSet) {
        if self.near.last().is_some_and(|(last, _)| tick - last < MIN_STEP_INTERVAL) {
            self.check(findings, names, tick, steps);
        } else {
            self.near.clear();
        }
        self.near.push((tick, steps));
    }

    fn check(&mut self, findings: &mut Findings, names: &[MotorName; MOTORS], tick: u64, steps: MotorSet) {
        self.near.retain(|(before, _)| tick - *before < MIN_STEP_INTERVAL);
        for (motor, name) in Motor::ALL.into_iter().zip(names).filter(|(motor, _)| steps.has(*motor)) {
            if let Some((before, _)) = self.near.iter().rev().find(|(_, stepped)| stepped.has(motor)) {
                let gap = tick - *before;
                findings.add(tick, || {
                    format!("two pulses of {name} are {gap} ticks apart, {MIN_STEP_INTERVAL} is the least")
                });
            }
        }
    }
}
