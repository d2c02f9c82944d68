//! How far motors have turned, by the firmware's counts of groups.

use corehbot::motors::{Coupling, MOST_GROUPS, MOTORS};

/// The motors' turns, by the firmware's counts of groups, which may be coupled to others at rest.
pub(super) struct Turned {
    pub coupling: Coupling,
    /// Counts of groups and motors when they were coupled so.
    since: [i32; MOST_GROUPS],
    before: [i32; MOTORS],
}

impl Turned {
    pub const fn new(coupling: Coupling) -> Self {
        Self { coupling, since: [0; MOST_GROUPS], before: [0; MOTORS] }
    }

    pub fn motors(&self, counts: [i32; MOST_GROUPS]) -> [i32; MOTORS] {
        let since = std::array::from_fn(|group| counts[group].wrapping_sub(self.since[group]));
        let turned = self.coupling.motor_counts(since);
        std::array::from_fn(|motor| self.before[motor].wrapping_add(turned[motor]))
    }

    pub fn recouple(&mut self, coupling: Coupling, counts: [i32; MOST_GROUPS]) {
        *self = Self { coupling, since: counts, before: self.motors(counts) };
    }
}
