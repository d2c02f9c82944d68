//! The events that were played, by kind: the Stepper counts an event at once, whatever groups it has, and whoever wants
//! the steps of a group adds them up.

use crate::motors::MOST_GROUPS;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Sets of groups that step, times sets of groups whose coordinate grows.
const PATTERNS: usize = 1 << (2 * MOST_GROUPS);

/// Events by the groups that stepped (upper half of the index) and those whose coordinate grew (lower), wrapping.
pub(super) struct Played([AtomicU32; PATTERNS]);

impl Played {
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; PATTERNS])
    }

    /// One more.
    #[inline(always)]
    pub fn count(&self, pattern: u16) {
        let played = &self.0[pattern as usize % PATTERNS];
        played.store(played.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Steps of each group, signed.
    pub fn steps(&self) -> [i32; MOST_GROUPS] {
        let mut steps = [0i32; MOST_GROUPS];
        for (pattern, played) in self.0.iter().enumerate() {
            let played = played.load(Relaxed).cast_signed();
            if played != 0 {
                for (group, steps) in steps.iter_mut().enumerate() {
                    match (pattern >> (MOST_GROUPS + group) & 1, pattern >> group & 1) {
                        (0, _) => {}
                        (_, 0) => *steps = steps.wrapping_sub(played),
                        _ => *steps = steps.wrapping_add(played),
                    }
                }
            }
        }
        steps
    }
}
