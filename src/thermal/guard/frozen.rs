//! A reading that does not change after the heater power changed is invalid: the converter, or its input, has stopped.

use super::{Alarm, Floor};
use crate::fault::Cause;
use crate::units::Celsius;

/// Least movement of a valid reading, by noise or by temperature: a third of a 12-bit step of a hot hotend.
const STILL: Celsius = Celsius::lit("0.02");

/// A change of the duty that any heater's temperature follows.
const CHANGE: u16 = u16::MAX / 5;

/// So near to its target a heater is held. A good controller moves the reading by less than [`STILL`] then, and a bed
/// may need more than half of its power (120 W at 0.85 W/K: 63 % at 99 C).
const HELD: Celsius = Celsius::const_from_int(1);

/// The guard of a reading.
#[derive(Clone, Copy, Debug)]
pub struct Frozen {
    least: Celsius,
    most: Celsius,
    /// The smallest and the greatest mean duty since then.
    duties: [u16; 2],
    /// The duty, averaged over about a second.
    mean: u32,
    /// Periods since the power has changed.
    still: u32,
}

impl Default for Frozen {
    fn default() -> Self {
        Self::new()
    }
}

impl Frozen {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { least: Celsius::MAX, most: Celsius::MIN, duties: [u16::MAX, 0], mean: 0, still: 0 }
    }

    /// Follows a control period of a heater that is to hold a temperature, if it is.
    pub fn look(&mut self, floor: &Floor, hold: Option<Celsius>, measured: Celsius, duty: u16) -> Option<Alarm> {
        self.mean = self.mean - (self.mean >> 6) + u32::from(duty);
        let mean = (self.mean >> 6) as u16;
        (self.least, self.most) = (self.least.min(measured), self.most.max(measured));
        self.duties = [self.duties[0].min(mean), self.duties[1].max(mean)];
        if self.most.saturating_sub(self.least) > STILL {
            *self = Self { least: measured, most: measured, duties: [mean; 2], mean: self.mean, still: 0 };
            return None;
        }
        let is_held = hold.is_some_and(|target| target.saturating_sub(measured).saturating_abs() <= HELD);
        // Where it is held, the power falls while it settles, and the reading may stay: only more power must show.
        let from = if is_held { mean } else { self.duties[1] };
        let change = from.saturating_sub(self.duties[0]);
        let is_heated = mean > u16::MAX / 2 && (!is_held || (change > CHANGE / 2 && !floor.holds_still));
        let has_changed = change > CHANGE || is_heated;
        // A constant reading before the power changed means nothing: a cold bed may read the same for hours.
        self.still = if has_changed { self.still.saturating_add(1) } else { 0 };
        let is_frozen = self.still >= floor.still;
        is_frozen.then_some(Alarm { cause: Cause::SensorFrozen, value: measured, limit: STILL })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::Heater;

    fn look(guard: &mut Frozen, measured: Celsius, duty: u16) -> Option<Alarm> {
        guard.look(Floor::of(Heater::Hotend), None, measured, duty)
    }

    #[test]
    fn a_reading_that_stands_still_is_found_and_a_quiet_one_is_not() {
        let at = Celsius::from_num(200);
        let mut guard = Frozen::new();
        let found = (0..3000u32).find(|n| look(&mut guard, at, if *n < 500 { 20_000 } else { 40_000 }).is_some());
        assert!(found.is_some_and(|n| (500..=2100).contains(&n)), "{found:?}");
        let mut guard = Frozen { mean: 20_000 << 6, ..Frozen::new() };
        assert!((0..100_000).all(|_| look(&mut guard, at, 20_000).is_none()), "nothing changes at all");
        let mut guard = Frozen::new();
        let noise = |n: u32| at + Celsius::lit("0.03") * (n % 100 / 99) as i32;
        assert!(
            (0..100_000u32).all(|n| look(&mut guard, noise(n), if n % 3000 < 1500 { 0 } else { 60_000 }).is_none())
        );
        let mut guard = Frozen::new();
        assert!((0..2000).any(|_| look(&mut guard, at, 65_535).is_some()), "full power, and it does not warm");
    }

    /// Reproducer: a bed that held 99 C with 63 % of its power, and a converter without noise.
    #[test]
    fn a_weak_bed_that_is_held_is_not_frozen() {
        let (floor, at) = (Floor::of(Heater::Bed), Celsius::from_num(99));
        let duty = u16::MAX / 100 * 63;
        let alarms = |target: i32| {
            let mut guard = Frozen { mean: u32::from(duty) << 6, ..Frozen::new() };
            (0..100_000).any(|_| guard.look(floor, Some(Celsius::from_num(target)), at, duty).is_some())
        };
        assert!(!alarms(99) && !alarms(100));
        assert!(alarms(101), "it is to warm, has power, and does not");
    }

    /// Reproducer: a hotend that settled at its target within 0.02 C while the controller took its power back.
    #[test]
    fn a_hotend_that_settles_is_not_frozen_and_one_with_more_power_is() {
        let at = Celsius::from_num(142);
        let alarms = |first: u16, then: u16| {
            let mut guard = Frozen { mean: u32::from(first) << 6, ..Frozen::new() };
            (0..100_000).any(|n| {
                let duty = if n < 50 { first } else { then };
                guard.look(Floor::of(Heater::Hotend), Some(at), at, duty).is_some()
            })
        };
        assert!(!alarms(30_000, 15_000) && alarms(10_000, 25_000));
        assert!(!alarms(40_000, 40_000) && alarms(30_000, 40_000), "much power is none of its own");
    }

    /// Reproducer: a converter without noise, and a bed that had been cold for a while, which counted as frozen at
    /// once.
    #[test]
    fn what_stood_still_before_the_power_came_does_not_count() {
        let mut guard = Frozen::new();
        let cold = Celsius::from_num(25);
        assert!((0..100_000).all(|_| look(&mut guard, cold, 0).is_none()));
        assert_eq!((0..1000).find(|_| look(&mut guard, cold, u16::MAX).is_some()), None, "20 s at full power");
        assert!((0..1000).any(|_| look(&mut guard, cold, u16::MAX).is_some()));
    }
}
