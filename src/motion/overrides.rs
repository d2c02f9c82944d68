//! Overrides: the feed and the flow, changed from outside, also for moves that wait in the look-ahead.
//!
//! What has left the look-ahead keeps its speed and its filament; that is 50 ms of motion, and the move under way.

use super::planner::Planner;
use super::window::Planned;
use crate::settings::Settings;
use crate::units::{Mm, MmPerSec, Steps, mul_div};

/// A speed under an override.
pub(super) fn percent_of(speed: MmPerSec, percent: u16) -> MmPerSec {
    let bits = u64::from(speed.to_bits()) * u64::from(percent) / 100;
    MmPerSec::from_bits(bits.min(u64::from(u32::MAX)) as u32)
}

impl Planner {
    /// Feed override, in percent.
    #[must_use]
    pub const fn feed_percent(&self) -> u16 {
        self.feed_percent
    }

    /// Changes the feed override (M220), also for the moves that wait.
    pub fn override_feed(&mut self, percent: u16, settings: &Settings) {
        if core::mem::replace(&mut self.feed_percent, percent) != percent {
            self.change(settings, |_| {});
        }
    }

    /// Changes the filament of the moves that wait from one flow override to another, in percent (M221), and says by
    /// how much that moves their end. Retractions keep their lengths.
    pub fn override_flow(&mut self, from: u16, to: u16, settings: &Settings) -> Mm {
        if from == 0 || from == to {
            return Mm::ZERO;
        }
        let (from, to) = (u64::from(from), u64::from(to));
        let (mut before, mut after) = (self.gone, self.gone);
        self.change(settings, |planned| {
            let [_, _, _, e] = &mut planned.end;
            let way = e.wrapping_sub(before).to_bits();
            let scaled = |n: i64| mul_div(n.unsigned_abs(), to, from).min(i64::MAX as u64) as i64 * n.signum();
            let is_fixed = planned.feed == MmPerSec::ZERO || planned.vector.is_extruder_only();
            let way = if is_fixed { way } else { scaled(way) };
            before = *e;
            after = after.wrapping_add(Steps::from_bits(way));
            *e = after;
            if !is_fixed {
                planned.vector.extrusion = scaled(planned.vector.extrusion);
            }
            if to > from {
                // The jumps in the extruder's speed grow with the flow, and the corner may be limited by its jump.
                planned.corner = mul_div(mul_div(planned.corner, from, to), from, to);
            }
        });
        let moved = after.wrapping_sub(before);
        let [_, _, _, e] = &mut self.end;
        *e = e.wrapping_add(moved);
        let moved = self.pitch[3].mm_bits(moved);
        let [_, _, _, e] = &mut self.asked;
        *e = e.wrapping_add(Mm::from_bits(moved));
        Mm::from_bits(moved)
    }

    /// Has `change` change every move that waits, and plans them anew with the overrides as they are now.
    fn change(&mut self, settings: &Settings, mut change: impl FnMut(&mut Planned)) {
        let percent = self.feed_percent;
        self.window.change(|planned| {
            change(planned);
            if planned.feed > MmPerSec::ZERO {
                planned.set_nominal(percent_of(planned.feed, percent), settings);
            }
        });
        self.waiting = self.window.time();
        if let Some(last) = self.window.last() {
            self.last = (last.vector, last.passed_on());
        }
    }
}
