//! Heat: heaters with their sensors, models and guards, and fans.

mod bounds;
pub(super) mod fans;
pub(super) mod heater;
mod plausible;
pub(super) mod sensors;
mod thermistor;

pub use bounds::Bounds;
pub use fans::{FanRole, FanSettings, part_fans};
pub use heater::{Control, Guards, HeaterModel, HeaterSettings, Pid};
pub use plausible::Plausible;
pub use sensors::{EXTRA_SENSORS, ExtraSensor, PLACES, SensorSource};
pub use thermistor::{Law, SHEETS, Sheet, Thermistor};

use super::ranges;
use super::rows::rows;
use crate::connectors::{FANS, HEATERS, Heater, Output, Sensor};
use crate::units::{Celsius, WattsPerKelvin};
use serde::{Deserialize, Serialize};

/// The heaters.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Heaters {
    /// T.
    pub hotend: HeaterSettings,
    /// B.
    pub bed: HeaterSettings,
    /// C.
    pub chamber: HeaterSettings,
}

impl Heaters {
    /// All of them, in the order of [`Heater::ALL`].
    pub const fn all(&self) -> [&HeaterSettings; HEATERS] {
        [&self.hotend, &self.bed, &self.chamber]
    }

    /// One of them, by its place there.
    const fn get_mut(&mut self, heater: usize) -> Option<&mut HeaterSettings> {
        match heater {
            0 => Some(&mut self.hotend),
            1 => Some(&mut self.bed),
            2 => Some(&mut self.chamber),
            _ => None,
        }
    }
}

/// Everything about heat that makes one machine different from another.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct ThermalSettings {
    /// Hotend, bed and chamber.
    pub heaters: Heaters,
    /// Sensors besides those of the heaters, in the order of [`PLACES`](crate::settings::PLACES).
    pub sensors: [ExtraSensor; EXTRA_SENSORS],
    /// FAN0 and so on.
    pub fans: [FanSettings; FANS],
    /// No filament moves while the hotend is colder (M302 S).
    pub min_extrude: Celsius,
    /// The hotend's fan runs above this temperature.
    pub hotend_fan_above: Celsius,
    /// Run-on time in s of the controller's fan after the last motor or heater went off.
    pub fan_run_on_s: u16,
    /// Minutes without motion, print or command after which heaters go off.
    pub idle_min: u8,
    /// Heat that a mm of filament takes up for each K.
    pub filament: WattsPerKelvin,
}

impl ThermalSettings {
    /// The usual set of a machine of this size: a hotend of 40 W with a Semitec 104GT-2, and a bed of 500 W with a
    /// thermistor of B 3950. It has three fans: for the part, for the hotend and for the controller. Nothing is fitted
    /// before a machine file or M-code sets it.
    #[must_use]
    pub const fn prototype() -> Self {
        let fan = FanSettings::new(FanRole::Commanded);
        Self {
            heaters: Heaters {
                hotend: HeaterSettings::hotend(Output::He0, Sensor::Hotend0),
                bed: HeaterSettings::bed(Output::Bed, Sensor::Bed),
                chamber: HeaterSettings::chamber(Output::He1, Sensor::Hotend1),
            },
            sensors: ExtraSensor::prototype(),
            fans: [fan, FanSettings::new(FanRole::Hotend), FanSettings::new(FanRole::Controller), fan, fan, fan],
            min_extrude: Celsius::const_from_int(170),
            hotend_fan_above: Celsius::const_from_int(50),
            fan_run_on_s: 60,
            idle_min: 30,
            // Marlin's FILAMENT_HEAT_CAPACITY_PERMM for PLA of 1.75 mm: 2.4 mm3 of 1.24 g/cm3 and 1.8 J/(g K).
            filament: const { WattsPerKelvin::lit("0.0056") },
        }
    }

    /// Whether there is any heater.
    #[must_use]
    pub fn has_heater(&self) -> bool {
        self.heaters.all().into_iter().any(|heater| heater.is_fitted)
    }

    /// The settings of a heater.
    #[must_use]
    pub const fn heater(&self, heater: Heater) -> &HeaterSettings {
        match heater {
            Heater::Hotend => &self.heaters.hotend,
            Heater::Bed => &self.heaters.bed,
            Heater::Chamber => &self.heaters.chamber,
        }
    }

    /// The settings of a heater.
    #[must_use]
    pub const fn heater_mut(&mut self, heater: Heater) -> &mut HeaterSettings {
        match heater {
            Heater::Hotend => &mut self.heaters.hotend,
            Heater::Bed => &mut self.heaters.bed,
            Heater::Chamber => &mut self.heaters.chamber,
        }
    }
}

rows! {
    for thermal in |s, _| Some(&mut s.thermal), named &["thermal"];

    /// No filament moves while the hotend is colder (M302 S).
    65 "min_extrude" = &mut thermal.min_extrude, "C", [ranges::MIN_EXTRUDE.spec()];
    /// The hotend's fan runs above this temperature.
    66 "hotend_fan_above" = &mut thermal.hotend_fan_above, "C", [ranges::COLD_END.spec()];
    /// Time for which the controller's fan runs on after the last motor or heater.
    67 "fan_run_on_s" = &mut thermal.fan_run_on_s, "s", [ranges::RUN_ON_S.spec()];
    /// Time without use after which heaters go off.
    68 "idle_min" = &mut thermal.idle_min, "min", [ranges::IDLE_MIN.spec()];
    /// Heat that a mm of filament takes for each K.
    69 "filament" = &mut thermal.filament, "J/(mm K)", [ranges::FILAMENT.spec()];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{JoulesPerKelvin, Watts};

    #[test]
    fn a_machine_has_heaters_if_one_is_fitted() {
        let mut thermal = ThermalSettings::prototype();
        for heater in [&mut thermal.heaters.hotend, &mut thermal.heaters.bed, &mut thermal.heaters.chamber] {
            heater.is_fitted = false;
        }
        assert!(!thermal.has_heater());
        thermal.heaters.chamber.is_fitted = true;
        assert!(thermal.has_heater());
    }

    /// The differences of a chamber from a bed, and of a bed's guards from a hotend's.
    #[test]
    fn a_chamber_is_cooler_and_slower_than_a_bed_and_a_bed_than_a_hotend() {
        let Heaters { hotend, bed, chamber } = ThermalSettings::prototype().heaters;
        assert_eq!([hotend.most, bed.most, chamber.most].map(Celsius::to_num::<i32>), [285, 120, 70]);
        assert_eq!([bed.power, chamber.power].map(Watts::to_num::<i32>), [500, 300]);
        assert_eq!([bed.model.capacity, chamber.model.capacity].map(JoulesPerKelvin::to_num::<i32>), [1700, 6000]);
        let of = |guards: Guards| [guards.lost, guards.off_rise, guards.overshoot].map(Celsius::to_num::<i32>);
        assert_eq!([of(hotend.guards), of(bed.guards), of(chamber.guards)], [[10, 8, 20], [10, 5, 15], [10, 5, 15]]);
        assert_eq!([hotend.guards.lost_s, bed.guards.lost_s], [5, 20]);
    }
}
