//! Why a heater is refused: as a fault has it, with its numbers and its remedy, but nothing stops.

use super::guard::LEAST;
use crate::connectors::Heater;
use crate::fault::{Cause, Fault};
use crate::settings::ThermalSettings;
use crate::status::Heat;
use crate::units::Celsius;

/// Why this heater must not heat: it has no reading, or one that cannot be right.
#[must_use]
pub fn refusal(heat: &Heat, heater: Heater, thermal: &ThermalSettings) -> Option<Fault> {
    let cause = heat.ailment(heater).filter(|_| thermal.heater(heater).is_fitted)?;
    let value = heat.measured(heater).unwrap_or(Celsius::ZERO);
    let limit = if cause == Cause::TooHot { thermal.heater(heater).too_hot() } else { LEAST };
    Some(Fault { cause, subject: heater as u8, value: value.to_bits(), limit: limit.to_bits() })
}
