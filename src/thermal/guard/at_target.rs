//! A reached temperature must be kept, and above it there must be no power.

use super::{Alarm, Episode, Floor, Seen, periods};
use crate::fault::Cause;
use crate::settings::Guards;
use crate::units::Celsius;

/// Distance from the target that counts as reached.
const REACHED: Celsius = Celsius::const_from_int(2);

/// Seconds above the limit without power that mean a stuck switch.
const OVER_S: u32 = 5;

/// Permitted rise without power, from the coldest reading after all heat has arrived. The end of the part fan's wind
/// makes a kelvin; noise of 3 steps of 12 bits makes half of one at 280 C.
const RISES: Celsius = Celsius::const_from_int(3);

/// The guard of a heater with a target: an episode for each target.
#[derive(Clone, Copy, Debug)]
pub struct AtTarget(Episode<Celsius, Hold>);

/// Observations since the last change of the target.
#[derive(Clone, Copy, Debug)]
struct Hold {
    is_reached: bool,
    far: u32,
    over: u32,
    /// The coldest since all heat has arrived.
    coldest: Celsius,
}

impl Default for AtTarget {
    fn default() -> Self {
        Self::new()
    }
}

impl AtTarget {
    /// No target yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(Episode::none())
    }

    /// Follows a control period; `target` is the one that the heater holds, if any.
    pub fn look(&mut self, guards: &Guards, floor: &Floor, target: Option<Celsius>, seen: &Seen) -> Option<Alarm> {
        let begin = || Hold { is_reached: false, far: 0, over: 0, coldest: Celsius::MAX };
        let hold = self.0.follow(target, begin)?;
        let target = target?;
        hold.is_reached |= magnitude(seen.measured, target) <= REACHED;
        let lost = hold.lost(guards, target, seen);
        // The floor's number limits the setting. A warm neighbour may warm it up to its own temperature: a hot bed
        // takes a chamber far above its target.
        let limit = target.saturating_add(guards.overshoot.min(floor.overshoot)).max(seen.warmed_to);
        hold.overshoot(limit, seen).or(lost)
    }
}

impl Hold {
    fn lost(&mut self, guards: &Guards, target: Celsius, seen: &Seen) -> Option<Alarm> {
        let (measured, limit) = (seen.measured, target.saturating_sub(guards.lost));
        // What cools without power by order is not lost: it warms up again after.
        self.is_reached &= !(seen.rests && measured < limit);
        self.far = if self.is_reached && measured < limit { self.far + 1 } else { 0 };
        let is_lost = self.far >= periods(guards.lost_s.into());
        is_lost.then_some(Alarm { cause: Cause::TemperatureLost, value: measured, limit })
    }

    /// A heater that comes down from a higher target may be above this one as long as it falls. Heat under way may
    /// still raise it. A rise after that means power.
    fn overshoot(&mut self, limit: Celsius, seen: &Seen) -> Option<Alarm> {
        self.over = if seen.measured > limit && !seen.is_powered() { self.over + 1 } else { 0 };
        self.coldest = if seen.is_settled { self.coldest.min(seen.smooth) } else { Celsius::MAX };
        let rises = seen.smooth >= self.coldest.saturating_add(RISES);
        let is_stuck = rises && self.over >= periods(OVER_S);
        is_stuck.then_some(Alarm { cause: Cause::Overshoot, value: seen.measured, limit })
    }
}

