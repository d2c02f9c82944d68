//! A sink that nobody looks at, for tests of what is said.

use corehbot::motors::MotorSet;
use corehbot_sim::world::Sink;

pub struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}
