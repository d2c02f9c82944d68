//! What a wait for heat follows: whether targets are reached, whether it still cools, whether it still gets warmer.

use crate::connectors::{HEATERS, Heater};
use crate::units::{Celsius, Instant, TICKS_PER_SECOND};

/// Within the first distance of its target a heater has reached it; beyond the second it has lost it again: Marlin's
/// TEMP_WINDOW and TEMP_HYSTERESIS (Configuration.h, 2.1).
pub(in crate::machine) const NEAR: Celsius = Celsius::const_from_int(1);
pub(in crate::machine) const FAR: Celsius = Celsius::const_from_int(3);

/// It has to be so for that long. Marlin waits for 10 s because a PID controller oscillates. The model does not, and
/// after the sensor's lag of a second or two the reading is the real temperature.
const RESIDENCY_MS: u32 = 3000;

/// A wait for cooling ends once cooling is slower than 1.5 C a minute, because the room may be warmer than the target:
/// Marlin's MIN_COOLING_SLOPE_DEG and MIN_COOLING_SLOPE_TIME (Configuration_adv.h, 2.1).
const LEAST_COOLING: Celsius = Celsius::lit("1.5");
const COOLING_MS: u32 = 60_000;

/// A heater below its target that gains less than this in the time of its kind does not get there. By the plants: a
/// heater that can reach its target is at least 1 C below its final temperature at full power. In time t it gains at
/// least 1 C x t x loss / capacity. The heaviest bed in use (5,500 J/K) loses at least 1 W/K and gains 0.33 C in half
/// an hour. A hotend (34 J/K at most, 0.05 W/K) gains 0.35 C in four minutes. The host is warned after a third of it.
const LEAST_RISE: Celsius = Celsius::lit("0.2");
const HOTEND_STUCK_MS: u32 = 240_000;
const STUCK_MS: u32 = 1_800_000;

/// Whether heaters have been at their targets for long enough.
pub(in crate::machine) struct Residency {
    pub since: Option<Instant>,
}

impl Residency {
    /// Seconds that are missing; `None` if a target is not reached.
    pub fn follow(&mut self, is_near: bool, is_far: bool, now: Instant) -> Option<u32> {
        if is_far {
            self.since = None;
        } else if is_near && self.since.is_none() {
            self.since = Some(now);
        }
        let end = self.since?.after_ms(RESIDENCY_MS);
        Some(end.0.saturating_sub(now.0).div_ceil(u64::from(TICKS_PER_SECOND)) as u32)
    }
}

/// Whether a heater still cools as fast as waiting for it makes sense.
pub(in crate::machine) struct Cooling {
    /// Start of the interval, and the temperatures then.
    pub looked: (Instant, [Option<Celsius>; HEATERS]),
}

impl Cooling {
    /// Whether none of the heaters that are too hot gets cooler any more.
    pub fn has_ended(&mut self, are_hot: [bool; HEATERS], measured: [Option<Celsius>; HEATERS], now: Instant) -> bool {
        let (since, before) = self.looked;
        if now < since.after_ms(COOLING_MS) {
            return false;
        }
        self.looked = (now, measured);
        let stays = |place: usize| {
            let both = before[place].zip(measured[place]);
            both.is_some_and(|(before, now)| before.saturating_sub(now) < LEAST_COOLING)
        };
        are_hot.iter().any(|is_hot| *is_hot) && (0..HEATERS).all(|place| !are_hot[place] || stays(place))
    }
}

/// Whether heaters below their targets still get warmer, by a small step within a short time. A chamber that warms with
/// the bed lets it creep on for hours: that is slow by the guards' floor (`thermal::guard::Gain`), which would halt the
/// machine later.
pub(in crate::machine) struct Rising {
    /// The reading of each heater when it last rose by a step, and its time.
    steps: [(Option<Celsius>, Instant); HEATERS],
    is_told: bool,
}

/// The reaction to a heater that gets no warmer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Stuck {
    Tell(Heater),
    End(Heater),
}

impl Rising {
    pub fn new(measured: [Option<Celsius>; HEATERS], now: Instant) -> Self {
        Self { steps: measured.map(|measured| (measured, now)), is_told: false }
    }

