//! Print progress: what the print's own lines say of it (M73, M486), which is how much is done and which object is being
//! printed.

use core::sync::atomic::{AtomicI32, AtomicU32, Ordering::Relaxed};

/// What the print's lines have said.
#[derive(Debug)]
pub struct PrintProgress {
    /// One more than the percentage of the print that is done; 0 if nobody has said.
    percent: AtomicU32,
    /// One more than the minutes that are left; 0 if nobody has said.
    minutes: AtomicU32,
    /// One more than the number of the object being printed; 0 for none.
    object: AtomicI32,
}

impl PrintProgress {
    pub(super) const fn new() -> Self {
        Self { percent: AtomicU32::new(0), minutes: AtomicU32::new(0), object: AtomicI32::new(0) }
    }

    /// The percentage of the print that is done, and the minutes that are left, as far as the print has said.
    #[must_use]
    pub fn progress(&self) -> (Option<u32>, Option<u32>) {
        (self.percent.load(Relaxed).checked_sub(1), self.minutes.load(Relaxed).checked_sub(1))
    }

    pub(crate) fn note_progress(&self, percent: Option<u32>, minutes: Option<u32>) {
        if let Some(percent) = percent {
            self.percent.store(percent.min(100) + 1, Relaxed);
        }
        if let Some(minutes) = minutes {
            self.minutes.store(minutes.saturating_add(1), Relaxed);
        }
    }

    /// The object being printed, as the print counts them.
    #[must_use]
    pub fn object(&self) -> Option<u32> {
        self.object.load(Relaxed).checked_sub(1).and_then(|object| object.try_into().ok())
    }

    pub(crate) fn set_object(&self, object: i32) {
        self.object.store(object.saturating_add(1), Relaxed);
    }
}
