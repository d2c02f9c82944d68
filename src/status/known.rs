//! What the Console takes for granted about the place of the tool. No context acts on it: a simulator holds the steps
//! to it.

use super::Status;
use core::sync::atomic::Ordering::Relaxed;

/// The Console's knowledge, as of its last turn.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Known {
    /// Which of x, y and z are homed.
    pub homed: [bool; 3],
    /// Whether a touch of the probe is under way, on a bed that is known.
    pub touches: bool,
    /// By how much offsets of z let the program go below the axis, in um. In such a touch, how far below 0 the probe is
    /// to trigger.
    pub below_um: i32,
}

/// The bit of a touch, after those of the axes.
const TOUCHES: u8 = 8;

impl Status {
    /// What the Console knows.
    #[must_use]
    pub fn known(&self) -> Known {
        let bits = self.known.load(Relaxed);
        Known {
            homed: [1, 2, 4].map(|bit| bits & bit != 0),
            touches: bits & TOUCHES != 0,
            below_um: self.below_um.load(Relaxed),
        }
    }

    pub(crate) fn set_known(&self, known: Known) {
        // Not `map`, which optimisation for the least size calls as a function, in every turn.
        let [x, y, z] = known.homed;
        let homed = u8::from(x) | (u8::from(y) << 1) | (u8::from(z) << 2);
        self.known.store(homed | (u8::from(known.touches) * TOUCHES), Relaxed);
        self.below_um.store(known.below_um, Relaxed);
    }

    /// Whether the ends of the axes that the machine was made with do not hold: soft endstops are off, or settings have
    /// changed ends or steps.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.is_free.load(Relaxed)
    }

    pub(crate) fn set_free(&self, is_free: bool) {
        self.is_free.store(is_free, Relaxed);
    }
}
