//! Step counts: the steps that each group of motors has made.
//!
//! The step interrupt does not count. The generator publishes the steps that it has put into the StepQueue, and the
//! queue shows the steps that still wait.

use super::queue::{StepQueue, StepsOut};
use crate::motors::MOST_GROUPS;
use crate::status::Status;

/// Maximum number of attempts to read everything at one moment.
const LOOKS: usize = 4;

/// Steps of the motors so far. For the Console's context: neither the generator nor the Stepper waits for it.
#[derive(Clone, Copy)]
pub struct StepCounts<'m> {
    queue: &'m StepQueue,
    status: &'m Status,
}

impl<'m> StepsOut<'m> {
    /// The counts of the steps that leave the queue here.
    #[must_use]
    pub const fn counts(&self, status: &'m Status) -> StepCounts<'m> {
        StepCounts { queue: self.queue(), status }
    }
}

impl StepCounts<'_> {
    /// Steps played by each group, signed and wrapping, all of one moment unless the generator interrupts each of four
    /// attempts.
    #[must_use]
    pub fn read(&self) -> [i32; MOST_GROUPS] {
        let mut counts = [0; MOST_GROUPS];
        for _ in 0..LOOKS {
            let made = self.status.events_made();
            counts = self.status.steps_made();
            let waiting = self.queue.waiting(made);
            counts.iter_mut().zip(waiting).for_each(|(count, waiting)| *count = count.wrapping_sub(waiting));
            // The generator may overwrite played events during the read.
            if made == self.status.events_made() {
                break;
            }
        }
        counts
    }
}
