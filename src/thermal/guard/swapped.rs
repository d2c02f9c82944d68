//! A heater must warm its own sensor. If another one follows it, plugs are swapped, and the heater would run away while
//! the wrong sensor stays cold.
//!
//! A pair of a heater and another one's sensor is meaningful in two cases:
//!
//! - The other heater has no power, and none of its heat is under way: only this heater can warm it.
//! - A hotend heats from the cold at full power together with a bed or a chamber, in any state. They are slower. 1 kW
//!   in a bed of 500 J/K, which is too light for a plate, makes 2 K/s after its mat's lag. And 25 W in a hotend of 34
//!   J/K make 0.7 K/s. The hotend's own sensor has risen by a quarter of it in any case.

use super::{Alarm, Episode, periods};
use crate::fault::Cause;
use crate::units::Celsius;

/// Rise of the other sensor that is an alarm if its own has not risen by a quarter of it.
const RISE: Celsius = Celsius::const_from_int(6);

/// The guard covers the first seconds of a heating; later, a hot nozzle warms a bed near it.
const FIRST_S: u32 = 60;

/// The guard of a pair, a heater that heats and the sensor of another one: an episode while the pair is meaningful.
#[derive(Clone, Copy, Debug)]
pub struct Swapped(Episode<(), Begun>);

/// The readings when the heating began.
#[derive(Clone, Copy, Debug)]
struct Begun {
    own: Celsius,
    other: Celsius,
    heated: u32,
}

impl Default for Swapped {
    fn default() -> Self {
        Self::new()
    }
}

impl Swapped {
    /// No heater heats yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(Episode::none())
    }

    /// Follows a control period; `tells` if the pair is meaningful now.
    pub fn look(&mut self, tells: bool, own: Celsius, other: Celsius) -> Option<Alarm> {
        let begun = self.0.follow(tells.then_some(()), || Begun { own, other, heated: 0 })?;
        begun.heated = begun.heated.saturating_add(1);
        let (rise, other_rise) = (own.saturating_sub(begun.own), other.saturating_sub(begun.other));
        let is_swapped = begun.heated < periods(FIRST_S) && other_rise > RISE && rise < RISE / 4;
        is_swapped.then_some(Alarm { cause: Cause::SensorsSwapped, value: rise, limit: other_rise })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wrong_sensor_gives_it_away() {
        let c = |degrees: f64| Celsius::from_num(degrees);
        let mut guard = Swapped::new();
        let found = (0..1000).find(|n| guard.look(true, c(25.0), c(25.0 + 0.06 * f64::from(*n))).is_some());
        assert_eq!(found, Some(101));
        let mut guard = Swapped::new();
        assert!((0..1000).all(|n| guard.look(true, c(25.0 + 0.06 * f64::from(n)), c(25.0)).is_none()));
        let mut guard = Swapped::new();
        assert!((0..1000).all(|n| guard.look(false, c(25.0), c(25.0 + 0.06 * f64::from(n))).is_none()));
    }
}
