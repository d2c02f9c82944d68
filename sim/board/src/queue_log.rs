//! What the Console queues for the StepGenerator, for those that follow moves.

use corehbot::motion::{Entry, QueueObserver};
use std::sync::{Mutex, PoisonError};

/// What the Console has queued for the generator since the last look.
#[derive(Default)]
pub(crate) struct QueueLog(Mutex<Vec<Entry>>);

impl QueueLog {
    /// The entries since the last call.
    pub fn take(&self) -> Vec<Entry> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl QueueObserver for QueueLog {
    fn sees(&self, entry: &Entry) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(entry.clone());
    }
}
