//! Heat under way: after the last power, a sensor still rises. Only this file knows for how long.

use super::floor::Floor;
use super::periods_of_lags;
use crate::settings::HeaterModel;

/// Lags within which heat arrives: behind two equal lags, 0.05 % is missing then.
const LAGS: u32 = 5;

/// How long a heater has had no power.
#[derive(Clone, Copy, Debug)]
pub struct UnderWay {
    /// Periods without power.
    quiet: u32,
    /// Periods after which all heat has arrived.
    settling: u32,
    /// It has had power since the start.
    has_heated: bool,
}

impl Default for UnderWay {
    fn default() -> Self {
        Self::new()
    }
}

impl UnderWay {
    /// The time before the start is unknown: a reset may have ended a heating.
    #[must_use]
    pub const fn new() -> Self {
        Self { quiet: 0, settling: 0, has_heated: false }
    }

    /// Follows a control period of a heater of this model. The model may be wrong, so the time stays within the
    /// floor's.
    pub fn follow(&mut self, is_powered: bool, model: &HeaterModel, floor: &Floor) {
        self.has_heated |= is_powered;
        if is_powered {
            self.quiet = 0;
            return;
        }
        // When the power goes, and again from time to time, in case memory fails.
        if self.quiet.is_multiple_of(64) {
            self.settling = periods_of_lags(LAGS, model).clamp(floor.settling[0], floor.settling[1]);
        }
        self.quiet = self.quiet.saturating_add(1);
    }

    /// Whether it has had power since the start.
    #[must_use]
    pub const fn has_heated(&self) -> bool {
        self.has_heated
    }

    /// Whether all heat has arrived, so that the reading no longer rises by itself.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.quiet > self.settling
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::{Heater, Output, Sensor};
    use crate::settings::HeaterSettings;
    use crate::thermal::guard::periods;
    use crate::units::Seconds;

    #[test]
    fn it_takes_five_lags_and_never_less_or_more_than_a_heater_of_its_kind_can() {
        let mut model = HeaterSettings::hotend(Output::He0, Sensor::Hotend0).model;
        let floor = Floor::of(Heater::Hotend);
        let over_after = |model: &HeaterModel| {
            let mut under_way = UnderWay::new();
            under_way.follow(true, model, floor);
            (1..100_000).find(|_| {
                under_way.follow(false, model, floor);
                under_way.is_over()
            })
        };
        let [least, most] = floor.settling;
        (model.heater_lag, model.sensor_lag) = (Seconds::const_from_int(2), Seconds::const_from_int(2));
        assert_eq!(over_after(&model), Some(periods(20) + 1));
        (model.heater_lag, model.sensor_lag) = (Seconds::lit("0.1"), Seconds::lit("0.1"));
        assert_eq!(over_after(&model), Some(least + 1));
        (model.heater_lag, model.sensor_lag) = (Seconds::const_from_int(120), Seconds::const_from_int(120));
        assert_eq!(over_after(&model), Some(most + 1));
    }
}
