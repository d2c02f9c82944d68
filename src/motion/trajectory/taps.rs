//! Taps: an axis follows a weighted sum of delayed copies of the trajectory.
//!
//! An input shaper is such a sum (N. Singer, W. Seering, "Preshaping Command Inputs to Reduce System Vibration", 1990),
//! and so is a smoothed pressure advance: the mean speed over a window is the way through it divided by its length.
//! A sum of copies of something that is quadratic piece by piece is itself quadratic piece by piece, so nothing has
//! to be sampled, and where nothing changes nothing is computed. A window may be any staircase, a tap at each stair; one with slopes
//! would make cubics, which the solver of step times does not take. The weights of the advance sum to 0, those of a shaper to 1.
//! A window of 0 would be the speed itself, which no taps give.

use crate::units::SubTicks;
use core::hash::{Hash, Hasher};
use heapless::Vec;

/// Most copies of an axis. A shaper with two humps has four impulses; a fifth is for one with three (`MOST_IMPULSES` in `shaper`).
pub const TAPS: usize = 5;

/// A copy of the trajectory.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tap {
    /// How late it is, in ticks times 2^8.
    pub delay: u32,
    /// How much of it.
    pub weight: f32,
}

impl Tap {
    /// The trajectory itself.
    pub const IDENTITY: Self = Self { delay: 0, weight: 1.0 };
}

impl Tap {
    /// How late it is, in ticks times 2^16.
    pub const fn late(&self) -> SubTicks {
        SubTicks((self.delay as u64) << 8)
    }
}

/// Every bit counts, so that none of a tap flips unseen.
impl Hash for Tap {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.delay, self.weight.to_bits()).hash(state);
    }
}

/// The copies that an axis follows.
pub type Taps = Vec<Tap, TAPS, u8>;
