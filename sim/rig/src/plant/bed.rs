//! The bed: a mat that heats and a plate that is printed on.

use super::constants::BedConstants;

/// Its temperatures, C.
pub(super) struct Bed {
    pub mat: f64,
    pub plate: f64,
}

impl Bed {
    /// In a steady state with the plate at `celsius`.
    pub(super) fn at(c: &BedConstants, celsius: f64, ambient: f64) -> Self {
        let watt = c.plate_to_air_watt_per_kelvin * (celsius - ambient);
        Self { mat: celsius + watt / c.mat_to_plate_watt_per_kelvin, plate: celsius }
    }

    /// One explicit Euler step.
    pub(super) fn step(&mut self, c: &BedConstants, watt: f64, ambient_celsius: f64, seconds: f64) {
        let into_plate = c.mat_to_plate_watt_per_kelvin * (self.mat - self.plate);
        let out_of_plate = c.plate_to_air_watt_per_kelvin * (self.plate - ambient_celsius);
        self.mat += seconds * (watt - into_plate) / c.mat_joule_per_kelvin;
        self.plate += seconds * (into_plate - out_of_plate) / c.plate_joule_per_kelvin;
    }
}
