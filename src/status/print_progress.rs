//! Print progress: the percentage, the minutes left and the current object, as the print's own lines report them (M73,
//! M486).

use core::sync::atomic::{AtomicI32, AtomicU32, Ordering::Relaxed};

/// The reported progress.
#[derive(Debug)]
pub struct PrintProgress {
    /// One more than the finished percentage of the print; 0 if not reported.
    percent: AtomicU32,
    /// One more than the minutes left; 0 if not reported.
    minutes: AtomicU32,
    /// One more than the number of the object being printed; 0 for none.
    object: AtomicI32,
}

impl PrintProgress {
    pub(super) const fn new() -> Self {
        Self { percent: AtomicU32::new(0), minutes: AtomicU32::new(0), object: AtomicI32::new(0) }
    }

    /// The finished percentage of the print, and the minutes left, if reported.
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

    /// The current object, by the print's own number.
    #[must_use]
    pub fn object(&self) -> Option<u32> {
        self.object.load(Relaxed).checked_sub(1).and_then(|object| object.try_into().ok())
    }

    pub(crate) fn set_object(&self, object: i32) {
        self.object.store(object.saturating_add(1), Relaxed);
    }
}
