//! Overload: how often something was too slow, and how much at worst.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// How often something was late, and the worst of it in ticks. One context counts it.
pub(super) struct Lateness {
    count: AtomicU32,
    worst: AtomicU32,
}

impl Lateness {
    pub const fn new() -> Self {
        Self { count: AtomicU32::new(0), worst: AtomicU32::new(0) }
    }

    /// Once more, by so many ticks.
    pub fn add(&self, ticks: u32) {
        self.count.store(self.count.load(Relaxed).wrapping_add(1), Relaxed);
        self.worst.store(self.worst.load(Relaxed).max(ticks), Relaxed);
    }

    pub fn read(&self) -> Late {
        Late { count: self.count.load(Relaxed), worst: self.worst.load(Relaxed) }
    }
}

/// How often something was late, and by how many ticks at worst.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Late {
    /// How often; wraps.
    pub count: u32,
    /// The worst, in ticks.
    pub worst: u32,
}

/// What was too slow since the start.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Overload {
    /// Events that came so late that all later ones were moved: the processor was too slow.
    pub events: Late,
    /// Spans of the trajectory that were made longer, because so many short ones were under way that the slowest tap
    /// would have lost its own: the shaper remembers no more.
    pub spans: Late,
    /// How often the StepQueue ran dry in mid-motion: the generator was too slow.
    pub starved: u32,
    /// How often the host was so slow that the look-ahead had to let go of moves unfinished.
    pub underruns: u32,
}
