//! A heater that is off must not get warmer. A transistor or relay that does not switch off burns printers down, and
//! only the power supply's switch ends it.

use super::{Alarm, Episode, Seen, periods};
use crate::fault::Cause;
use crate::units::Celsius;

/// A rise counts from the coldest reading of this time, in s: a sunny window takes longer.
const MEMORY_S: u32 = 120;

/// A neighbour may warm it up to its own temperature, but not that far in this time, in s. A bed of 110 C that is
/// coupled by 0.05 W/K warms a block of 6 J/K by 0.7 K/s, and 8 K in 6 s is twice as much. A heater of 25 W in
/// 10.8 J/K makes 2.3 K/s.
const QUICK_S: u32 = 6;

/// The guard of a heater without power: an episode from the arrival of its last heat to its next power.
#[derive(Clone, Copy, Debug)]
pub struct WhileOff(Episode<(), Memories>);

/// The coldest readings of both times.
#[derive(Clone, Copy, Debug)]
struct Memories {
    late: Coldest,
    quick: Coldest,
}

/// The coldest recent reading.
#[derive(Clone, Copy, Debug)]
struct Coldest {
    /// In this half of the memory, and in the half before.
    halves: [Celsius; 2],
    /// Periods until this half becomes the half before.
    left: u32,
}

impl Coldest {
    const NONE: Self = Self { halves: [Celsius::MAX; 2], left: 0 };

    /// Follows a control period; returns the coldest reading of `seconds`.
    fn follow(&mut self, seconds: u32, smooth: Celsius) -> Celsius {
        if self.left == 0 {
            *self = Self { halves: [Celsius::MAX, self.halves[0]], left: periods(seconds / 2) };
        }
        self.left -= 1;
        self.halves[0] = self.halves[0].min(smooth);
        self.halves[0].min(self.halves[1])
    }
}

impl Default for WhileOff {
    fn default() -> Self {
        Self::new()
    }
}

impl WhileOff {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self(Episode::none())
    }

    /// Follows a control period; a rise above `rise` is an alarm. A neighbour may warm it slowly, up to its own
    /// temperature.
    pub fn look(&mut self, rise: Celsius, seen: &Seen) -> Option<Alarm> {
        let begin = || Memories { late: Coldest::NONE, quick: Coldest::NONE };
        let coldest = self.0.follow(seen.is_settled.then_some(()), begin)?;
        let late = coldest.late.follow(MEMORY_S, seen.smooth).max(seen.warmed_to);
        let quick = coldest.quick.follow(QUICK_S, seen.smooth);
        let limit = late.min(quick).saturating_add(rise);
        (seen.smooth > limit).then_some(Alarm { cause: Cause::HeatsWhileOff, value: seen.measured, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RISE: Celsius = Celsius::const_from_int(8);

    /// Seconds until the alarm at a slope in K/s.
    fn run(guard: &mut WhileOff, from: f64, slope: f64, seconds: u32, warmed_to: i32) -> Option<u32> {
        let warmed_to = Celsius::from_num(warmed_to);
        (0..seconds * 50).find_map(|n| {
            let at = Celsius::from_num(from + slope * f64::from(n) / 50.0);
            guard.look(RISE, &Seen { is_settled: true, warmed_to, ..Seen::quiet(at) }).map(|_| n / 50)
        })
    }

    /// Reproducer: a bed of 100 C warmed a hotend that was off by 8 C in two minutes, and the supply was cut.
    #[test]
    fn a_bed_that_warms_the_hotend_next_to_it_is_no_stuck_switch() {
        assert_eq!(run(&mut WhileOff::new(), 25.0, 0.7, 100, 100), None);
        let mut guard = WhileOff::new();
        assert_eq!(run(&mut guard, 25.0, 0.7, 40, 100), None);
        assert_eq!(run(&mut guard, 52.0, -0.1, 200, 46), None, "the bed cools sooner");
    }

    #[test]
    fn a_switch_that_sticks_is_found_next_to_a_hot_bed_too() {
        for slope in [2.0, 5.0, 9.0] {
            assert!(run(&mut WhileOff::new(), 25.0, slope, 60, 110).is_some_and(|s| s < 6), "{slope} K/s");
        }
        let slow = run(&mut WhileOff::new(), 25.0, 0.7, 300, 100);
        assert!(slow.is_some_and(|s| s < 120), "25 W in 34 J/K, found above the bed: {slow:?}");
    }

    #[test]
    fn a_switch_that_sticks_is_found() {
        assert!(run(&mut WhileOff::new(), 25.0, 4.0, 60, -100).is_some_and(|s| s < 3), "60 W in a hotend");
        assert!(run(&mut WhileOff::new(), 25.0, 0.2, 120, -100).is_some_and(|s| s < 60), "500 W in a bed");
    }

    #[test]
    fn cooling_a_warm_morning_and_a_bed_that_warms_its_chamber_are_no_fault() {
        assert_eq!(run(&mut WhileOff::new(), 200.0, -0.5, 300, -100), None);
        assert_eq!(run(&mut WhileOff::new(), 15.0, 0.02, 1500, -100), None, "1.2 K a minute");
        assert_eq!(run(&mut WhileOff::new(), 25.0, 0.1, 500, 100), None);
        // The block is hotter than the sensor when the power goes off.
        let mut guard = WhileOff::new();
        for n in 0..500 {
            let at = Celsius::from_num(200.0 + 0.08 * f64::from(n));
            assert_eq!(guard.look(RISE, &Seen::quiet(at)), None);
        }
    }
}
