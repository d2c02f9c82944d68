//! When moves leave the look-ahead.
//!
//! Moves leave for good: their speeds never change after. Which speeds they leave with must not depend on
//! when the host's bytes arrived, so only final moves leave by themselves (see `motion::window`). Time has
//! a say in two cases alone: when motion begins, which changes no speed, and when the stream is dry.

use super::slowdown::Slowdown;
use crate::units::{Instant, TICKS_PER_MS};

/// Motion begins when this much of it is final: sixteen lines of a host behind an USB adapter whose latency
/// timer is at its default of 16 ms (FTDI AN232B-04).
pub(super) const GATHERED: u64 = 250 * TICKS_PER_MS as u64;

/// Motion begins, whatever is planned, when no move has been added for this long. Marlin waits as long for
/// a second block (BLOCK_DELAY_FOR_1ST_MOVE).
const PAUSE_MS: u32 = 100;

/// With more than this queued, nothing leaves the look-ahead: what has left is out of reach of the overrides, which
/// are to count within 100 ms. Fifty turns of a Console that is polled every millisecond, and three lines of a host
/// behind such an adapter.
const AMPLE: u64 = 50 * TICKS_PER_MS as u64;

/// With less than this queued, the stream is dry: moves leave though they are not final. Twenty turns of a
/// Console that is polled every millisecond, so that the machine brakes before it starves.
const DRY: u64 = 20 * TICKS_PER_MS as u64;

/// With so many moves queued the stream is not dry, however short they are: a full window lets sixteen go at once, and
/// the queue holds twice as many.
const MANY: usize = 4;

/// What may leave now.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Release {
    /// Nothing.
    Nothing,
    /// Final moves.
    Final,
    /// The next move, final or not.
    Next,
    /// Every move; the last ends at rest.
    All,
}

/// Decides when moves leave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flow {
    /// Motion has not begun since the last rest.
    gathering: bool,
    /// When the last move was added.
    added: Instant,
    /// Whether the present drought was counted.
    counted: bool,
    /// Whether the look-ahead has been full since the last rest.
    was_full: bool,
    /// There are moves that nobody knew of when it was last asked whether motion begins.
    is_news: bool,
    slowdown: Slowdown,
}

impl Flow {
    pub const fn new() -> Self {
        let slowdown = Slowdown::new();
        Self { gathering: true, added: Instant(0), counted: false, was_full: false, is_news: false, slowdown }
    }

    /// A move was added.
    pub const fn add(&mut self, now: Instant) {
        self.added = now;
        self.slowdown.add();
    }

    /// The share of the feed that the stream allows, given the nominal time of the moves that wait and the time of those
    /// that are queued, in ticks.
    pub fn share(&mut self, waiting: u64, queued: u64) -> u8 {
        self.slowdown.share(waiting, queued)
    }

    /// Whether the stream allows all of the feed, and did when it was last asked.
    pub const fn is_steady(&self) -> bool {
        self.slowdown.is_steady()
    }

    /// The look-ahead is full.
    pub const fn fill(&mut self) {
        self.gathering = false;
        self.was_full = true;
        self.slowdown.end();
    }

    /// Whether the look-ahead has once been full, so that its level says something of the host.
    pub const fn is_level_telling(&self) -> bool {
        self.was_full
    }

    /// Everything leaves now, because a command waits for it.
    pub const fn drain(&mut self) {
        self.gathering = false;
        self.was_full = false;
        self.slowdown.end();
    }

    /// Motion rests, and begins anew with the next move.
    pub const fn rest(&mut self) {
        self.gathering = true;
        self.was_full = false;
        self.counted = false;
    }

    /// Whether motion has not begun since the last rest.
    pub const fn is_gathering(&self) -> bool {
        self.gathering
    }

    /// There is more to know of what is planned.
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

    /// What may leave to begin with, given the nominal time of final moves, in ticks.
    pub fn begin(&mut self, final_time: u64, now: Instant) -> Release {
        let paused = self.is_paused(now);
        self.gathering = !paused && final_time < GATHERED;
        match (paused, self.gathering) {
            (true, _) => Release::All,
            (false, true) => Release::Nothing,
            (false, false) => Release::Final,
        }
    }

    /// What may leave under way, given the moves queued behind the look-ahead and their time, in ticks.
    pub const fn release(&mut self, moves: usize, queued: u64) -> Release {
        if queued > AMPLE {
            self.counted = false;
            Release::Nothing
        } else if queued > DRY || moves >= MANY {
            Release::Final
        } else {
            Release::Next
        }
    }

    /// A move left before it was final; true if that is a new drought.
    pub const fn note_drought(&mut self) -> bool {
        self.slowdown.note_drought();
        !core::mem::replace(&mut self.counted, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_begins_when_enough_is_gathered_or_the_host_pauses() {
        let mut flow = Flow::new();
        flow.add(Instant(0));
        assert_eq!(flow.begin(GATHERED - 1, Instant(0).after_ms(99)), Release::Nothing);
        assert!(flow.is_gathering());
        assert_eq!(flow.begin(GATHERED, Instant(0).after_ms(99)), Release::Final);
        assert!(!flow.is_gathering());
        let mut flow = Flow::new();
        assert_eq!(flow.begin(1, Instant(0).after_ms(PAUSE_MS)), Release::All);
    }

    #[test]
    fn an_ample_queue_lets_nothing_go() {
        let mut flow = Flow::new();
        flow.fill();
        assert_eq!(flow.release(1, AMPLE + 1), Release::Nothing);
        assert_eq!(flow.release(1, AMPLE), Release::Final);
        assert_eq!(flow.release(1, DRY), Release::Next);
        assert_eq!(flow.release(MANY, DRY), Release::Final);
        assert!(flow.note_drought());
        assert!(!flow.note_drought());
    }
}
