//! A sink that ignores its input, for tests of messages.

use corehbot::motors::MotorSet;
use corehbot_sim::world::Sink;

pub struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}
