//! The feed override, changed from outside, also for moves that wait in the look-ahead: by the user, and by a stream of
//! commands that does not keep up.
//!
//! What has left the look-ahead keeps its speed; that is 50 ms of motion, and the move under way.

use super::planner::Planner;
use crate::settings::Settings;
use crate::units::MmPerSec;

/// How much of the commanded feed is wanted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Override {
    /// By M220.
    pub percent: u16,
    /// By how fast the stream of commands comes: so many parts of so many.
    pub share: (u8, u8),
}

impl Override {
    /// As commanded.
    pub const NONE: Self = Self { percent: 100, share: (1, 1) };

    /// A commanded speed under the override.
    pub fn of(self, speed: MmPerSec) -> MmPerSec {
        let bits = u64::from(speed.to_bits()) * u64::from(self.percent) / 100;
        let (share, whole) = self.share;
        let bits = if share == whole { bits } else { bits * u64::from(share) / u64::from(whole.max(1)) };
        MmPerSec::from_bits(bits.min(u64::from(u32::MAX)) as u32)
    }
}

impl Planner<'_> {
    /// Feed override, in percent.
    #[must_use]
    pub const fn feed_percent(&self) -> u16 {
        self.wanted.percent
    }

    /// Changes the feed override (M220), also for the moves that wait.
    pub fn override_feed(&mut self, percent: u16, settings: &Settings) {
        self.want(Override { percent, ..self.wanted }, settings);
    }

    /// Takes `share` parts of `whole` of the feed, also for the moves that wait.
    pub fn take_share(&mut self, share: u8, whole: u8, settings: &Settings) {
        let share = if share == whole { (1, 1) } else { (share, whole) };
        self.want(Override { share, ..self.wanted }, settings);
    }

    fn want(&mut self, wanted: Override, settings: &Settings) {
        if core::mem::replace(&mut self.wanted, wanted) == wanted {
            return;
        }
        let belts = &self.belts;
        self.window.change(|planned| {
            if planned.feed > MmPerSec::ZERO {
                planned.set_nominal(wanted.of(planned.feed), belts, settings);
            }
        });
        self.waiting = self.window.time();
        if let Some(last) = self.window.last() {
            self.last = (last.vector, last.passed_on());
        }
    }
}