fn magnitude(a: Celsius, b: Celsius) -> Celsius {
    a.saturating_sub(b).saturating_abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::Heater;

    fn c(degrees: i32) -> Celsius {
        Celsius::from_num(degrees)
    }

    /// Periods until an alarm, with its cause, for a temperature per period; `duty` of 65,535.
    fn run(guard: &mut AtTarget, target: i32, duty: u16, at: impl Fn(u32) -> i32) -> Option<(u32, Cause)> {
        let floor = Floor::of(Heater::Hotend);
        (0..3000).find_map(|n| {
            let at = c(at(n));
            let seen = Seen { smooth: at, duty, is_settled: duty == 0, ..Seen::quiet(at) };
            let target = (target > 0).then_some(c(target));
            guard.look(&Guards::hotend(), floor, target, &seen).map(|alarm| (n, alarm.cause))
        })
    }

    const FULL: u16 = u16::MAX;

    #[test]
    fn what_was_reached_and_falls_is_lost() {
        let mut guard = AtTarget::new();
        assert_eq!(run(&mut guard, 200, FULL, |n| 25 + (n / 15) as i32), None, "it warms up");
        assert_eq!(run(&mut guard, 200, FULL, |_| 200), None);
        assert_eq!(run(&mut guard, 200, FULL, |_| 191), None);
        assert_eq!(run(&mut guard, 200, FULL, |_| 189), Some((249, Cause::TemperatureLost)));
    }

    #[test]
    fn what_cools_while_it_rests_warms_up_again_and_may_be_lost_again() {
        let (mut guard, floor) = (AtTarget::new(), Floor::of(Heater::Bed));
        let mut alarms = |rests: bool, at: &dyn Fn(u32) -> i32| {
            let look = |n: u32| {
                let seen = Seen { duty: if rests { 0 } else { FULL }, rests, ..Seen::quiet(c(at(n))) };
                guard.look(&Guards::bed(), floor, Some(c(60)), &seen)
            };
            (0..3000).find_map(look).map(|alarm| alarm.cause)
        };
        assert_eq!(alarms(false, &|_| 60), None);
        assert_eq!(alarms(true, &|n| 60 - (n / 100) as i32), None);
        assert_eq!(alarms(false, &|n| 31 + (n / 100) as i32), None, "it warms up");
        assert_eq!(alarms(false, &|_| 31), Some(Cause::TemperatureLost));
    }

    /// Reproducer: a target that was reached stayed reached while the heater was off, so the second heating to it was
    /// lost.
    #[test]
    fn the_same_target_after_an_end_has_not_been_reached() {
        let mut guard = AtTarget::new();
        assert_eq!(run(&mut guard, 200, FULL, |_| 200), None);
        assert_eq!(run(&mut guard, 0, 0, |_| 150), None);
        assert_eq!(run(&mut guard, 200, FULL, |_| 150), None, "it warms up");
        assert_eq!(run(&mut guard, 200, FULL, |_| 200), None);
        assert!(run(&mut guard, 200, FULL, |_| 180).is_some());
    }

    /// Reproducer: a chamber for 23.5 C that a bed of 85 C warmed to 38.5 C counted as one with a stuck switch.
    #[test]
    fn a_neighbour_may_warm_it_far_above_its_target() {
        let alarms = |warmed_to: i32| {
            let mut guard = AtTarget::new();
            (0..60_000).any(|n| {
                let at = c(24 + n / 2000);
                let seen = Seen { is_settled: true, warmed_to: c(warmed_to), ..Seen::quiet(at) };
                guard.look(&Guards::bed(), Floor::of(Heater::Chamber), Some(c(24)), &seen).is_some()
            })
        };
        assert!(!alarms(85) && alarms(40) && alarms(20));
    }

    #[test]
    fn what_rises_far_above_without_power_is_a_stuck_switch() {
        let mut guard = AtTarget::new();
        assert_eq!(run(&mut guard, 200, FULL, |_| 200), None);
        assert_eq!(run(&mut guard, 200, 0, |_| 214), None);
        assert_eq!(run(&mut guard, 200, 0, |n| 214 + (n / 100) as i32), Some((200 + 249, Cause::Overshoot)));
        let mut guard = AtTarget::new();
        assert_eq!(run(&mut guard, 250, 0, |_| 250), None);
        assert_eq!(run(&mut guard, 150, 0, |n| (250 - (n / 20) as i32).max(150)), None, "it comes down");
        let mut guard = AtTarget::new();
        assert_eq!(run(&mut guard, 250, 0, |_| 250), None);
        assert!(run(&mut guard, 150, 0, |n| 250 + (n / 50) as i32).is_some(), "it should come down and rises");
    }
}
