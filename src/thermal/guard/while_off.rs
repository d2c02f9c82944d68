//! A heater that is off does not get warmer. A transistor or relay that does not switch off is what burns printers down, and
//! only the power supply's switch ends it.

use super::{Alarm, Episode, Seen, periods};
use crate::fault::Cause;
use crate::units::Celsius;

/// A rise counts against the coldest of this time, in s: a sunny window takes longer.
const MEMORY_S: u32 = 120;

/// The guard of a heater without power: an episode from the arrival of its last heat to its next power.
#[derive(Clone, Copy, Debug)]
pub struct WhileOff(Episode<(), Coldest>);

/// The coldest of late.
#[derive(Clone, Copy, Debug)]
struct Coldest {
    /// Of this half of the memory, and of the half before.
    halves: [Celsius; 2],
    /// Periods until this half becomes the half before.
    left: u32,
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

    /// Looks at a control period; `rise` is more than it may get warmer. A chamber gets warmer by its bed, rightly.
    pub fn look(&mut self, rise: Celsius, seen: &Seen) -> Option<Alarm> {
        let is_cold = seen.is_settled && !seen.is_warmed;
        let begin = || Coldest { halves: [Celsius::MAX; 2], left: 0 };
        let coldest = self.0.follow(is_cold.then_some(()), begin)?;
        if coldest.left == 0 {
            *coldest = Coldest { halves: [Celsius::MAX, coldest.halves[0]], left: periods(MEMORY_S / 2) };
        }
        coldest.left -= 1;
        coldest.halves[0] = coldest.halves[0].min(seen.smooth);
        let limit = coldest.halves[0].min(coldest.halves[1]).saturating_add(rise);
        (seen.smooth > limit).then_some(Alarm { cause: Cause::HeatsWhileOff, value: seen.measured, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RISE: Celsius = Celsius::const_from_int(8);

    /// Seconds until the alarm at a rise of so many K a second.
    fn run(guard: &mut WhileOff, from: f64, slope: f64, seconds: u32, is_warmed: bool) -> Option<u32> {
        (0..seconds * 50).find_map(|n| {
            let at = Celsius::from_num(from + slope * f64::from(n) / 50.0);
            guard.look(RISE, &Seen { is_settled: true, is_warmed, ..Seen::quiet(at) }).map(|_| n / 50)
        })
    }

    #[test]
    fn a_switch_that_sticks_is_found() {
        assert!(run(&mut WhileOff::new(), 25.0, 4.0, 60, false).is_some_and(|s| s < 3), "60 W in a hotend");
        assert!(run(&mut WhileOff::new(), 25.0, 0.2, 120, false).is_some_and(|s| s < 60), "500 W in a bed");
    }

    #[test]
    fn cooling_a_warm_morning_and_a_bed_that_warms_its_chamber_are_no_fault() {
        assert_eq!(run(&mut WhileOff::new(), 200.0, -0.5, 300, false), None);
        assert_eq!(run(&mut WhileOff::new(), 15.0, 0.02, 1500, false), None, "1.2 K a minute");
        assert_eq!(run(&mut WhileOff::new(), 25.0, 0.1, 500, true), None);
        // The block is hotter than the sensor when the power goes off.
        let mut guard = WhileOff::new();
        for n in 0..500 {
            let at = Celsius::from_num(200.0 + 0.08 * f64::from(n));
            assert_eq!(guard.look(RISE, &Seen::quiet(at)), None);
        }
    }
}
