//! A reading that does not change after the heater power changed is invalid: the converter, or its input, has stopped.

use super::{Alarm, Floor};
use crate::fault::Cause;
use crate::units::Celsius;

/// Least movement of a valid reading, by noise or by temperature: a third of a 12-bit step of a hot hotend.
const STILL: Celsius = Celsius::lit("0.02");

/// A change of the duty that any heater's temperature follows.
const CHANGE: u16 = u16::MAX / 5;

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

    /// Follows a control period.
    pub fn look(&mut self, floor: &Floor, measured: Celsius, duty: u16) -> Option<Alarm> {
        self.mean = self.mean - (self.mean >> 6) + u32::from(duty);
        let mean = (self.mean >> 6) as u16;
        (self.least, self.most) = (self.least.min(measured), self.most.max(measured));
        self.duties = [self.duties[0].min(mean), self.duties[1].max(mean)];
        if self.most.saturating_sub(self.least) > STILL {
            *self = Self { least: measured, most: measured, duties: [mean; 2], mean: self.mean, still: 0 };
            return None;
        }
        let has_changed = self.duties[1].saturating_sub(self.duties[0]) > CHANGE || mean > u16::MAX / 2;
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
        guard.look(Floor::of(Heater::Hotend), measured, duty)
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
