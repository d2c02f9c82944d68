//! PTC: how much less power a hot heater has, found on the way up at full power.
//!
//! The power is P0 / (1 + a x), where x is the temperature above 25 C. Two parts of the way up give a heat capacity
//! each: heat that was given, less losses, over the rise. The losses come from the swings at the target, whose power
//! depends on a too. With the right a both capacities are equal. With a smaller one the power of the hotter part counts
//! as too much, and that part seems heavier. So a is found by bisection.
//!
//! The sensor is late by the same time at both ends of a part, so the lag hardly counts. Slopes instead of heat would
//! not do: they find 0.0028 in a heater without PTC.

use super::swings::Swings;
use super::{RATE, above_room};
use crate::settings::ranges;
use crate::units::Celsius;

/// Where the parts begin and end, in 256ths of the way: 20, 55 and 97 %.
const MARKS: [i64; 3] = [51, 141, 248];

/// A smaller growth is none, in bits of a [`crate::units::Ratio`]: noise and radiation give as much (0.0003).
const LEAST: i64 = 20;

/// The two parts of a way up.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WayUp {
    /// Marks that were reached.
    reached: usize,
    /// The reading at each.
    at: [Celsius; MARKS.len()],
    parts: [Part; 2],
}

/// A part of the way.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    periods: i64,
    /// Sum of the temperature above the room, in K periods with 8 fractional bits.
    warmth: i64,
}

/// The part of its power that a heater with a growth of `ptc` has so far above 25 C, in K with 8 fractional bits. Both
/// `ptc` and the part have 16.
pub(super) fn power_left(ptc: i64, above: i64) -> i64 {
    (1 << 32) / ((1 << 16) + ((ptc * above) >> 8)).max(1)
}

impl WayUp {
    /// Follows a period at full power that has gone `gone` of `way`, in the same unit.
    pub fn follow(&mut self, measured: Celsius, gone: i64, way: i64) {
        if MARKS.get(self.reached).is_some_and(|mark| gone * 256 >= way * mark) {
            if let Some(place) = self.at.get_mut(self.reached) {
                *place = measured;
            }
            self.reached += 1;
        }
        if let Some(part) = self.reached.checked_sub(1).and_then(|part| self.parts.get_mut(part)) {
            part.periods += 1;
            part.warmth += above_room(measured);
        }
    }

    /// The growth of a heater of `power` at 25 C, in W with 20 fractional bits; 0 if it has none.
    pub fn ptc(&self, power: i64, still: &Swings) -> Option<i64> {
        let [first, second] = self.parts;
        let [a, b, c] = self.at;
        if first.periods == 0 || second.periods == 0 || self.reached < MARKS.len() {
            return Some(0);
        }
        let (mut low, mut high) = (0, i64::from(ranges::PTC.most.to_bits()));
        while high - low > 1 {
            let middle = i64::midpoint(low, high);
            let loss = still.loss((power * power_left(middle, still.above_room())) >> 16)?;
            let is_too_small =
                first.capacity(power, middle, loss, [a, b]) < second.capacity(power, middle, loss, [b, c]);
            (low, high) = if is_too_small { (middle, high) } else { (low, middle) };
        }
        Some(if low < LEAST { 0 } else { low })
    }
}

impl Part {
    /// The heat capacity, in J/K with 16 fractional bits, with these losses in W/K with 24.
    fn capacity(&self, power: i64, ptc: i64, loss: i64, [from, to]: [Celsius; 2]) -> i64 {
        let left = power_left(ptc, self.warmth / self.periods.max(1));
        let given = ((power * left) >> 16) * self.periods / i64::from(RATE);
        let lost = (loss * (self.warmth / i64::from(RATE))) >> 12;
        (given.saturating_sub(lost) << 16) / i64::from(to.saturating_sub(from).to_bits()).max(1)
    }
}
