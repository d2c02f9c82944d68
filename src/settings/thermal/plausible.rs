//! Plausible models for a heater of its kind and power: M306 takes them, and `corehbot config check` warns of others.
//!
//! The wide ranges of `settings::ranges` hold for all stored values. These are narrower. A model beyond them fits no
//! real heater and is a typing error, and guards that believe the model would miss a fault. (The floor,
//! `thermal::guard::Floor`, holds in any case.)
//!
//! [`Bounds`] has the numbers by kind.

use super::{Bounds, HeaterModel};
use crate::connectors::Heater;
use crate::settings::{Range, ranges};
use crate::units::{JoulesPerKelvin, Seconds, Watts, WattsPerKelvin};

/// The plausible numbers of a heater's model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Plausible {
    /// Of the heater.
    pub power: Range<Watts>,
    /// Heat capacity, for this power.
    pub capacity: Range<JoulesPerKelvin>,
    /// Loss to the room, for this power; with the part fan as well, up to four times the most.
    pub loss: Range<WattsPerKelvin>,
    /// Each of the two.
    pub lag: Range<Seconds>,
}

impl Plausible {
    /// The plausible models of this kind of heater with this power.
    #[must_use]
    pub fn of(heater: Heater, power: Watts) -> Self {
        let bounds = Bounds::of(heater);
        let [coldest, hottest] = bounds.above_room;
        let watts = power.to_bits();
        // Watts have 16 fractional bits, W/K 24.
        let loss = |kelvin: u16| {
            let bits = (u64::from(watts) << 8) / u64::from(kelvin);
            ranges::LOSS.clamp(WattsPerKelvin::from_bits(u32::try_from(bits).unwrap_or(u32::MAX)))
        };
        let [least, most] = bounds.power.map(Watts::from_num);
        let capacity = bounds.capacity(power);
        Self {
            power: Range { least, most },
            capacity: Range {
                least: ranges::CAPACITY.clamp(capacity.least),
                most: ranges::CAPACITY.clamp(capacity.most),
            },
            loss: Range { least: loss(hottest), most: loss(coldest) },
            lag: Range { least: ranges::LAG.least, most: ranges::LAG.clamp(bounds.lag.most) },
        }
    }

    /// Loss to the room and to the part fan at full speed together.
    #[must_use]
    pub fn whole_loss(&self, loss: WattsPerKelvin) -> Range<WattsPerKelvin> {
        Range { least: loss, most: ranges::LOSS.clamp(self.loss.most.saturating_mul_int(4)) }
    }

    /// The keys, as in machine files, of a model's values that no heater of this kind and power has.
    pub fn beyond(&self, power: Watts, model: &HeaterModel) -> impl Iterator<Item = &'static str> + use<> {
        // Any legal growth is that of some heater.
        let HeaterModel { capacity, loss, fan_loss, heater_lag, sensor_lag, ptc: _ } = *model;
        [
            ("power", self.power.holds(power)),
            ("model.capacity", self.capacity.holds(capacity)),
            ("model.loss", self.loss.holds(loss)),
            ("model.fan_loss", self.whole_loss(loss).holds(loss.saturating_add(fan_loss))),
            ("model.heater_lag", self.lag.holds(heater_lag)),
            ("model.sensor_lag", self.lag.holds(sensor_lag)),
        ]
        .into_iter()
        .filter_map(|(key, is_plausible)| (!is_plausible).then_some(key))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::settings::ThermalSettings;
    use crate::units::Ratio;
    use std::vec::Vec;

    fn beyond(heater: Heater, power: f64, [capacity, loss, lag]: [f64; 3]) -> Vec<&'static str> {
        let (power, lag) = (Watts::from_num(power), Seconds::from_num(lag));
        let model = HeaterModel {
            capacity: JoulesPerKelvin::from_num(capacity),
            loss: WattsPerKelvin::from_num(loss),
            fan_loss: WattsPerKelvin::ZERO,
            heater_lag: lag,
            sensor_lag: lag,
            ptc: Ratio::ZERO,
        };
        Plausible::of(heater, power).beyond(power, &model).collect()
    }

    #[test]
    fn heaters_that_there_are_are_plausible_and_slips_of_the_pen_are_not() {
        let thermal = ThermalSettings::prototype();
        for heater in Heater::ALL {
            let settings = thermal.heater(heater);
            let plausible = Plausible::of(heater, settings.power);
            assert_eq!(plausible.beyond(settings.power, &settings.model).count(), 0, "{heater:?}");
        }
        let none: [&str; 0] = [];
        for real in [(25.0, [34.0, 0.08, 2.0]), (115.0, [4.0, 0.05, 0.4]), (100.0, [20.0, 0.2, 3.0])] {
            assert_eq!(beyond(Heater::Hotend, real.0, real.1), none, "{real:?}");
        }
        for real in [(220.0, [5500.0, 2.0, 20.0]), (1000.0, [400.0, 10.0, 5.0]), (2000.0, [9000.0, 20.0, 40.0])] {
            assert_eq!(beyond(Heater::Bed, real.0, real.1), none, "{real:?}");
        }
        assert_eq!(beyond(Heater::Hotend, 40.0, [200.0, 0.075, 1.2]), ["model.capacity"]);
        assert_eq!(beyond(Heater::Hotend, 40.0, [10.8, 3.5, 1.2]), ["model.loss", "model.fan_loss"]);
        assert_eq!(beyond(Heater::Hotend, 40.0, [10.8, 0.075, 80.0]), ["model.heater_lag", "model.sensor_lag"]);
        assert_eq!(beyond(Heater::Hotend, 1.0, [1.0, 0.001, 1.2]), ["power"]);
        assert_eq!(beyond(Heater::Bed, 500.0, [10.8, 0.075, 1.2]), ["model.capacity", "model.loss"]);
    }
}
