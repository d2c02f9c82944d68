//! A hash of every step event, to tell whether two runs made the same.

use corehbot::motors::MotorSet;
use corehbot_sim::world::Sink;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

#[derive(Default)]
pub struct Trace(DefaultHasher);

impl Trace {
    pub fn hash(&self) -> u64 {
        self.0.finish()
    }
}

impl Sink for Trace {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        (tick, steps, forward).hash(&mut self.0);
    }
}
