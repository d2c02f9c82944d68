//! When moves leave the look-ahead.
//!
//! Moves leave for ever: their speeds never change after. Which speeds they leave with must not depend on when the
//! host's bytes arrived, so only final moves leave by themselves (see `motion::planner`). Time matters in two cases
//! only: when motion begins, which changes no speed, and when the stream is dry. A dry stream is an underrun if another
//! move follows before a command waits for the motion. Otherwise it was the end of the stream, where the tool rests in
//! any case.

use super::feed_throttle::FeedThrottle;
use crate::units::{Instant, TICKS_PER_MS};

/// Motion begins when this much of it is final. It is sixteen lines of a host with a USB adapter that has its latency
/// timer at the default of 16 ms (FTDI AN232B-04).
pub(in crate::machine) const GATHERED: u64 = 250 * TICKS_PER_MS as u64;

/// Motion begins, however little is planned, when no move has been added for this long. Marlin waits as long for a
/// second block (BLOCK_DELAY_FOR_1ST_MOVE).
const PAUSE_MS: u32 = 100;

/// A host that sends nothing for this long after the motion has come to rest was not too slow: it paused, or the user
/// jogs. Ten times the pause after which motion begins.
const LONG_REST_MS: u32 = 1000;

/// With more than this queued, no move leaves the look-ahead: queued moves are out of reach of the overrides, which are
/// to take effect within 100 ms. Fifty turns of a Console that is polled every millisecond, and three lines of a host
/// with such an adapter.
const QUEUE_HIGH: u64 = 50 * TICKS_PER_MS as u64;

/// With less than this queued, the stream is dry: moves leave though they are not final. Twenty turns of a
/// Console that is polled every millisecond, so that the machine brakes before it starves.
const QUEUE_LOW: u64 = 20 * TICKS_PER_MS as u64;

/// With this many moves queued the stream is not dry, even if they are short: a full window lets sixteen go at once,
/// and the queue holds twice as many.
const MANY: usize = 4;

/// The moves that may leave now.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Release {
    /// Nothing.
    Nothing,
    /// Final moves.
    Final,
    /// The next move, final or not.
    Next,
}

/// Decides when moves leave.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct ReleasePolicy {
    /// Motion has not begun since the last rest.
    is_gathering: bool,
    /// When the last move was added.
    added: Instant,
    /// When motion came to rest by itself, if it does rest.
    rested: Option<Instant>,
    /// A move left before it was final, and none was added since.
    is_dry: bool,
    /// A command has waited for the end of the motion, and no move was added since.
    has_waited: bool,
    /// Whether the present underrun was counted.
    is_counted: bool,
    /// Whether the look-ahead has been full since the last rest.
    was_full: bool,
    /// Moves were added since it was last asked whether motion begins.
    is_news: bool,
    throttle: FeedThrottle,
}

impl ReleasePolicy {
    pub const fn new() -> Self {
        let throttle = FeedThrottle::new();
        let (added, rested) = (Instant(0), None);
        Self {
            is_gathering: true,
            added,
            rested,
            is_dry: false,
            has_waited: false,
            is_counted: false,
            was_full: false,
            is_news: false,
            throttle,
        }
    }

    /// A move is about to be added; true if that makes an underrun of a dry stream, the first since the last count.
    pub fn add(&mut self, now: Instant) -> bool {
        (self.added, self.has_waited) = (now, false);
        if !core::mem::replace(&mut self.is_dry, false) {
            return false;
        }
        if self.rested.is_some_and(|rested| now >= rested.after_ms(LONG_REST_MS)) {
            self.throttle.reset();
        } else {
            self.throttle.slow_down();
        }
        !core::mem::replace(&mut self.is_counted, true)
    }

    /// The share of the feed that the stream allows, given the nominal time of the waiting moves and the time of the
    /// queued moves.
    pub fn share(&mut self, waiting_ticks: u64, queued_ticks: u64) -> u8 {
        self.throttle.share(waiting_ticks, queued_ticks)
    }

    /// Whether the stream allows all of the feed, and did when it was last asked.
    pub const fn is_steady(&self) -> bool {
        self.throttle.is_steady()
    }

    /// The look-ahead is full.
    pub const fn note_full(&mut self) {
        self.set_out();
        self.was_full = true;
        self.throttle.reset();
    }

    /// Whether the look-ahead has once been full, so that its level says something of the host.
    pub const fn is_level_telling(&self) -> bool {
        self.was_full
    }

