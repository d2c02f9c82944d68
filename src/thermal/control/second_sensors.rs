//! Second sensors among the other work of thermal control.

use super::super::second_sensor::{SecondSensor, Verdict};
use super::{Found, ThermalControl};
use crate::connectors::HEATERS;
use crate::port::{ThermalPort, Wake};
use crate::settings::{EXTRA_SENSORS, ExtraSensor};
use crate::units::Celsius;

impl<H: ThermalPort, W: Wake> ThermalControl<'_, H, W> {
    /// Begins again with those that are others now.
    pub(super) fn take_sensors(&mut self, sensors: &[ExtraSensor; EXTRA_SENSORS]) {
        for ((second, old), new) in self.seconds.iter_mut().zip(&self.common.sensors).zip(sensors) {
            if (old.guarded(), old.thermistor) != (new.guarded(), new.thermistor) {
                *second = SecondSensor::new(new.thermistor);
            }
        }
    }

    /// What they say of each heater.
    pub(super) fn look_at_seconds(&mut self, found: &mut Found) -> [Verdict; HEATERS] {
        let mut verdicts = [Verdict::default(); HEATERS];
        for (second, extra) in self.seconds.iter_mut().zip(&self.common.sensors) {
            let Some((heater, sensor)) = extra.guarded() else { continue };
            let looped = &self.heaters[heater as usize];
            if !looped.settings().is_fitted {
                continue;
            }
            let is_off = looped.target() == Celsius::ZERO && !looped.is_powered();
            match second.look(self.status.heat().sample(sensor), extra, is_off) {
                Ok(verdict) => verdicts[heater as usize] = verdicts[heater as usize].and(verdict),
                Err(alarm) => found.add(heater, alarm),
            }
        }
        verdicts
    }
}
