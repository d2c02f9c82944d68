//! Shifts of z (M290) as inputs: recorded with the tick at which each began, and made again at the same ticks.
//!
//! When a shift begins depends on when its line came. So a program and its recorded shifts together make the same steps
//! again, whoever sent the lines.

use corehbot::status::Status;
use std::collections::VecDeque;

/// A shift of z.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ZShift {
    /// Motion time at which it begins, in ticks.
    pub tick: u64,
    /// How far z moves, in steps.
    pub steps: i32,
    /// Its greatest speed in steps a tick, and its acceleration in steps a tick squared.
    pub limits: [f32; 2],
}

/// The generator is told of a shift so many ticks ahead, because it counts in 32 bits.
const AHEAD: u64 = 1 << 30;

/// Shifts that were made, and those to be made again.
#[derive(Default)]
pub struct ZShifts {
    /// In the order in which they began.
    pub made: Vec<ZShift>,
    /// Those that have not begun.
    pub again: VecDeque<ZShift>,
    /// The changes that are in `made`.
    seen: u32,
}

impl ZShifts {
    /// To be made again.
    pub fn again(shifts: impl IntoIterator<Item = ZShift>) -> Self {
        Self { again: shifts.into_iter().collect(), ..Self::default() }
    }

    /// The way of all shifts that were made, up and down, in steps.
    pub(super) fn way(&self) -> f64 {
        self.made.iter().map(|shift| f64::from(shift.steps.unsigned_abs())).sum()
    }

    /// A new life of the board counts from 0.
    pub(super) const fn restart(&mut self) {
        self.seen = 0;
    }

    /// Records a shift that has begun, and orders the next one of those to be made again. Call it after each turn of
    /// the generator, with the present motion time.
    pub(super) fn attend(&mut self, status: &Status, now: u64) {
        let (changes, tick, steps, limits) = status.z_offset().last_change();
        if changes != self.seen {
            self.seen = changes;
            let ahead = tick.wrapping_sub(now as u32).cast_signed();
            self.made.push(ZShift { tick: now.saturating_add_signed(ahead.into()), steps, limits });
        }
        if !status.z_offset().is_replaying()
            && let Some(next) = self.again.pop_front_if(|next| next.tick < now + AHEAD)
        {
            status.z_offset().replay(next.tick as u32, next.steps, next.limits);
        }
    }
}
