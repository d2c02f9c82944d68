//! Idle timeout: motors lose power when nothing has moved for long enough (M84 S).

use crate::units::Instant;

/// Motors lose power when nothing has moved for this long, unless M84 S says otherwise; Klipper's
/// idle_timeout is as long.
const IDLE_TIMEOUT_S: u32 = 600;

/// In a print they keep power for as long as a host may pause in silence: 12 hours, as owners set Klipper's
/// idle_timeout while a print is paused. After that the print counts as abandoned.
const PRINT_TIMEOUT_S: u32 = 12 * 3600;

/// The time for which motors keep their power without motion.
#[derive(Debug)]
pub(in crate::machine) struct IdleTimeout {
    /// 0 is for ever.
    timeout_s: u32,
    last_motion: Instant,
}

impl IdleTimeout {
    pub const fn new(now: Instant) -> Self {
        Self { timeout_s: IDLE_TIMEOUT_S, last_motion: now }
    }

    /// M84 S. The time starts again.
    pub const fn set(&mut self, timeout_s: u32, now: Instant) {
        (self.timeout_s, self.last_motion) = (timeout_s, now);
    }

    /// Something moves, or is about to.
    pub const fn note_motion(&mut self, now: Instant) {
        self.last_motion = now;
    }

    /// Whether nothing has moved for as long as motors keep their power; in a print for longer.
    pub fn is_over(&self, now: Instant, is_printing: bool) -> bool {
        let least_s = if is_printing { PRINT_TIMEOUT_S } else { 0 };
        self.timeout_s > 0 && now >= self.last_motion.after_ms(self.timeout_s.max(least_s).saturating_mul(1000))
    }
}