    /// Everything leaves now, because a command waits for it. A stream that had run dry was at its end.
    pub const fn note_awaited(&mut self) {
        self.set_out();
        self.was_full = false;
        (self.is_dry, self.has_waited) = (false, true);
        self.throttle.reset();
    }

    /// Whether a command has waited for the end of the motion, and no move was added since.
    pub const fn has_waited(&self) -> bool {
        self.has_waited
    }

    /// Motion rests, and the next move starts it again.
    pub const fn come_to_rest(&mut self, now: Instant) {
        self.rested = Some(now);
        self.is_gathering = true;
        self.was_full = false;
        self.is_counted = false;
    }

    /// Whether motion has not begun since the last rest.
    pub const fn is_gathering(&self) -> bool {
        self.is_gathering
    }

    /// There is more to know of the planned moves.
    pub const fn note_news(&mut self) {
        self.is_news = true;
    }

    /// Whether motion may begin now though it could not when this was last asked.
    pub fn is_worth_asking(&mut self, now: Instant) -> bool {
        core::mem::replace(&mut self.is_news, false) || self.is_paused(now)
    }

    fn is_paused(&self, now: Instant) -> bool {
        now >= self.added.after_ms(PAUSE_MS)
    }

    /// Begins the motion if it is time, given the nominal time of final moves; true if it begins.
    pub fn begin(&mut self, final_ticks: u64, now: Instant) -> bool {
        let begins = self.is_paused(now) || final_ticks >= GATHERED;
        if begins {
            self.set_out();
        }
        begins
    }

    /// Motion begins.
    const fn set_out(&mut self) {
        self.is_gathering = false;
        self.rested = None;
    }

    /// The moves that may leave while moving, given the number and time of the moves that have left the look-ahead.
    pub const fn release(&mut self, moves: usize, queued_ticks: u64) -> Release {
        if queued_ticks > QUEUE_HIGH {
            self.is_counted = false;
            Release::Nothing
        } else if queued_ticks > QUEUE_LOW || moves >= MANY {
            Release::Final
        } else {
            Release::Next
        }
    }

    /// A move left before it was final. If no move follows, that was the end of the stream.
    pub const fn note_dry(&mut self) {
        self.is_dry = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_begins_when_enough_is_gathered_or_the_host_pauses() {
        let mut policy = ReleasePolicy::new();
        policy.add(Instant(0));
        assert!(!policy.begin(GATHERED - 1, Instant(0).after_ms(99)));
        assert!(policy.is_gathering());
        assert!(policy.begin(GATHERED, Instant(0).after_ms(99)));
        assert!(!policy.is_gathering());
        let mut policy = ReleasePolicy::new();
        assert!(policy.begin(1, Instant(0).after_ms(PAUSE_MS)));
    }

    #[test]
    fn an_ample_queue_lets_nothing_go() {
        let mut policy = ReleasePolicy::new();
        policy.note_full();
        assert_eq!(policy.release(1, QUEUE_HIGH + 1), Release::Nothing);
        assert_eq!(policy.release(1, QUEUE_HIGH), Release::Final);
        assert_eq!(policy.release(1, QUEUE_LOW), Release::Next);
        assert_eq!(policy.release(MANY, QUEUE_LOW), Release::Final);
    }

    #[test]
    fn an_underrun_counts_once_and_when_the_stream_goes_on() {
        let mut policy = ReleasePolicy::new();
        policy.note_dry();
        assert!(policy.add(Instant(0)));
        assert!(!policy.add(Instant(0)));
        policy.note_dry();
        assert!(!policy.add(Instant(0)), "the same underrun");
        policy.release(0, QUEUE_HIGH + 1);
        policy.note_dry();
        assert!(policy.add(Instant(0)));
        // A command that waits makes an end of it.
        policy.note_dry();
        policy.note_awaited();
        policy.come_to_rest(Instant(0));
        assert!(!policy.add(Instant(0)));
    }

    #[test]
    fn whoever_pauses_for_long_is_not_slow() {
        for (ms, is_slow) in [(999, true), (1000, false)] {
            let mut policy = ReleasePolicy::new();
            policy.note_dry();
            policy.come_to_rest(Instant(0));
            assert!(policy.add(Instant(0).after_ms(ms)), "counted in any case");
            assert_eq!(policy.is_steady(), !is_slow);
        }
    }
}
