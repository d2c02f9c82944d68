//! The feed override, changed from outside, also for moves that wait in the look-ahead.
//!
//! What has left the look-ahead keeps its speed; that is 50 ms of motion, and the move under way.

use super::planner::Planner;
use crate::settings::Settings;
use crate::units::MmPerSec;

/// A speed under an override.
pub(super) fn percent_of(speed: MmPerSec, percent: u16) -> MmPerSec {
    let bits = u64::from(speed.to_bits()) * u64::from(percent) / 100;
    MmPerSec::from_bits(bits.min(u64::from(u32::MAX)) as u32)
}

impl Planner<'_> {
    /// Feed override, in percent.
    #[must_use]
    pub const fn feed_percent(&self) -> u16 {
        self.feed_percent
    }

    /// Changes the feed override (M220), also for the moves that wait.
    pub fn override_feed(&mut self, percent: u16, settings: &Settings) {
        if core::mem::replace(&mut self.feed_percent, percent) == percent {
            return;
        }
        let belts = &self.belts;
        self.window.change(|planned| {
            if planned.feed > MmPerSec::ZERO {
                planned.set_nominal(percent_of(planned.feed, percent), belts, settings);
            }
        });
        self.waiting = self.window.time();
        if let Some(last) = self.window.last() {
            self.last = (last.vector, last.passed_on());
        }
    }
}
