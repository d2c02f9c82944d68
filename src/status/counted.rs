//! Step counts: the generator counts, so that the step interrupt need not.

use crate::motors::MOST_GROUPS;
use core::sync::atomic::{AtomicI32, Ordering::Acquire, Ordering::Relaxed};

/// Steps of each group of motors, signed and wrapping.
pub(super) struct Counted([AtomicI32; MOST_GROUPS]);

impl Counted {
    pub const fn new() -> Self {
        Self([const { AtomicI32::new(0) }; MOST_GROUPS])
    }

    /// Adds `steps` to a group. One context is the only writer.
    #[inline(always)]
    pub fn add(&self, group: usize, steps: i32) {
        if let Some(count) = self.0.get(group) {
            count.store(count.load(Relaxed).wrapping_add(steps), Relaxed);
        }
    }

    pub fn read(&self) -> [i32; MOST_GROUPS] {
        self.0.each_ref().map(|count| count.load(Acquire))
    }
}
