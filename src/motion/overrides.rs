//! The feed override, changed from outside, also for moves that wait in the look-ahead: by the user, and by a stream of
//! commands that does not keep up.
//!
//! What has left the look-ahead keeps its speed; that is 50 ms of motion, and the move under way.

use super::planner::Planner;
use crate::settings::Settings;
use crate::units::MmPerSec;

/// All of the feed, as a share of it.
pub const WHOLE_SHARE: u8 = 16;

/// How much of the commanded feed is wanted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Override {
    /// By M220.
    pub percent: u16,
    /// By how fast the stream of commands comes, in parts of [`WHOLE_SHARE`].
    pub share: u8,
}

impl Override {
    /// As commanded.
    pub const NONE: Self = Self { percent: 100, share: WHOLE_SHARE };

    /// A commanded speed under the override.
    pub fn of(self, speed: MmPerSec) -> MmPerSec {
        let bits = u64::from(speed.to_bits()) * u64::from(self.percent) / 100;
        let bits = bits * u64::from(self.share) / u64::from(WHOLE_SHARE);
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

    /// Takes a share of the feed, in parts of [`WHOLE_SHARE`], also for the moves that wait.
    pub fn take_share(&mut self, share: u8, settings: &Settings) {
        if share != self.wanted.share {
            self.want(Override { share, ..self.wanted }, settings);
        }
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