    /// Follows heaters by the distances below their targets, of those that are waited for.
    pub fn follow(
        &mut self,
        below: [Option<Celsius>; HEATERS],
        measured: [Option<Celsius>; HEATERS],
        is_slow: impl Fn(Heater) -> bool,
        now: Instant,
    ) -> Option<Stuck> {
        for heater in Heater::ALL {
            let place = heater as usize;
            let (best, since) = &mut self.steps[place];
            let is_cold = below[place].is_some_and(|below| below > NEAR);
            if !is_cold || measured[place] >= best.map(|best| best.saturating_add(LEAST_RISE)) {
                (*best, *since) = (measured[place], now);
            }
            let most_ms = if heater == Heater::Hotend { HOTEND_STUCK_MS } else { STUCK_MS };
            if now >= since.after_ms(most_ms) || is_cold && is_slow(heater) {
                return Some(Stuck::End(heater));
            }
            if now >= since.after_ms(most_ms / 3) && !core::mem::replace(&mut self.is_told, true) {
                return Some(Stuck::Tell(heater));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_target_counts_as_reached_after_three_seconds_near_it() {
        let at = |ms: u32| Instant(0).after_ms(ms);
        let mut residency = Residency { since: None };
        assert_eq!(residency.follow(false, true, at(0)), None);
        assert_eq!(residency.follow(true, false, at(1000)), Some(3));
        assert_eq!(residency.follow(false, false, at(2500)), Some(2), "between near and far it goes on");
        assert_eq!(residency.follow(false, true, at(3000)), None);
        assert_eq!(residency.follow(true, false, at(4000)), Some(3));
        assert_eq!(residency.follow(true, false, at(6999)), Some(1));
        assert_eq!(residency.follow(true, false, at(7000)), Some(0));
    }

    #[test]
    fn a_wait_ends_when_nothing_gets_warmer_and_never_while_a_heavy_bed_still_does() {
        let at = |s: u32| Instant(0).after_ms(s * 1000);
        let celsius = Celsius::from_num::<f64>;
        let bed = |degrees: f64| [celsius(25.0), celsius(degrees), celsius(25.0)].map(Some);
        let below = |degrees: f64| [None, Some(celsius(99.0 - degrees)), None];
        // A bed of 5,500 J/K that loses 1 W/K and is heated to a degree above the target: seen until it is a degree
        // below.
        let mut rising = Rising::new(bed(25.0), at(0));
        let (mut degrees, mut s) = (25.0, 0);
        while degrees < 99.0 {
            degrees += (100.0 - degrees) / 5500.0;
            s += 1;
            let stuck = rising.follow(below(degrees), bed(degrees), |_| false, at(s));
            assert!(!matches!(stuck, Some(Stuck::End(_))), "{degrees} after {s} s");
        }
        // One that stays where it is.
        let mut rising = Rising::new(bed(80.0), at(0));
        let found: Vec<_> =
            (0..=1800).filter_map(|s| Some((s, rising.follow(below(80.1), bed(80.1), |_| false, at(s))?))).collect();
        assert_eq!(found, [(600, Stuck::Tell(Heater::Bed)), (1800, Stuck::End(Heater::Bed))]);
        assert_eq!(rising.follow([None; HEATERS], bed(80.1), |_| false, at(9000)), None);
    }

    #[test]
    fn a_heater_that_the_guards_find_slow_ends_the_wait_for_it_alone() {
        let at = |degrees: i32| [None, Some(Celsius::from_num(degrees)), None];
        let mut rising = Rising::new(at(72), Instant(0));
        let slow = |slow: Heater| move |heater| heater == slow;
        assert_eq!(rising.follow(at(7), at(72), slow(Heater::Chamber), Instant(0)), None);
        assert_eq!(rising.follow(at(1), at(78), slow(Heater::Bed), Instant(0)), None, "near enough");
        assert_eq!(rising.follow(at(7), at(72), slow(Heater::Bed), Instant(0)), Some(Stuck::End(Heater::Bed)));
    }

    #[test]
    fn cooling_ends_when_it_takes_too_long() {
        let celsius = |degrees: i32| Some(Celsius::from_num(degrees));
        let mut cooling = Cooling { looked: (Instant(0), [celsius(60); HEATERS]) };
        let hot = [true, false, false];
        assert!(!cooling.has_ended(hot, [celsius(60); HEATERS], Instant(0).after_ms(59_999)));
        assert!(!cooling.has_ended(hot, [celsius(50); HEATERS], Instant(0).after_ms(60_000)));
        assert!(cooling.has_ended(hot, [celsius(49); HEATERS], Instant(0).after_ms(120_000)));
    }
}
