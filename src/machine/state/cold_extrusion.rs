//! Cold extrusion: filament that is left out of moves because the hotend is too cold for it, unless M302 allows it.

use crate::connectors::Heater;
use crate::settings::ThermalSettings;
use crate::units::Celsius;

/// Whether filament may move at any temperature.
pub(in crate::machine) struct ColdExtrusion {
    /// M302 P1.
    is_allowed: bool,
}

impl ColdExtrusion {
    /// As after a reset: no filament moves in a hotend that is too cold.
    pub const fn new() -> Self {
        Self { is_allowed: false }
    }

    /// Whether M302 P1 was said.
    pub const fn is_allowed(&self) -> bool {
        self.is_allowed
    }

    /// M302: filament may move at any temperature, or may not.
    pub const fn allow(&mut self, is_allowed: bool) {
        self.is_allowed = is_allowed;
    }

    /// Whether filament must not move: the hotend, believed to be so hot, is too cold, or its temperature is unknown.
    pub fn is_too_cold(&self, thermal: &ThermalSettings, believed: Option<Celsius>) -> bool {
        thermal.heater(Heater::Hotend).is_fitted
            && !self.is_allowed
            && thermal.min_extrude > Celsius::ZERO
            && believed.is_none_or(|celsius| celsius < thermal.min_extrude)
    }
}
