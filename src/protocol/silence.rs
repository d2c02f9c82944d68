//! Silence: how long a host has said nothing, and how often it was asked because of that.
//!
//! A line may be lost whole, line end and all, or the `ok` for the last one. A host that waits for its `ok` then
//! waits for ever (printcore) or for half a minute (OctoPrint). So the next line is asked for after a silence in
//! the middle of a stream. A host that has not sent it yet ignores that; docs/host-protocol.md says why each of
//! them does, in each of its states.

use crate::units::Instant;

/// Requests in one silence. OctoPrint gives up at the eleventh for the same line (comm.py,
/// maxConsecutiveResends), and other requests for it count as well.
const PROBES: u8 = 5;

/// The silence of a host.
pub(super) struct Silence {
    since: Option<Instant>,
    /// The line that was asked for most recently.
    line: i32,
    /// How often.
    asked: u8,
}

impl Silence {
    /// Nothing is known yet.
    pub(super) const fn new() -> Self {
        Self { since: None, line: 0, asked: 0 }
    }

    /// Something was said.
    pub(super) const fn end(&mut self) {
        self.since = None;
    }

    /// Whether nothing has been said for `ms`, as far as anybody listened.
    pub(super) fn has_lasted(&mut self, ms: u32, now: Instant) -> bool {
        let since = *self.since.get_or_insert(now);
        now >= since.after_ms(ms)
    }

    /// Whether to ask for `line` now: after `patience_ms`, and each time after twice as long. `None` if that was
    /// done often enough.
    pub(super) fn asks_for(&mut self, line: i32, patience_ms: u32, now: Instant) -> Option<bool> {
        if line != self.line {
            (self.line, self.asked) = (line, 0);
        }
        if self.asked >= PROBES {
            return None;
        }
        let is_time = self.has_lasted(patience_ms << self.asked, now);
        if is_time {
            self.asked += 1;
            self.since = None;
        }
        Some(is_time)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    #[test]
    fn it_is_asked_five_times_at_growing_distance() {
        let mut silence = Silence::new();
        let asks = |ms: &u32| silence.asks_for(7, 500, Instant(0).after_ms(*ms)) == Some(true);
        assert_eq!((0..60_000).filter(asks).collect::<Vec<_>>(), [500, 1501, 3502, 7503, 15_504]);
        assert_eq!(silence.asks_for(7, 500, Instant(0)), None);
        assert_eq!(silence.asks_for(8, 500, Instant(0)), Some(false), "another line is another silence");
    }

    #[test]
    fn whatever_is_said_ends_it() {
        let mut silence = Silence::new();
        for ms in (0..10_000).step_by(499) {
            assert!(!silence.has_lasted(500, Instant(0).after_ms(ms)));
            silence.end();
        }
    }
}
