//! Taps: an axis follows a weighted sum of delayed copies of the trajectory.
//!
//! An input shaper is such a sum (N. Singer, W. Seering, "Preshaping Command Inputs to Reduce System Vibration", 1990).
//! So is a smoothed pressure advance: the mean speed over a window is the distance in it divided by its length. A sum
//! of piecewise quadratic copies is itself piecewise quadratic, so nothing is sampled, and where nothing changes
//! nothing is computed. A window may be any staircase, with a tap at each stair. Slopes would make cubics, which the
//! solver of step times does not take. The weights of the advance sum to 0, the weights of a shaper to 1. A window of 0
//! would be the speed itself, which no taps give.

use crate::units::SubTicks;
use core::hash::{Hash, Hasher};
use heapless::Vec;

/// Most copies of an axis. A shaper with two humps has four impulses; a fifth is for one with three (`MOST_IMPULSES` in
/// `shaper`).
pub const TAPS: usize = 5;

/// A copy of the trajectory.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tap {
    /// Its delay, in ticks times 2^8.
    pub delay: u32,
    /// Its weight.
    pub weight: f32,
}

impl Tap {
    /// The trajectory itself.
    pub const IDENTITY: Self = Self { delay: 0, weight: 1.0 };
}

impl Tap {
    /// Its delay, in ticks times 2^16.
    pub const fn late(&self) -> SubTicks {
        SubTicks((self.delay as u64) << 8)
    }
}

/// Every bit counts, so that no flipped bit of a tap stays unseen.
impl Hash for Tap {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.delay, self.weight.to_bits()).hash(state);
    }
}

/// The copies that an axis follows.
pub type Taps = Vec<Tap, TAPS, u8>;
