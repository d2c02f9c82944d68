//! The constants of a plant. Every field carries its unit in its name or its comment; prototype.rs has the figures.

use super::thermistor::Thermistor;

/// A machine's heat.
#[derive(Clone, Debug)]
pub struct PlantConstants {
    /// The hotend.
    pub hotend: HotendConstants,
    /// The bed.
    pub bed: BedConstants,
    /// The chamber, if it has a heater.
    pub chamber: Option<ChamberConstants>,
    /// The heat flows between them.
    pub couplings: Couplings,
    /// The converter that reads the thermistors.
    pub converter: ConverterConstants,
    /// The room's temperature at power-up, C.
    pub ambient_celsius: f64,
    /// The supply of heaters at power-up, V.
    pub supply_volts: f64,
}

/// A cartridge in a block with a nozzle, on a heatbreak under a heat sink. Heat goes
/// cartridge -> block -> air, filament, and heatbreak -> sink -> air.
#[derive(Clone, Debug)]
pub struct HotendConstants {
    /// Heat capacity of the cartridge, J/K.
    pub cartridge_joule_per_kelvin: f64,
    /// Heat capacity of block, nozzle and sensor, J/K.
    pub block_joule_per_kelvin: f64,
    /// Heat capacity of the heat sink, J/K.
    pub sink_joule_per_kelvin: f64,
    /// From cartridge to block, W/K.
    pub cartridge_to_block_watt_per_kelvin: f64,
    /// From block to still air close to the room's temperature, W/K.
    pub block_to_air_watt_per_kelvin: f64,
    /// Its growth for each kelvin of the block above the room (radiation), W/K^2.
    pub block_to_air_rise_watt_per_kelvin_sq: f64,
    /// Its growth by the part fan at full speed, W/K.
    pub part_fan_watt_per_kelvin: f64,
    /// From block to sink, through the heatbreak, W/K.
    pub block_to_sink_watt_per_kelvin: f64,
    /// From sink to still air, W/K.
    pub sink_to_air_watt_per_kelvin: f64,
    /// Its growth by the hotend fan at full speed, W/K.
    pub hotend_fan_watt_per_kelvin: f64,
    /// Heat that melted filament takes along, J/(mm^3 K).
    pub filament_joule_per_mm3_kelvin: f64,
    /// The heater.
    pub heater: HeaterConstants,
    /// The sensor in the block.
    pub sensor: SensorConstants,
}

/// A heated mat under a plate. Heat goes mat -> plate -> air.
#[derive(Clone, Debug)]
pub struct BedConstants {
    /// Heat capacity of the mat, J/K.
    pub mat_joule_per_kelvin: f64,
    /// Heat capacity of the plate, J/K.
    pub plate_joule_per_kelvin: f64,
    /// From mat to plate, W/K.
    pub mat_to_plate_watt_per_kelvin: f64,
    /// From plate to air, W/K.
    pub plate_to_air_watt_per_kelvin: f64,
    /// The heater.
    pub heater: HeaterConstants,
    /// The sensor at the plate.
    pub sensor: SensorConstants,
    /// It sits in the mat instead.
    pub is_sensor_in_mat: bool,
}

/// A heater that blows into a chamber. Heat goes element -> air -> room.
#[derive(Clone, Debug)]
pub struct ChamberConstants {
    /// Heat capacity of the element, J/K.
    pub element_joule_per_kelvin: f64,
    /// Heat capacity of the air and of the parts that it warms, J/K.
    pub air_joule_per_kelvin: f64,
    /// From element to air, W/K.
    pub element_to_air_watt_per_kelvin: f64,
    /// From air to room, W/K.
    pub air_to_room_watt_per_kelvin: f64,
    /// The heater.
    pub heater: HeaterConstants,
    /// The sensor in the air.
    pub sensor: SensorConstants,
}

/// Heat between two of the things that are heated, W/K: a nozzle near a plate, a plate in a chamber.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Couplings {
    /// Between block and plate.
    pub hotend_bed: f64,
    /// Between block and the chamber's air.
    pub hotend_chamber: f64,
    /// Between plate and the chamber's air.
    pub bed_chamber: f64,
}

/// A resistor: its power goes with the square of the voltage, and over the growth of its resistance.
#[derive(Clone, Debug)]
pub struct HeaterConstants {
    /// Its power at `nominal_volts`, W.
    pub nominal_watt: f64,
    /// V.
    pub nominal_volts: f64,
    /// Growth of its resistance for each K above 25 C: its power falls by as much. 0 without PTC.
    pub ptc_per_kelvin: f64,
}

/// A thermistor that follows the part it sits in, and takes no heat from it.
#[derive(Clone, Debug)]
pub struct SensorConstants {
    /// Its resistance at a temperature.
    pub thermistor: Thermistor,
    /// Time constant of its first-order lag, s.
    pub lag_seconds: f64,
}

/// 12 bits, 16 conversions to a reading.
#[derive(Clone, Debug)]
pub struct ConverterConstants {
    /// Standard deviation of one conversion's noise, in steps (LSB) of 12 bits.
    pub noise_lsb: f64,
    /// Seed of that noise.
    pub seed: u64,
    /// Pull-up resistor from the reference to the thermistor, ohm; the thermistor goes to ground.
    pub pull_up_ohm: f64,
    /// Supply and reference of the converter at power-up (VDDA = VREF+), V.
    pub vdda_volts: f64,
}
