//! A temperature that was reached is kept; above it, there is no power.

use super::{Alarm, periods};
use crate::fault::Cause;
use crate::settings::Guards;
use crate::units::Celsius;

/// So close it counts as reached.
const REACHED: Celsius = Celsius::const_from_int(2);

/// Periods above the limit without power that are a stuck switch.
const OVER_S: u32 = 5;

/// The guard of a heater with a target.
#[derive(Clone, Copy, Debug)]
pub struct AtTarget {
    guards: Guards,
    target: Celsius,
    is_reached: bool,
    /// The hottest since there is a target, while it cools down to a lower one.
    comes_down_from: Celsius,
    far: u32,
    over: u32,
}

impl AtTarget {
    /// No target yet.
    #[must_use]
    pub const fn new(guards: Guards) -> Self {
        let (target, comes_down_from) = (Celsius::ZERO, Celsius::MIN);
        Self { guards, target, is_reached: false, comes_down_from, far: 0, over: 0 }
    }

    /// Other thresholds.
    pub const fn configure(&mut self, guards: Guards) {
        self.guards = guards;
    }

    /// Looks at a control period of a heater that has a target; `is_powered` if it was given any power.
    pub fn look(&mut self, target: Celsius, measured: Celsius, is_powered: bool) -> Option<Alarm> {
        if target != self.target {
            (self.target, self.is_reached, self.far, self.over) = (target, false, 0, 0);
            self.comes_down_from = measured;
        }
        // Coming down from a higher target it is above, rightly, as long as it falls.
        self.comes_down_from = self.comes_down_from.min(measured);
        self.is_reached |= magnitude(measured, target) <= REACHED;
        self.lost(measured).or_else(|| self.overshoot(measured, is_powered))
    }

    fn lost(&mut self, measured: Celsius) -> Option<Alarm> {
        let limit = self.target.saturating_sub(self.guards.lost);
        self.far = if self.is_reached && measured < limit { self.far + 1 } else { 0 };
        let is_lost = self.far >= periods(self.guards.lost_s.into());
        is_lost.then_some(Alarm { cause: Cause::TemperatureLost, value: measured, limit })
    }

    fn overshoot(&mut self, measured: Celsius, is_powered: bool) -> Option<Alarm> {
        let from = if self.is_reached { self.target } else { self.target.max(self.comes_down_from) };
        let limit = from.saturating_add(self.guards.overshoot);
        self.over = if measured > limit && !is_powered { self.over + 1 } else { 0 };
        (self.over >= periods(OVER_S)).then_some(Alarm { cause: Cause::Overshoot, value: measured, limit })
    }
}

fn magnitude(a: Celsius, b: Celsius) -> Celsius {
    a.saturating_sub(b).saturating_abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn c(degrees: i32) -> Celsius {
        Celsius::from_num(degrees)
    }

    /// Periods until an alarm, for temperatures by the period.
    fn run(guard: &mut AtTarget, target: i32, is_powered: bool, at: impl Fn(u32) -> i32) -> Option<(u32, Cause)> {
        (0..3000).find_map(|n| guard.look(c(target), c(at(n)), is_powered).map(|alarm| (n, alarm.cause)))
    }

    #[test]
    fn what_was_reached_and_falls_is_lost() {
        let mut guard = AtTarget::new(Guards::hotend());
        assert_eq!(run(&mut guard, 200, true, |n| 25 + (n / 15) as i32), None, "it warms up");
        assert_eq!(run(&mut guard, 200, true, |_| 200), None);
        assert_eq!(run(&mut guard, 200, true, |_| 191), None);
        assert_eq!(run(&mut guard, 200, true, |_| 189), Some((249, Cause::TemperatureLost)));
    }

    #[test]
    fn far_above_without_power_is_a_stuck_switch() {
        let mut guard = AtTarget::new(Guards::hotend());
        assert_eq!(run(&mut guard, 200, true, |_| 200), None);
        assert_eq!(run(&mut guard, 200, false, |_| 219), None);
        assert_eq!(run(&mut guard, 200, false, |_| 221), Some((249, Cause::Overshoot)));
        let mut guard = AtTarget::new(Guards::hotend());
        assert_eq!(run(&mut guard, 250, false, |_| 250), None);
        assert_eq!(run(&mut guard, 150, false, |n| (250 - (n / 20) as i32).max(150)), None, "it comes down");
        let mut guard = AtTarget::new(Guards::hotend());
        assert_eq!(run(&mut guard, 250, false, |_| 250), None);
        assert!(run(&mut guard, 150, false, |n| 250 + (n / 50) as i32).is_some(), "it should come down and rises");
    }
}
