//! Overload: how often a context was too slow, and the worst case.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Number of late events, and the worst in ticks. One context counts it.
pub(super) struct Lateness {
    count: AtomicU32,
    worst: AtomicU32,
}

impl Lateness {
    pub const fn new() -> Self {
        Self { count: AtomicU32::new(0), worst: AtomicU32::new(0) }
    }

    /// Counts one more, late by `ticks`.
    pub fn add(&self, ticks: u32) {
        self.count.store(self.count.load(Relaxed).wrapping_add(1), Relaxed);
        self.worst.store(self.worst.load(Relaxed).max(ticks), Relaxed);
    }

    pub fn read(&self) -> Late {
        Late { count: self.count.load(Relaxed), worst: self.worst.load(Relaxed) }
    }
}

/// Number of late events, and the worst in ticks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Late {
    /// The number; wraps.
    pub count: u32,
    /// The worst, in ticks.
    pub worst: u32,
}

/// Overload since the start.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Overload {
    /// Late events that delayed all later ones: the processor was too slow.
    pub events: Late,
    /// Spans of the trajectory that were made longer: more short ones were under way than the shaper remembers, and its
    /// slowest tap would have lost its own.
    pub spans: Late,
    /// How often the StepQueue ran dry in mid-motion: the generator was too slow.
    pub starved: u32,
    /// How often a slow host made the look-ahead release unfinished moves.
    pub underruns: u32,
}
