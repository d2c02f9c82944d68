//! A reading that does not change after the heater power changed is invalid: the converter, or its input, has stopped.
//!
//! At a constant power a reading may come to rest: the losses take all of it. A bed that cannot reach its target does
//! so at full power. So such a reading counts only while it must move:
//!
//! - on the first 60 % of the way to a target, as for [`Gain`](super::Gain);
//! - just after its power has risen;
//! - just after it has risen, for a heater comes to rest no faster than its time constant T. If it rose by r in a time
//!   L, it rises by r (1 - exp(-S/T)) / (exp(L/T) - 1) or more in the next time S.
//!
//! | | L | S | r | T at least | so it must rise by | greatest step of 12 bits |
//! |---|---|---|---|---|---|---|
//! | hotend | 12 s | 30 s | 2 C | 15 s | 1.4 C | 0.6 C at 285 C |
//! | bed | 60 s | 60 s | 0.65 C | 60 s | 0.24 C | 0.13 C at 25 C |
//! | chamber | 120 s | 120 s | 1 C | 100 s | 0.3 C | 0.13 C at 25 C |
//!
//! No model and no setting takes part. A draught, a weak supply, a second mass and a model that is wrong change where a
//! heater comes to rest, but not how fast.

use super::floor::is_low;
use super::{Alarm, Floor, Seen};
use crate::fault::Cause;
use crate::units::Celsius;

/// Least movement of a valid reading, by noise or by temperature: a third of a 12-bit step of a hot hotend.
const STILL: Celsius = Celsius::lit("0.02");

/// A change of the duty that any heater's temperature follows.
const CHANGE: u16 = u16::MAX / 5;

/// So near to its target a heater is held. A good controller moves the reading by less than [`STILL`] then. A bed may
/// need more than half of its power for that (120 W at 0.85 W/K: 63 % at 99 C).
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
    /// Whether the reading had to go on when it last moved. Before its first movement it has to move.
    must_move: bool,
    /// The last marks, the oldest first, and the periods since the newest one.
    marks: [Mark; MARKS],
    age: u32,
}

/// The reading without its noise at a time, and the smallest mean duty from then to the next mark.
#[derive(Clone, Copy, Debug)]
struct Mark {
    smooth: Celsius,
    duty: u16,
}

/// Marks: the oldest is three to four times the interval old.
const MARKS: usize = 4;

impl Default for Frozen {
    fn default() -> Self {
        Self::new()
    }
}

