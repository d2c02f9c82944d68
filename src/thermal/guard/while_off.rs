//! A heater that is off does not get warmer. A transistor or relay that does not switch off is what burns printers down, and
//! only the power supply's switch ends it.

use super::{Alarm, periods, periods_of_lags};
use crate::fault::Cause;
use crate::settings::HeaterSettings;
use crate::units::Celsius;

/// Heat on its way arrives within so many lags.
const LAGS: u32 = 5;

/// A rise counts against the coldest of this time, in s: a sunny window takes longer.
const MEMORY_S: u32 = 120;

/// The guard of a heater without power.
#[derive(Clone, Copy, Debug)]
pub struct WhileOff {
    rise: Celsius,
    /// Periods without power after which all heat has arrived.
    settling: u32,
    /// Periods without power.
    off: u32,
    /// The coldest of this half of the memory, and of the half before.
    coldest: [Celsius; 2],
    /// Periods until this half becomes the half before.
    left: u32,
}

impl WhileOff {
    /// The guard of a heater.
    #[must_use]
    pub const fn new(settings: &HeaterSettings) -> Self {
        let settling = periods_of_lags(LAGS, &settings.model);
        Self { rise: settings.guards.off_rise, settling, off: 0, coldest: [Celsius::MAX; 2], left: 0 }
    }

    /// Other thresholds.
    pub const fn configure(&mut self, settings: &HeaterSettings) {
        let Self { rise, settling, .. } = Self::new(settings);
        (self.rise, self.settling) = (rise, settling);
    }

    /// Looks at a control period.
    pub fn look(&mut self, measured: Celsius, is_powered: bool) -> Option<Alarm> {
        if is_powered {
            (self.off, self.coldest, self.left) = (0, [Celsius::MAX; 2], 0);
            return None;
        }
        self.off = self.off.saturating_add(1);
        if self.off <= self.settling {
            return None;
        }
        if self.left == 0 {
            self.coldest = [Celsius::MAX, self.coldest[0]];
            self.left = periods(MEMORY_S / 2);
        }
        self.left -= 1;
        self.coldest[0] = self.coldest[0].min(measured);
        let coldest = self.coldest[0].min(self.coldest[1]);
        let limit = coldest.saturating_add(self.rise);
        (measured > limit).then_some(Alarm { cause: Cause::HeatsWhileOff, value: measured, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::{Output, Sensor};

    fn guard() -> WhileOff {
        WhileOff::new(&HeaterSettings::hotend(Output::He0, Sensor::Hotend0))
    }

    /// Seconds until the alarm at a rise of so many K a second.
    fn run(guard: &mut WhileOff, from: f64, slope: f64, seconds: u32) -> Option<u32> {
        (0..seconds * 50).find_map(|n| {
            let at = Celsius::from_num(from + slope * f64::from(n) / 50.0);
            guard.look(at, false).map(|_| n / 50)
        })
    }

    #[test]
    fn a_switch_that_sticks_is_found() {
        assert!(run(&mut guard(), 25.0, 4.0, 60).is_some_and(|s| s < 15), "60 W in a hotend");
        assert!(run(&mut guard(), 25.0, 0.2, 120).is_some_and(|s| s < 60), "500 W in a bed");
    }

    #[test]
    fn cooling_and_a_warm_morning_are_no_fault() {
        assert_eq!(run(&mut guard(), 200.0, -0.5, 300), None);
        assert_eq!(run(&mut guard(), 15.0, 0.02, 1500), None, "1.2 K a minute");
        // The block is hotter than the sensor when the power goes off.
        let mut guard = guard();
        let _ = guard.look(Celsius::from_num(200), true);
        assert_eq!(run(&mut guard, 200.0, 4.0, 5), None);
    }
}
