//! Judge: the checker and the tally of a run, from the same samples.

use crate::check::{Checker, Findings};
use crate::limits::Limits;
use crate::tally::{Figures, Tally};
use corehbot::motors::{MOTORS, MotorSet};
use corehbot::settings::Settings;

/// Measures and checks a run event by event.
pub struct Judge {
    checker: Checker,
    tally: Tally,
}

impl Judge {
    /// A judge of a machine at rest, with the tool at `origin` (mm).
    #[must_use]
    pub fn new(s: &Settings, limits: &Limits, origin: [f64; 3]) -> Self {
        Self { checker: Checker::new(s, limits), tally: Tally::new(s, origin) }
    }

    /// One instant in which `steps` move, each forward or backward.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        let Self { checker, tally } = self;
        checker.event_between(tick, steps, forward, |sample| tally.sample(sample));
        tally.event(steps);
    }

    /// Something has just ended all motion at once.
    pub const fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }

    /// Ends a run that lasted `ticks` and should have made `expected` steps.
    #[must_use]
    pub fn finish(self, ticks: u64, expected: [i32; MOTORS]) -> (Figures, Findings) {
        let Self { checker, tally } = self;
        (tally.finish(checker.sampler().clone(), ticks), checker.finish(Some(expected)))
    }
}
