//! The prototype's figures, each with its source. Figures marked `[estimate]` were not measured, and wait for a
//! measurement on a machine.

use super::constants::{
    BedConstants, ChamberConstants, ConverterConstants, Couplings, HeaterConstants, HotendConstants, PlantConstants,
    SensorConstants,
};
use super::thermistor::Thermistor;

impl PlantConstants {
    /// The prototype: an E3D V6 with 40 W, and a plate of 430 x 400 mm with 500 W.
    #[must_use]
    pub fn prototype() -> Self {
        Self {
            hotend: HotendConstants {
                // Together 10.8 J/K; Marlin's default for MPC is 16.7 J/K, users' tuned values are 10 to 14 J/K. Some
                // 4 g of steel and magnesia (0.45 J/gK): 1.8 J/K; aluminium block and brass nozzle: 9 J/K [estimate].
                cartridge_joule_per_kelvin: 1.8,
                block_joule_per_kelvin: 9.0,
                // 30 g of aluminium, 897 J/kgK [estimate].
                sink_joule_per_kelvin: 27.0,
                // A cartridge of 6 mm in a reamed and clamped bore [estimate].
                cartridge_to_block_watt_per_kelvin: 1.5,
                // With the heatbreak's 0.02 W/K in all 0.07 W/K; Marlin's default for MPC: 0.068 W/K.
                block_to_air_watt_per_kelvin: 0.05,
                // 17 cm^2 of emissivity 0.5: 0.01 W/K more at 215 C [estimate].
                block_to_air_rise_watt_per_kelvin_sq: 5e-5,
                // Marlin's defaults for MPC differ by 0.029 W/K with and without fan; a fan that blows harder
                // [estimate].
                part_fan_watt_per_kelvin: 0.05,
                // A throat of steel: 16 W/(m K), 3 mm^2 of wall, 2.3 mm long [estimate].
                block_to_sink_watt_per_kelvin: 0.0208,
                // An E3D V6 sink without fan gets some 80 C hot [estimate].
                sink_to_air_watt_per_kelvin: 0.05,
                // A fan of 30 mm [estimate].
                hotend_fan_watt_per_kelvin: 0.45,
                // PLA: 1.24 g/cm^3 times 1.8 J/gK = 2.2e-3. Marlin's default: 5.6e-3 J/K a mm of 1.75 mm filament
                // (2.405 mm^2) = 2.3e-3.
                filament_joule_per_mm3_kelvin: 0.0023,
                heater: HeaterConstants { nominal_watt: 40.0, nominal_volts: 24.0, ptc_per_kelvin: 0.0 },
                // Marlin's default for MPC, 0.22 1/s, is 4.5 s; a sensor in a cartridge of its own is faster
                // [estimate].
                sensor: SensorConstants { thermistor: Thermistor::semitec_104gt2(), lag_seconds: 1.2 },
            },
            bed: BedConstants {
                // A silicone mat of 0.8 mm and 0.172 m^2: 170 g, 1.2 J/gK [estimate].
                mat_joule_per_kelvin: 200.0,
                // 430 x 400 x 3.6 mm of aluminium, 2700 kg/m^3, 897 J/kgK.
                plate_joule_per_kelvin: 1500.0,
                // Half of it, 0.2 W/(m K), is 86 W/K; glue takes half of that [estimate].
                mat_to_plate_watt_per_kelvin: 40.0,
                // 0.172 m^2, both sides, some 10 W/(m^2 K) [estimate].
                plate_to_air_watt_per_kelvin: 3.5,
                heater: HeaterConstants { nominal_watt: 500.0, nominal_volts: 24.0, ptc_per_kelvin: 0.0 },
                // [estimate]
                sensor: SensorConstants { thermistor: Thermistor::NTC_100K_B3950, lag_seconds: 5.0 },
                is_sensor_in_mat: false,
            },
            chamber: None,
            couplings: Couplings::default(),
            converter: ConverterConstants {
                // 10.5 effective bits of 12, as such converters have: 2^(12 - 10.5) / sqrt(12) [estimate].
                noise_lsb: 0.8,
                seed: 1,
                // BTT Octopus, schematic: 4.7 kOhm.
                pull_up_ohm: 4700.0,
                vdda_volts: 3.3,
            },
            ambient_celsius: 25.0,
            supply_volts: 24.0,
        }
    }
}

impl ChamberConstants {
    /// A heater of 300 W that blows into half a cubic metre: the values of the firmware's model of a chamber.
    #[must_use]
    pub fn usual() -> Self {
        Self {
            // Fins and frame of 0.5 kg of aluminium, 897 J/kgK [estimate].
            element_joule_per_kelvin: 450.0,
            // 0.5 m^3 of air (1.2 kg/m^3, 1005 J/kgK) is 600 J/K; walls and frame make it 5550 [estimate].
            air_joule_per_kelvin: 5550.0,
            // A fan that keeps the fins 13 K above the air at 300 W [estimate].
            element_to_air_watt_per_kelvin: 22.5,
            // Panels of 2 m^2, 2.5 W/(m^2 K) [estimate].
            air_to_room_watt_per_kelvin: 5.0,
            heater: HeaterConstants { nominal_watt: 300.0, nominal_volts: 24.0, ptc_per_kelvin: 0.0 },
            // A bead in moving air [estimate].
            sensor: SensorConstants { thermistor: Thermistor::NTC_100K_B3950, lag_seconds: 20.0 },
        }
    }
}
