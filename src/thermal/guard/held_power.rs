//! The power that holds a target, against the model: 2 is twice as much.
//!
//! It is the given heat over the found one ([`HeatSums`]), each averaged over two cycles of the
//! dither. A draught doubles it too, so by itself it proves nothing.

use super::heat_sums::HeatSums;
use super::response::{BITS, FINER, Ratio8};

/// Cycles before it counts.
const FIRST: u8 = 3;

/// Added to the found heat, a hundredth of full power: near the room everything is small.
const LEAST: i32 = 100;

/// The held power of a heater.
#[derive(Clone, Copy, Debug, Default)]
pub struct HeldPower {
    /// Sums of this cycle.
    sums: [i32; 2],
    /// Their averages over cycles: given and found heat.
    given: i32,
    found: i32,
    cycles: u8,
}

impl HeldPower {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { sums: [0; 2], given: 0, found: 0, cycles: 0 }
    }

    /// Follows a control period.
    pub fn follow(&mut self, sums: &HeatSums) {
        for (sum, part) in self.sums.iter_mut().zip([sums.given, sums.found()]) {
            *sum = sum.saturating_add(part.to_bits() >> FINER);
        }
    }

    /// The end of a cycle, which counts if it was near the target.
    pub fn end(&mut self, counts: bool) {
        let [given, found] = core::mem::take(&mut self.sums);
        if !counts {
            return;
        }
        let over = if self.cycles == 0 { 1 } else { 2 };
        self.given = self.given.saturating_add(given.saturating_sub(self.given) / over);
        self.found = self.found.saturating_add(found.saturating_sub(self.found) / over);
        self.cycles = self.cycles.saturating_add(1);
    }

    /// How many times as much power it takes; `full` is the given heat of full power.
    #[must_use]
    pub fn more(&self, full: i32) -> Option<Ratio8> {
        if self.cycles < FIRST {
            return None;
        }
        let found = self.found.max(0).saturating_add(full / LEAST).max(1);
        let more = (i64::from(self.given.max(0)) << BITS) / i64::from(found);
        Some(Ratio8::try_from(more).unwrap_or(Ratio8::MAX))
    }
}
