//! The chamber: an element that heats, and air that is blown through it.

use super::constants::ChamberConstants;

/// Its temperatures, C.
pub(super) struct Chamber {
    pub element: f64,
    pub air: f64,
}

impl Chamber {
    /// At the room's temperature.
    pub(super) const fn at(celsius: f64) -> Self {
        Self { element: celsius, air: celsius }
    }

    /// One explicit Euler step.
    pub(super) fn step(&mut self, c: &ChamberConstants, watt: f64, ambient_celsius: f64, seconds: f64) {
        let into_air = c.element_to_air_watt_per_kelvin * (self.element - self.air);
        let out_of_air = c.air_to_room_watt_per_kelvin * (self.air - ambient_celsius);
        self.element += seconds * (watt - into_air) / c.element_joule_per_kelvin;
        self.air += seconds * (into_air - out_of_air) / c.air_joule_per_kelvin;
    }
}
