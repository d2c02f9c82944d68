//! A heater must warm its own sensor. If another one follows it, plugs are swapped, and the heater would run away while the wrong
//! sensor stays cold.

use super::{Alarm, periods};
use crate::fault::Cause;
use crate::units::Celsius;

/// So much another sensor must have risen, and its own not even by a quarter of it.
const RISE: Celsius = Celsius::const_from_int(6);

/// The guard looks at the first seconds of a heating; later, a hot nozzle warms a bed near it.
const FIRST_S: u32 = 60;

/// The guard of a pair: a heater that heats, and the sensor of another one that does not.
#[derive(Clone, Copy, Debug, Default)]
pub struct Swapped {
    /// Own and other temperature when the heating began.
    begun: Option<[Celsius; 2]>,
    heated: u32,
}

impl Swapped {
    /// Nothing heats yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { begun: None, heated: 0 }
    }

    /// Looks at a control period. `heats` if this heater warms up, at more than half of its power, and the other one has none.
    pub fn look(&mut self, heats: bool, own: Celsius, other: Celsius) -> Option<Alarm> {
        if !heats {
            if self.heated > 0 {
                *self = Self::new();
            }
            return None;
        }
        self.heated = self.heated.saturating_add(1);
        let [own_then, other_then] = *self.begun.get_or_insert([own, other]);
        let (rise, other_rise) = (own.saturating_sub(own_then), other.saturating_sub(other_then));
        let is_swapped = self.heated < periods(FIRST_S) && other_rise > RISE && rise < RISE / 4;
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
