//! Spacing: how far two pulses of a motor are apart.

use super::Findings;
use corehbot::motion::MIN_STEP_INTERVAL;
use corehbot::motors::{MOTORS, Motor, MotorName, MotorSet};

/// The last pulse of each motor.
#[derive(Default)]
pub(super) struct Spacing {
    /// Its tick.
    last: [u64; MOTORS],
    /// The motors that had one.
    pulsed: MotorSet,
    /// The latest of all ticks. Where this one is far after it, no pulse is too near.
    latest: u64,
}

impl Spacing {
    /// These motors step.
    pub fn event(&mut self, findings: &mut Findings, names: &[MotorName; MOTORS], tick: u64, steps: MotorSet) {
        if tick.saturating_sub(self.latest) < MIN_STEP_INTERVAL {
            self.check(findings, names, tick, steps);
        }
        self.latest = self.latest.max(tick);
        self.pulsed = self.pulsed.with(steps);
        for (motor, last) in Motor::ALL.into_iter().zip(&mut self.last) {
            if steps.has(motor) {
                *last = tick;
            }
        }
    }

    fn check(&self, findings: &mut Findings, names: &[MotorName; MOTORS], tick: u64, steps: MotorSet) {
        for ((motor, before), name) in Motor::ALL.into_iter().zip(self.last).zip(names) {
            let gap = tick.saturating_sub(before);
            if steps.has(motor) && self.pulsed.has(motor) && gap < MIN_STEP_INTERVAL {
                findings.add(tick, || {
                    format!("two pulses of {name} are {gap} ticks apart, {MIN_STEP_INTERVAL} is the least")
                });
            }
        }
    }
}
