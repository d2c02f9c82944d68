//! Step counts: how many steps each group of motors has made.
//!
//! The step interrupt does not count. The generator tells how many steps it has put into the StepQueue, and those that
//! still wait stand there.

use super::queue::{StepQueue, StepsOut};
use crate::motors::MOST_GROUPS;
use crate::status::Status;

/// How often all that is looked at, at most, to see it at one moment.
const LOOKS: usize = 4;

/// What the motors have done so far. For the Console's context, which neither the generator nor the Stepper waits for.
#[derive(Clone, Copy)]
pub struct StepCounts<'m> {
    queue: &'m StepQueue,
    status: &'m Status,
}

impl<'m> StepsOut<'m> {
    /// What the motors do with what comes out here.
    #[must_use]
    pub const fn counts(&self, status: &'m Status) -> StepCounts<'m> {
        StepCounts { queue: self.queue(), status }
    }
}

impl StepCounts<'_> {
    /// Steps played by each group, signed and wrapping; all of one moment, unless the generator comes in between at each of
    /// four looks.
    #[must_use]
    pub fn read(&self) -> [i32; MOST_GROUPS] {
        let mut counts = [0; MOST_GROUPS];
        for _ in 0..LOOKS {
            let made = self.status.events_made();
            counts = self.status.steps_made();
            let waiting = self.queue.waiting(made);
            counts.iter_mut().zip(waiting).for_each(|(count, waiting)| *count = count.wrapping_sub(waiting));
            // The generator may write over what has been played meanwhile.
            if made == self.status.events_made() {
                break;
            }
        }
        counts
    }
}