impl Frozen {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            least: Celsius::MAX,
            most: Celsius::MIN,
            duties: [u16::MAX, 0],
            mean: 0,
            still: 0,
            must_move: true,
            marks: [Mark { smooth: Celsius::MAX, duty: u16::MAX }; MARKS],
            age: u32::MAX,
        }
    }

    /// Follows a control period of a heater that is to hold a temperature, if it is, and that heats for a goal.
    pub fn look(&mut self, floor: &Floor, [hold, goal]: [Option<Celsius>; 2], seen: &Seen) -> Option<Alarm> {
        let measured = seen.measured;
        self.mean = self.mean - (self.mean >> 6) + u32::from(seen.duty);
        let mean = (self.mean >> 6) as u16;
        self.mark(floor, seen.smooth, mean);
        (self.least, self.most) = (self.least.min(measured), self.most.max(measured));
        self.duties = [self.duties[0].min(mean), self.duties[1].max(mean)];
        if self.most.saturating_sub(self.least) > STILL {
            let must_move = self.must_move_on(floor, seen.smooth, mean);
            let (least, most, duties, still) = (measured, measured, [mean; 2], 0);
            *self = Self { least, most, duties, still, must_move, ..*self };
            return None;
        }
        let is_held = hold.is_some_and(|target| target.saturating_sub(measured).saturating_abs() <= HELD);
        // Where it is held, the power falls while it settles, and the reading may stay: only more power must show.
        let from = if is_held { mean } else { self.duties[1] };
        let change = from.saturating_sub(self.duties[0]);
        let is_heated = if is_held {
            // Less than half: the dither lowers it.
            mean > u16::MAX / 5 * 2 && change > CHANGE / 2 && !floor.holds_still
        } else {
            mean > u16::MAX / 2 && (self.must_move || is_low(measured, goal))
        };
        let has_changed = change > CHANGE || is_heated;
        // A constant reading before the power changed means nothing: a cold bed may read the same for hours.
        self.still = if has_changed { self.still.saturating_add(1) } else { 0 };
        let is_frozen = self.still >= floor.still;
        is_frozen.then_some(Alarm { cause: Cause::SensorFrozen, value: measured, limit: STILL })
    }

    /// Notes the present reading and duty.
    fn mark(&mut self, floor: &Floor, smooth: Celsius, duty: u16) {
        self.age = self.age.saturating_add(1);
        let [_, later @ ..] = self.marks;
        if self.age >= floor.mark {
            let [b, c, d] = later;
            (self.marks, self.age) = ([b, c, d, Mark { smooth, duty }], 0);
        }
        let [.., newest] = &mut self.marks;
        newest.duty = newest.duty.min(duty);
    }

    /// Whether a reading that moves now has to go on: it has risen, or its power has.
    fn must_move_on(&self, floor: &Floor, smooth: Celsius, duty: u16) -> bool {
        let [oldest, ..] = self.marks;
        let least = self.marks.iter().fold(duty, |least, mark| least.min(mark.duty));
        smooth.saturating_sub(oldest.smooth) >= floor.rises || duty - least > CHANGE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::Heater;

    fn look(guard: &mut Frozen, measured: Celsius, duty: u16) -> Option<Alarm> {
        guard.look(Floor::of(Heater::Hotend), [None; 2], &Seen { duty, ..Seen::quiet(measured) })
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
            (0..100_000).any(|_| {
                guard.look(floor, [Some(Celsius::from_num(target)); 2], &Seen { duty, ..Seen::quiet(at) }).is_some()
            })
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
                guard.look(Floor::of(Heater::Hotend), [Some(at); 2], &Seen { duty, ..Seen::quiet(at) }).is_some()
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

    /// A reading of 12 bits, 16 times: an NTC of 3950 K under 4.7 kOhm, with noise in LSB.
    fn read(celsius: f64, noise: f64, random: &mut u64) -> Celsius {
        let ohms = 100_000.0 * (3950.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15)).exp();
        let steps = ohms / (ohms + 4700.0) * 4096.0;
        let mut uniform = || {
            *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*random >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        // Four of them have a variance of a third.
        let mut conversion = || (steps + noise * 1.732 * (uniform() + uniform() + uniform() + uniform())).round();
        let ratio = (0..16).map(|_| conversion()).sum::<f64>() / 65_536.0;
        let ohms = 4700.0 * ratio / (1.0 - ratio);
        Celsius::from_num(1.0 / (1.0 / 298.15 + (ohms / 100_000.0).ln() / 3950.0) - 273.15)
    }

    /// Reproducer: a bed at full power that came to rest below its target, and a converter with little noise.
    #[test]
    fn a_heater_that_comes_to_rest_below_its_target_at_full_power_is_not_frozen_and_one_that_rose_is() {
        // Time constant, temperature of rest, target: that is beyond the first 60 % of the way.
        for (heater, seconds, rest, target) in [
            (Heater::Bed, 100.0, 60.0, 75),
            (Heater::Bed, 450.0, 75.0, 79),
            (Heater::Bed, 1500.0, 92.0, 110),
            (Heater::Hotend, 15.0, 225.0, 280),
            (Heater::Hotend, 140.0, 195.0, 240),
            (Heater::Chamber, 200.0, 45.0, 50),
        ] {
            let (floor, goal) = (Floor::of(heater), [Some(Celsius::from_num(target)); 2]);
            for noise in [0.0, 0.1, 0.3] {
                // Where the reading freezes, as a part of the way to the rest.
                // A heavy bed that has less than 12 C left rises by a degree in two minutes.
                let last = if seconds < 1000.0 { 0.85 } else { 0.7 };
                for freezes_at in [None, Some(0.3), Some(0.7), Some(last)] {
                    let (mut guard, mut random, mut smooth) = (Frozen::new(), 7, Celsius::from_num(15));
                    let (mut frozen, mut at) = (None, 15.0);
                    let periods = (50.0 * (8.0 * seconds + 600.0)) as u32;
                    let found = (0..periods).find(|n| {
                        at += (rest - at) / (50.0 * seconds);
                        let measured = match frozen {
                            Some((_, measured)) => measured,
                            None => read(at, noise, &mut random),
                        };
                        if freezes_at.is_some_and(|part| at > 15.0 + part * (rest - 15.0)) {
                            frozen = frozen.or(Some((*n, measured)));
                        }
                        smooth += (measured - smooth) >> 4;
                        let seen = Seen { smooth, duty: u16::MAX, ..Seen::quiet(measured) };
                        guard.look(floor, goal, &seen).is_some()
                    });
                    let after = found.map(|n| n - frozen.map_or(0, |(n, _)| n));
                    match freezes_at {
                        None => assert_eq!(found, None, "{heater:?} {seconds} s, noise {noise}"),
                        Some(part) => assert!(
                            after.is_some_and(|n| n <= floor.still + 1),
                            "{heater:?} {seconds} s, noise {noise}, frozen at {part}: {after:?}"
                        ),
                    }
                }
            }
        }
    }
}
