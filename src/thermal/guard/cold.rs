//! Two cold heaters read the same. A sensor of another kind than set would heat to the wrong temperature. In a room of
//! 12 to 32 C it reads at least 28 K beside the truth: 500 kOhm, 10 kOhm or a PT1000 under the curve of 100 kOhm.
//!
//! Both are cold when their readings rest before any power, or an hour after it. One of two that differ is wrong, and
//! nothing says which, so neither heats.

use super::periods;
use crate::units::Celsius;

/// Farther apart than two heaters in one room: healthy ones were 1.3 K apart at most in 436 simulated hours, and a bed
/// in the sun is some kelvins warmer. Less than half of the least error of a wrong sensor.
const APART: Celsius = Celsius::const_from_int(12);

/// A refusal ends this much closer together.
const CLOSER: Celsius = Celsius::const_from_int(10);

/// Time between two comparisons, in s.
const INTERVAL_S: u32 = 30;

/// Periods of a mean: 2 s, so that noise of 0.3 K is 0.03.
const MEAN: u32 = 100;

/// Readings rest if they change by less in an interval: 0.2 K a minute.
const REST: Celsius = Celsius::lit("0.1");

/// After this time without power both are as cold as the room, in s.
const COOL_S: u32 = 3600;

/// The comparison of the hotend with the bed.
#[derive(Clone, Copy, Debug)]
pub struct Cold {
    /// Periods without power.
    quiet: u32,
    has_heated: bool,
    /// Sums of the present mean.
    sums: [i64; 2],
    /// The means of the interval before.
    before: Option<[Celsius; 2]>,
    differs: bool,
}

impl Default for Cold {
    fn default() -> Self {
        Self::new()
    }
}

impl Cold {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { quiet: 0, has_heated: false, sums: [0; 2], before: None, differs: false }
    }

    /// Follows a control period: whether one of both has power, and both readings. Returns whether they differ although
    /// both are cold.
    pub fn look(&mut self, is_powered: bool, readings: [Option<Celsius>; 2]) -> bool {
        let [Some(hotend), Some(bed)] = readings else {
            // What is broken refuses to heat by itself. The other one may heat.
            *self = Self { has_heated: self.has_heated | is_powered, ..Self::new() };
            return false;
        };
        if is_powered {
            *self = Self { has_heated: true, ..Self::new() };
            return false;
        }
        self.quiet = self.quiet.saturating_add(1);
        let phase = self.quiet % periods(INTERVAL_S);
        if phase < MEAN {
            self.sums = if phase == 0 { [0; 2] } else { self.sums };
            for (sum, reading) in self.sums.iter_mut().zip([hotend, bed]) {
                *sum += i64::from(reading.to_bits());
            }
        }
        if phase == MEAN - 1 && self.quiet >= MEAN {
            let means = self.sums.map(|sum| Celsius::from_bits((sum / i64::from(MEAN)) as i32));
            self.compare(means);
        }
        self.differs
    }

    fn compare(&mut self, means: [Celsius; 2]) {
        let rests = |before: [Celsius; 2]| before.into_iter().zip(means).all(|(a, b)| apart(a, b) < REST);
        let is_cold = !self.has_heated && self.before.is_some_and(rests) || self.quiet > periods(COOL_S);
        self.before = Some(means);
        let [hotend, bed] = means;
        let limit = if self.differs { CLOSER } else { APART };
        if is_cold || self.differs {
            self.differs = apart(hotend, bed) > limit;
        }
    }
}

fn apart(a: Celsius, b: Celsius) -> Celsius {
    a.max(b).saturating_sub(a.min(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn c(degrees: f64) -> Option<Celsius> {
        Some(Celsius::from_num(degrees))
    }

    /// Seconds until both are told to differ, with readings by time.
    fn found(guard: &mut Cold, seconds: u32, at: impl Fn(f64) -> [f64; 2]) -> Option<u32> {
        (0..seconds * 50).find_map(|n| {
            let [hotend, bed] = at(f64::from(n) / 50.0);
            guard.look(false, [c(hotend), c(bed)]).then_some(n / 50)
        })
    }

    #[test]
    fn a_difference_counts_when_both_rest_before_any_power() {
        assert_eq!(found(&mut Cold::new(), 300, |_| [25.0, 37.5]), Some(61), "two means, and 30 s between");
        assert_eq!(found(&mut Cold::new(), 300, |_| [25.0, 36.5]), None);
        let cooling = |s: f64| [25.0, 25.0 + 60.0 * (-s / 500.0).exp()];
        assert_eq!(found(&mut Cold::new(), 3000, cooling), None, "a bed that cools from 85 C");
        let morning = |s: f64| [10.0 + s / 300.0, 10.0 + s / 600.0];
        assert_eq!(found(&mut Cold::new(), 3000, morning), None, "the heating was switched on");
    }

    #[test]
    fn after_power_an_hour_has_to_pass() {
        let mut guard = Cold::new();
        assert!(!guard.look(true, [c(25.0), c(60.0)]));
        let found = found(&mut guard, 5000, |_| [25.0, 60.0]);
        assert!(found.is_some_and(|s| (3600..3640).contains(&s)), "{found:?}");
    }

    #[test]
    fn it_ends_when_they_agree_and_a_broken_sensor_compares_nothing() {
        let mut guard = Cold::new();
        assert!(found(&mut guard, 100, |_| [0.0, 25.0]).is_some());
        assert!((0..3000).any(|_| !guard.look(false, [c(25.0), c(25.0)])), "the sensor's kind was set");
        assert!(found(&mut guard, 100, |_| [0.0, 25.0]).is_some());
        assert!(!guard.look(false, [None, c(25.0)]));
    }
}
