//! A hotend that is off cools as it must. A switch that leaks a part of the power holds it warm, and a hotend that
//! holds 120 C for ever is hot when somebody touches it, and burns when somebody leaves.
//!
//! While it cools, the heat that leaves the block is the heat that the block gives up. If much less is given up than
//! leaves, something heats it. Both are sums that forget within a minute. The model's losses may be wrong, so 5 W and
//! six tenths of the losses must be missing. The capacity is the one that the last heating has shown
//! ([`MissingHeat::shown`](super::MissingHeat::shown)); without such a heating there is no alarm.

use super::heat_balance::Numbers;
use super::{Alarm, Episode, Seen, periods};
use crate::fault::Cause;
use crate::thermal::fixed_point::{driven, rise, times};
use crate::thermal::room::ROOM;
use crate::units::{Celsius, Power};
use fixed::types::{I8F24, I16F16};

/// Time within which a sum is forgotten, in periods.
const MEMORY: i32 = periods(60).cast_signed();

/// Time after the arrival of all heat before anything counts, and time for which it must be found, in s.
const BEGIN_S: u32 = 48;
const FOUND_S: u32 = 30;

/// Least power that is a leak.
const LEAK: Power = Power::const_from_int(5);

/// Least part of the losses that a leak makes up for.
const PART: I16F16 = I16F16::lit("0.6");

/// Below this nothing burns, ...
const WARM: Celsius = Celsius::const_from_int(60);

/// ... and a neighbour warms it so near to its own temperature.
const NEAR: Celsius = Celsius::const_from_int(15);

/// The guard of a hotend that is off: an episode from the arrival of all heat to the next power.
#[derive(Clone, Copy, Debug)]
pub struct Leak(Episode<(), Cooling>);

/// What was seen while it cools.
#[derive(Clone, Copy, Debug)]
struct Cooling {
    periods: u32,
    before: Celsius,
    /// Rise of the reading, and the fall that its losses would make.
    rise: Celsius,
    lost: Celsius,
    found: u32,
}

impl Default for Leak {
    fn default() -> Self {
        Self::new()
    }
}

impl Leak {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(Episode::none())
    }

    /// Follows a control period: the part of the heat that has shown, the readings, and the heat that leaves for a K.
    pub fn look(&mut self, n: &Numbers, shown: Option<I16F16>, seen: &Seen, leaving: I8F24) -> Option<Alarm> {
        let begin = || Cooling { periods: 0, before: seen.smooth, rise: Celsius::ZERO, lost: Celsius::ZERO, found: 0 };
        let shown = shown?;
        let cooling = self.0.follow(seen.is_settled.then_some(()), begin)?;
        cooling.periods = cooling.periods.saturating_add(1);
        let before = core::mem::replace(&mut cooling.before, seen.smooth);
        let lost = rise(driven(seen.smooth.saturating_sub(ROOM), leaving), n.warming);
        cooling.rise =
            cooling.rise.saturating_add(seen.smooth.saturating_sub(before)).saturating_sub(cooling.rise / MEMORY);
        cooling.lost = cooling.lost.saturating_add(lost).saturating_sub(cooling.lost / MEMORY);
        let is_warm = seen.smooth > WARM && seen.smooth > seen.warmed_to.saturating_add(NEAR);
        if cooling.periods < periods(BEGIN_S) || !is_warm {
            cooling.found = 0;
            return None;
        }
        // A block of more J/K than its model falls by less: both are of a block of the model's.
        let losses = times(cooling.lost, shown);
        let excess = cooling.rise.saturating_add(losses);
        let least = times(rise(LEAK, n.warming).saturating_mul_int(MEMORY), shown).max(times(losses, PART));
        cooling.found = if excess > least { cooling.found + 1 } else { 0 };
        let limit = seen.measured.saturating_sub(excess);
        let alarm = Alarm { cause: Cause::StaysWarm, value: seen.measured, limit };
        (cooling.found >= periods(FOUND_S)).then_some(alarm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::{Output, Sensor};
    use crate::settings::HeaterSettings;
    use crate::thermal::guard::HeatBalance;
    use crate::units::Ratio;

    /// Seconds until the alarm of a block that cools from 215 C in a room of `room` C, with a leak. Its mass is a
    /// multiple of the model's, its losses another.
    fn run(mass: f64, loss: f64, leak: f64, room: f64, warmed_to: i32) -> Option<u32> {
        let settings = HeaterSettings::hotend(Output::He0, Sensor::Hotend0);
        let numbers = *HeatBalance::new(&settings, true).numbers();
        let leaving = numbers.leaving(Ratio::ZERO, I8F24::ZERO);
        let (mut guard, mut celsius) = (Leak::new(), 215.0);
        let shown = Some(I16F16::from_num(1.0 / mass));
        (0..1_800 * 50).find_map(|n| {
            celsius += (leak - 0.075 * loss * (celsius - room)) / (10.8 * mass * 50.0);
            let warmed_to = Celsius::const_from_int(warmed_to);
            let seen = Seen { is_settled: true, warmed_to, ..Seen::quiet(Celsius::from_num(celsius)) };
            guard.look(&numbers, shown, &seen, leaving).map(|_| n / 50)
        })
    }

    #[test]
    fn a_switch_that_leaks_is_found_within_two_minutes() {
        for mass in [0.7, 1.0, 1.4] {
            for leak in [8.0, 12.0] {
                let found = run(mass, 1.0, leak, 25.0, 60);
                assert!(found.is_some_and(|seconds| seconds < 180), "{mass} {leak}: {found:?}");
            }
        }
    }

    #[test]
    fn a_hotend_that_cools_is_no_leak() {
        for mass in [0.6, 1.0, 3.0] {
            for loss in [0.6, 1.0, 2.5] {
                for room in [5.0, 25.0, 45.0] {
                    assert_eq!(run(mass, loss, 0.0, room, 20), None, "{mass} {loss} {room}");
                }
            }
        }
        // A bed of 110 C warms it to 90 C.
        assert_eq!(run(1.0, 1.0, 5.2, 25.0, 110), None);
    }
}
