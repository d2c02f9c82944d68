//! The feed override, changed from outside, also for moves that wait in the look-ahead. The user changes it, and so
//! does a stream of commands that does not keep up.
//!
//! Moves that have left the look-ahead keep their speed. That is at most 50 ms of motion, plus the move under way.

use super::Planner;
use crate::units::Feed;

/// All of the feed, as a share of it.
pub const WHOLE_SHARE: u8 = 16;

/// The wanted share of the commanded feed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::motion) struct Override {
    /// By M220.
    pub percent: u16,
    /// By how fast the stream of commands comes, in parts of [`WHOLE_SHARE`].
    pub share: u8,
}

impl Override {
    /// As commanded.
    pub const NONE: Self = Self { percent: 100, share: WHOLE_SHARE };

    /// A commanded speed under the override.
    pub fn of(self, speed: Feed) -> Feed {
        if self == Self::NONE {
            return speed;
        }
        // By hundreds and the remainder, because a division of 64 bits takes a hundred instructions.
        let (hundreds, remainder) = (speed.to_bits() / 100, speed.to_bits() % 100);
        let percent = u32::from(self.percent);
        let bits = u64::from(hundreds) * u64::from(percent) + u64::from(remainder * percent / 100);
        let bits = bits * u64::from(self.share) / u64::from(WHOLE_SHARE);
        Feed::from_bits(bits.min(u64::from(u32::MAX)) as u32)
    }
}

impl Planner<'_> {
    /// Feed override, in percent.
    #[must_use]
    pub const fn feed_percent(&self) -> u16 {
        self.wanted.percent
    }

    /// Changes the feed override (M220), also for the moves that wait, which are [planned again](Self::replan).
    pub fn override_feed(&mut self, percent: u16) {
        self.want(Override { percent, ..self.wanted });
    }

    /// Takes a share of the feed, in parts of [`WHOLE_SHARE`], also for the moves that wait.
    pub fn take_share(&mut self, share: u8) {
        self.want(Override { share, ..self.wanted });
    }

    fn want(&mut self, wanted: Override) {
        if core::mem::replace(&mut self.wanted, wanted) != wanted {
            self.window.begin_replan();
        }
    }

    /// Whether no move is left to be planned again.
    #[inline(always)]
    #[must_use]
    pub const fn is_planned(&self) -> bool {
        self.window.is_planned()
    }

    /// Whether no move was left to be planned again after a change of the feed. If not, the next few of them have been.
    /// Until then nothing leaves.
    #[inline(always)]
    pub fn replan(&mut self) -> bool {
        if !self.window.is_planned() {
            self.replan_some();
            return false;
        }
        true
    }

    #[inline(never)]
    fn replan_some(&mut self) {
        let (wanted, waiting) = (self.wanted, &mut self.waiting);
        self.window.replan(|planned| {
            if planned.feed > Feed::ZERO {
                *waiting = waiting.saturating_sub(u64::from(planned.nominal_ticks));
                planned.set_nominal(wanted.of(planned.feed));
                *waiting += u64::from(planned.nominal_ticks);
            }
        });
        if self.window.is_planned()
            && let Some(last) = self.window.last()
        {
            self.last_exit_limit_sq = last.exit_limit_sq();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_under_an_override_is_cut_off_to_the_bit() {
        for bits in [0, 1, 99, 100, 6_553_600, 6_553_633, u32::MAX] {
            for (percent, share) in [(100, 16), (10, 16), (33, 16), (999, 16), (100, 7), (150, 2)] {
                let exact = u64::from(bits) * u64::from(percent) / 100 * u64::from(share) / 16;
                let speed = Override { percent, share }.of(Feed::from_bits(bits));
                assert_eq!(u64::from(speed.to_bits()), exact.min(u32::MAX.into()), "{bits} {percent} {share}");
            }
        }
    }
}
