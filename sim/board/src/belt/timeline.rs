//! Timeline: motion time of an instant that has passed, and the reverse.
//!
//! The plant lives in real time. People search in motion time, which stands still where motors rest. After M999 motion
//! time begins at 0 again, and continues here.

use corehbot::units::TICKS_PER_SECOND;
use std::collections::VecDeque;

/// Motion time restarts where its lag grows by more than this, in ticks: 1 ms. A burst of events lags by less.
const ANEW: u64 = 10_000;

/// Beginnings that are kept. The firmware reports a skip within one or two; a motor that is stalled for long may take
/// more.
const KEPT: usize = 1024;

/// Real time and motion time of an instant, in ticks.
#[derive(Clone, Copy, Debug, Default)]
struct Instant {
    now: u64,
    motion: u64,
}

/// Motion so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Timeline {
    begins: VecDeque<Instant>,
    last: Instant,
    /// Motion time before the last new start of the firmware.
    before: u64,
}

impl Timeline {
    /// Motors step.
    pub(super) fn event(&mut self, now: u64, tick: u64) {
        if self.before + tick < self.last.motion {
            self.before = self.last.motion;
        }
        let event = Instant { now, motion: self.before + tick };
        let lag = |instant: &Instant| instant.now - instant.motion.min(instant.now);
        if self.begins.is_empty() || lag(&event).abs_diff(lag(&self.last)) > ANEW {
            self.begins.push_back(event);
            if self.begins.len() > KEPT {
                self.begins.pop_front();
            }
        }
        self.last = event;
    }

    /// Motion time of the last event, in ticks.
    pub(super) const fn motion(&self) -> u64 {
        self.last.motion
    }

    /// Motion time of the last event, in s.
    pub(super) fn now_s(&self) -> f64 {
        self.last.motion as f64 / f64::from(TICKS_PER_SECOND)
    }

    /// The instant in ticks of a motion time in s, which lies between the last two events. Where motion rested between
    /// them, it is the time before the later one.
    pub(super) fn instant(&self, motion_s: f64) -> u64 {
        let motion = (motion_s * f64::from(TICKS_PER_SECOND)).round() as u64;
        self.last.now.saturating_sub(self.last.motion.saturating_sub(motion))
    }

    /// Motion time of an instant, in s.
    pub(super) fn motion_s(&self, now: u64) -> f64 {
        let later = self.begins.iter().position(|begin| begin.now > now);
        let end = later.and_then(|i| self.begins.get(i)).map_or(self.last.motion, |begin| begin.motion);
        let begin = match later {
            Some(i) => i.checked_sub(1).and_then(|i| self.begins.get(i)),
            None => self.begins.back(),
        };
        let motion = begin.map_or(end, |begin| (begin.motion + (now - begin.now)).min(end));
        motion as f64 / f64::from(TICKS_PER_SECOND)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_time_stands_still_at_rest_and_goes_on_after_a_new_start() {
        let mut timeline = Timeline::default();
        let second = u64::from(TICKS_PER_SECOND);
        for (now, tick) in [(10, 0), (11, 1), (20, 2), (21, 3), (30, 0), (31, 1)] {
            timeline.event(now * second, tick * second);
            assert_eq!(timeline.instant(timeline.now_s()), now * second);
            assert!(tick == 0 || timeline.instant(timeline.now_s() - 0.5) == now * second - second / 2);
        }
        let close = |now: f64, expected: f64| {
            let found = timeline.motion_s((now * second as f64) as u64);
            assert!((found - expected).abs() < 1e-9, "{now}: {found}");
        };
        close(9.0, 0.0);
        close(10.5, 0.5);
        // At rest.
        close(15.0, 2.0);
        close(20.25, 2.25);
        // From here on it is the next start's.
        close(25.0, 3.0);
        close(30.5, 3.5);
        close(99.0, 4.0);
    }
}
