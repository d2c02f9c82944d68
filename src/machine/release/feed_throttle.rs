//! Slowing down for a host that cannot keep up, instead of stopping and going.
//!
//! A stream that has run dry and continues is slower than the print needs. From then on the feed is a share of the
//! commanded one. It is in proportion to the time of the waiting moves at their commanded speed: all of the feed with
//! 200 ms, half of it with 100. So the print comes to be as fast as the host, with moves in hand to plan with. At first
//! the share is no less than a half; every time the stream runs dry again that least share is halved.
//!
//! Before the stream has run dry none of this happens, because it depends on when lines arrive. It ends when the
//! look-ahead is full, because the host is then known to be faster. It also ends when a command waits for the motion,
//! or with a pause (see [`policy`](super::policy)).

use crate::motion::WHOLE_SHARE as WHOLE;
use crate::units::TICKS_PER_MS;

/// With moves for this time nothing is slowed down; it is less than the motion needed to begin.
const FULL_FEED_TICKS: u64 = 200 * TICKS_PER_MS as u64;

/// The least share at first, and the absolute least share.
const LEAST_SHARES: (u8, u8) = (WHOLE / 2, WHOLE / 8);

/// The share of the feed that the stream allows.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct FeedThrottle {
    /// The least share; [`WHOLE`] while nothing is slowed down.
    least: u8,
    share: u8,
}

impl FeedThrottle {
    /// Nothing is slowed down.
    pub const fn new() -> Self {
        Self { least: WHOLE, share: WHOLE }
    }

    /// Nothing is slowed down any more.
    pub const fn reset(&mut self) {
        self.least = WHOLE;
    }

    /// Whether all of the feed is allowed, and was when last asked.
    pub const fn is_steady(&self) -> bool {
        self.least == WHOLE && self.share == WHOLE
    }

    /// The stream has run dry and continues.
    pub fn slow_down(&mut self) {
        let (at_first, at_all) = LEAST_SHARES;
        self.least = (self.least / 2).clamp(at_all, at_first);
    }

    /// The share of the feed, in sixteenths. The arguments are the time of the moves in the look-ahead at that feed,
    /// and the time of the moves that have left it.
    pub fn share(&mut self, waiting_ticks: u64, queued_ticks: u64) -> u8 {
        if self.least == WHOLE {
            self.share = WHOLE;
            return WHOLE;
        }
        let lasting_ticks = waiting_ticks * u64::from(self.share) / u64::from(WHOLE) + queued_ticks;
        let share = (lasting_ticks * u64::from(WHOLE) / FULL_FEED_TICKS).min(u64::from(WHOLE)) as u8;
        self.share = share.max(self.least);
        self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_that_never_ran_dry_is_as_fast_as_commanded() {
        let mut throttle = FeedThrottle::new();
        assert_eq!(throttle.share(0, 0), WHOLE);
        throttle.slow_down();
        throttle.reset();
        assert_eq!(throttle.share(0, 0), WHOLE);
    }

    #[test]
    fn a_stream_that_goes_on_after_an_underrun_is_as_fast_as_it_comes() {
        let mut throttle = FeedThrottle::new();
        throttle.slow_down();
        assert_eq!(throttle.share(FULL_FEED_TICKS / 4, 0), WHOLE / 2);
        // At half the speed, the waiting moves last twice as long.
        assert_eq!(throttle.share(FULL_FEED_TICKS * 3 / 2, 0), WHOLE * 3 / 4);
        assert_eq!(throttle.share(FULL_FEED_TICKS * 4 / 3, FULL_FEED_TICKS / 4), WHOLE);
        for least in [4, 2, 2] {
            throttle.slow_down();
            assert_eq!(throttle.share(0, 0), least);
        }
    }
}
