//! Why a heater is refused: as a fault has it, with its numbers and its remedy, but nothing stops.

use super::guard::LEAST;
use crate::connectors::Heater;
use crate::fault::{Cause, Fault};
use crate::settings::ThermalSettings;
use crate::status::Heat;
use crate::units::Celsius;

/// Why this heater must not heat: it has no reading, or one that cannot be right, or that differs from the other cold
/// heater's.
#[must_use]
pub fn refusal(heat: &Heat, heater: Heater, thermal: &ThermalSettings) -> Option<Fault> {
    let cause = heat.ailment(heater).filter(|_| thermal.heater(heater).is_fitted)?;
    let value = heat.measured(heater).unwrap_or(Celsius::ZERO);
    let limit = match cause {
        Cause::TooHot => thermal.heater(heater).too_hot(),
        Cause::SensorsDiffer => {
            let other = if heater == Heater::Hotend { Heater::Bed } else { Heater::Hotend };
            heat.measured(other).unwrap_or(Celsius::ZERO)
        }
        _ => LEAST,
    };
    Some(Fault { cause, subject: heater as u8, value: value.to_bits(), limit: limit.to_bits() })
}
