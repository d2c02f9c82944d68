//! Heat that arrives in a hotend's block shows within seconds. If much of it is suddenly missing, the sensor has left
//! its hole, the cartridge has, or the power is gone. This takes seconds, where the floor and the balance need 20.
//!
//! It compares the two sums of heat ([`HeatSums`]), which forget within 3 s.
//!
//! ```text
//!   given  ______/~~~~~~~~~~~~     while it heats, the part that shows is learned: `shown`
//!   found  ______/~~~~~~~~\___     then six tenths of it are missing: alarm
//! ```
//!
//! A model that is wrong, a weak supply or a heavy block make that part smaller from the begin, so it is learned at
//! more than half of the power and only grows. So this guard compares a heater with itself: it tells what has changed
//! since a heating, and nothing about a heater that never was better. That is the floor's and the balance's.
//!
//! Of a model under which more heat shows than was given, by three quarters, nothing is believed.

use super::Alarm;
use super::heat_balance::Numbers;
use super::heat_sums::HeatSums;
use crate::fault::Cause;
use crate::thermal::fixed_point::{rise, times};
use crate::units::{Celsius, Power};
use fixed::types::I16F16;

/// Time within which a sum is forgotten, in periods.
const MEMORY: i32 = HeatSums::memory(true);

/// So much of what has shown may be missing of full power: a supply that falls by 30 % and a draught of 1.6 times the
/// losses, both at once, take half of 40 W.
const MOST: I16F16 = I16F16::lit("0.6");

/// Less is noise, or a gust.
const LEAST: Celsius = Celsius::const_from_int(3);

/// Growth of the learned part in a period: it follows within a second.
const STEP: I16F16 = I16F16::lit("0.015625");

/// More of the heat than this shows only under a model that is wrong.
const NONSENSE: I16F16 = I16F16::lit("1.75");

/// Less of it than this does not tell a heater from noise.
const FAINT: I16F16 = I16F16::lit("0.25");

/// The guard of a hotend's heat.
#[derive(Clone, Copy, Debug)]
pub struct MissingHeat {
    /// The greatest part of the given heat that has shown.
    shown: I16F16,
}

impl Default for MissingHeat {
    fn default() -> Self {
        Self::new()
    }
}

impl MissingHeat {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { shown: I16F16::ZERO }
    }

    /// The part of the given heat that has shown since the start, if the heater has heated and its model is no
    /// nonsense.
    pub fn shown(&self) -> Option<I16F16> {
        (self.shown >= FAINT && self.shown <= NONSENSE).then_some(self.shown)
    }

    /// Follows a control period: whether the heater holds a target, both sums of heat, and the given power.
    pub fn look(&mut self, n: &Numbers, holds: bool, sums: &HeatSums, power: Power) -> Option<Alarm> {
        // Only at more than half of its power: what is missing of less is smaller than the model's error.
        if !holds || power < n.most / 2 {
            return None;
        }
        let found = sums.found();
        let full = rise(n.most, n.warming).saturating_mul_int(MEMORY);
        if found > times(sums.given, NONSENSE).saturating_add((full / 4).max(LEAST)) {
            self.shown = I16F16::MAX;
        } else if sums.given > full / 2 && found > times(sums.given, self.shown) {
            self.shown = self.shown.saturating_add(STEP);
        }
        let shown = self.shown()?.min(I16F16::ONE);
        let expected = times(sums.given, shown);
        let limit = expected.saturating_sub(times(full, shown * MOST).max(LEAST));
        (found < limit).then_some(Alarm { cause: Cause::HeatMissing, value: found, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::{Output, Sensor};
    use crate::settings::HeaterSettings;
    use crate::thermal::guard::{HeatBalance, Seen};
    use crate::units::Ratio;
    use fixed::types::I8F24;

    /// A block behind one lag, with a share of the model's mass, heated to 215 C and held there by the power that this
    /// takes.
    struct Block {
        guard: MissingHeat,
        sums: HeatSums,
        numbers: Numbers,
        mass: f64,
        arriving: f64,
        celsius: f64,
        /// What the sensor shows of it, and the part of the power that the heater gives.
        shows: f64,
        gives: f64,
        reading: f64,
        smooth: f64,
    }

    impl Block {
        fn new(mass: f64) -> Self {
            let settings = HeaterSettings::hotend(Output::He0, Sensor::Hotend0);
            let numbers = *HeatBalance::new(&settings, true).numbers();
            let at = 25.0;
            Self {
                guard: MissingHeat::new(),
                sums: HeatSums::new(),
                numbers,
                mass,
                arriving: 0.0,
                celsius: at,
                shows: 1.0,
                gives: 1.0,
                reading: at,
                smooth: at,
            }
        }

        /// Seconds until an alarm at this power, at most `seconds`.
        fn heat(&mut self, watt: impl Fn(f64) -> f64, seconds: f64) -> Option<f64> {
            let leaving = self.numbers.leaving(Ratio::ZERO, I8F24::ZERO);
            (0..(seconds * 50.0) as u32).find_map(|n| {
                let watt = watt(self.reading);
                self.arriving += (self.gives * watt - self.arriving) / 120.0;
                self.celsius += (self.arriving - 0.075 * (self.celsius - 25.0)) / (10.8 * self.mass * 50.0);
                self.reading += (25.0 + self.shows * (self.celsius - 25.0) - self.reading) / 60.0;
                self.smooth += (self.reading - self.smooth) / 16.0;
                let [measured, smooth] = [self.reading, self.smooth].map(Celsius::from_num);
                let seen = Seen { smooth, duty: 1, ..Seen::quiet(measured) };
                let power = Power::from_num(watt);
                self.sums.follow(&self.numbers, true, &seen, power, leaving);
                let found = self.guard.look(&self.numbers, true, &self.sums, power);
                found.map(|_| f64::from(n) / 50.0)
            })
        }
    }

    /// Full power up to the target, and what holds it.
    fn hold(reading: f64) -> f64 {
        (14.25 + 9.0 * (215.0 - reading)).clamp(0.0, 40.0)
    }

    #[test]
    fn most_of_the_heat_is_missing_within_seconds_of_a_sensor_that_leaves() {
        for mass in [0.7, 1.0, 1.4, 3.0] {
            let mut block = Block::new(mass);
            assert_eq!(block.heat(hold, 400.0), None, "{mass}");
            block.shows = 0.0;
            let found = block.heat(hold, 60.0);
            assert!(found.is_some_and(|seconds| seconds < 4.0), "{mass}: {found:?}");
        }
    }

    #[test]
    fn what_never_was_better_is_no_sudden_loss() {
        // Half of the power from the begin.
        let mut block = Block { gives: 0.5, ..Block::new(1.0) };
        assert_eq!(block.heat(hold, 400.0), None);
        // A model of twenty times the mass is nonsense, and nothing is told by it.
        let mut block = Block::new(0.05);
        assert_eq!(block.heat(hold, 100.0), None);
        block.shows = 0.0;
        assert_eq!((block.heat(hold, 20.0), block.guard.shown()), (None, None));
    }
}
