//! The thermal plant: a hotend, a bed, perhaps a chamber, fans and a supply made of numbers, for controllers to heat.
//!
//! ```text
//! duty -> switch -> heater -> cartridge -> block -> air, filament, heatbreak
//!        (wiring.rs)          mat -> plate -> air                                (hotend.rs, bed.rs)
//! block, plate -> thermistor with lag -> divider -> converter with noise -> sample
//!                 (sensor.rs, thermistor.rs)        (converter.rs, wiring.rs)
//! ```
//! Lumps of heat (constants.rs, prototype.rs) in f64, with the crate libm for every function that the language lacks:
//! the host, QEMU and the emulator compute the same bits. A step is cut into parts of at most 5 ms; the same steps from
//! the same seed give the same readings. Nothing is limited: a part heated without end burns (in numbers). faults.rs
//! has the faults.
//!
//! Cost on a Cortex-M4 with f64 in software: some 6000 instructions a part, and 16,000 (bed) or 26,000 (hotend) a
//! reading (QEMU, -icount).

mod bed;
mod chamber;
mod constants;
mod converter;
mod faults;
mod hotend;
mod prototype;
mod sensor;
#[cfg(test)]
mod tests;
mod thermistor;
mod wiring;

pub use constants::{
    BedConstants, ChamberConstants, ConverterConstants, Couplings, HeaterConstants, HotendConstants, PlantConstants,
    SensorConstants,
};
pub use faults::{HeaterFault, PlantFaults, SensorFault};
pub use thermistor::Thermistor;

use bed::Bed;
use chamber::Chamber;
use converter::Channel;
use corehbot::connectors::Heater;
use corehbot::port::Sensor;
use hotend::{Hotend, HotendLoad};
use sensor::Thermometer;
use wiring::{Place, unit};

/// The longest part of a step, s. A two-hundredth of the shortest time constant (the cartridge's, 1 s), so that Euler's
/// error is some ms in time.
const LONGEST_PART: f64 = 0.005;

/// The chip's internal reference, V (STM32F446, DS10693: VREFINT 1.21 V typical).
const VREFINT_VOLTS: f64 = 1.21;

/// The board's outputs during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Duty of the hotend's heater, 0..=1.
    pub hotend: f64,
    /// Duty of the bed's heater, 0..=1.
    pub bed: f64,
    /// Duty of the chamber's heater, 0..=1.
    pub chamber: f64,
    /// Speed of the part fan, 0..=1.
    pub part_fan: f64,
    /// Speed of the hotend fan, 0..=1.
    pub hotend_fan: f64,
    /// Filament that goes through the nozzle, mm^3/s; none if negative.
    pub flow_mm3_s: f64,
    /// PS_ON: without it neither heaters nor fans have power.
    pub supply_on: bool,
}

impl Drive {
    /// Powered, the hotend fan running, and nothing else.
    pub const IDLE: Self =
        Self { hotend: 0.0, bed: 0.0, chamber: 0.0, part_fan: 0.0, hotend_fan: 1.0, flow_mm3_s: 0.0, supply_on: true };
}

/// The simulated heat of a machine.
pub struct Plant {
    constants: PlantConstants,
    faults: PlantFaults,
    hotend: Hotend,
    bed: Bed,
    chamber: Chamber,
    hotend_sensor: Thermometer,
    bed_sensor: Thermometer,
    chamber_sensor: Thermometer,
    /// Bed, hotend, VREFINT, chamber.
    channels: [Channel; 4],
}

impl Plant {
    /// Everything at the room's temperature.
    #[must_use]
    pub fn new(constants: &PlantConstants) -> Self {
        Self::hot(constants, constants.ambient_celsius, constants.ambient_celsius)
    }

    /// A hotend and a bed that have long been so hot, with the hotend fan running.
    #[must_use]
    pub fn hot(constants: &PlantConstants, hotend_celsius: f64, bed_celsius: f64) -> Self {
        Self {
            constants: constants.clone(),
            faults: PlantFaults::none(constants),
            hotend: Hotend::at(&constants.hotend, hotend_celsius, constants.ambient_celsius),
            bed: Bed::at(&constants.bed, bed_celsius, constants.ambient_celsius),
            chamber: Chamber::at(constants.ambient_celsius),
            hotend_sensor: Thermometer::at(hotend_celsius),
            bed_sensor: Thermometer::at(bed_celsius),
            chamber_sensor: Thermometer::at(constants.ambient_celsius),
            channels: [0, 1, 2, 3].map(|number| Channel::new(&constants.converter, number)),
        }
    }

    /// Time passes under `drive`.
    pub fn step(&mut self, drive: &Drive, seconds: f64) {
        if seconds.is_nan() || seconds <= 0.0 {
            return;
        }
        // 1e-9: 5 ms with a rounding error is one part.
        let parts = libm::ceil(seconds / LONGEST_PART - 1e-9).max(1.0);
        let part = seconds / parts;
        let [hotend_watt, bed_watt, chamber_watt] = self.watts(drive);
        let ambient_celsius = self.faults.ambient_celsius;
        let fan = |speed, broken| if broken || !drive.supply_on { 0.0 } else { unit(speed) };
        let load = HotendLoad {
            watt: hotend_watt,
            flow_mm3_s: drive.flow_mm3_s,
            part_fan: fan(drive.part_fan, self.faults.part_fan_broken),
            hotend_fan: fan(drive.hotend_fan, self.faults.hotend_fan_broken),
            ambient_celsius,
            draught: self.faults.draught,
            contact: self.faults.hotend_heater.contact,
        };
        let (c, f) = (&self.constants, &self.faults);
        for _ in 0..parts as u64 {
            self.hotend.step(&c.hotend, &load, part);
            self.bed.step(&c.bed, bed_watt, ambient_celsius, part);
            self.hotend_sensor.step(&c.hotend.sensor, f.hotend_sensor, self.hotend.block, ambient_celsius, part);
            let at_sensor = if c.bed.is_sensor_in_mat { self.bed.mat } else { self.bed.plate };
            self.bed_sensor.step(&c.bed.sensor, f.bed_sensor, at_sensor, ambient_celsius, part);
            if let Some(chamber) = &c.chamber {
                self.chamber.step(chamber, chamber_watt, ambient_celsius, part);
                let (air, fault) = (self.chamber.air, f.chamber_sensor);
                self.chamber_sensor.step(&chamber.sensor, fault, air, ambient_celsius, part);
            }
            couple(c, &mut self.hotend.block, &mut self.bed.plate, &mut self.chamber.air, part);
        }
    }

    /// The temperature of block and nozzle, C: the truth, not the sensor's reading.
    #[must_use]
    pub const fn hotend_celsius(&self) -> f64 {
        self.hotend.block
    }

    /// The temperature of the plate's surface, C.
    #[must_use]
    pub const fn bed_celsius(&self) -> f64 {
        self.bed.plate
    }

    /// The temperature of the chamber's air, C; the room's at power-up without a chamber.
    #[must_use]
    pub const fn chamber_celsius(&self) -> f64 {
        self.chamber.air
    }

    /// The reading of a second sensor of such a kind in the element of a heater: in its cartridge, its mat, or the fins
    /// of the chamber's heater.
    #[must_use]
    pub fn second_sample(&self, heater: Heater, kind: &Thermistor) -> u16 {
        let celsius = match heater {
            Heater::Hotend => self.hotend.cartridge,
            Heater::Bed => self.bed.mat,
            Heater::Chamber => self.chamber.element,
        };
        match self.faults.second_sensor {
            SensorFault::Open | SensorFault::ShortToSupply => u16::MAX,
            SensorFault::ShortToGround => 0,
            _ => share_at(kind, celsius, self.constants.converter.pull_up_ohm),
        }
    }

    /// A hand holds the part with this heater's sensor until it is so warm, in C.
    pub const fn hold(&mut self, heater: Heater, celsius: f64) {
        match heater {
            Heater::Hotend => self.hotend.block = celsius,
            Heater::Bed => self.bed.plate = celsius,
            Heater::Chamber => self.chamber.air = celsius,
        }
    }

    /// A plate of `celsius` C, with this part of the bed's heat capacity, is laid on the bed.
    pub fn lay_plate(&mut self, celsius: f64, part: f64) {
        self.bed.plate += (celsius - self.bed.plate) * unit(part) / (1.0 + unit(part));
    }

    /// The temperature of the heat sink above the heatbreak, C, where filament must not soften.
    #[must_use]
    pub const fn sink_celsius(&self) -> f64 {
        self.hotend.sink
    }

    /// The temperature of the hottest thing there is, cartridge and mat included, C.
    #[must_use]
    pub fn hottest_celsius(&self) -> f64 {
        let of_chamber = self.chamber.element.max(self.chamber.air);
        self.hotend.cartridge.max(self.hotend.block).max(self.bed.mat).max(self.bed.plate).max(of_chamber)
    }

    /// The converter's reading at a sensor, as in [`corehbot::port::ThermalPort::sample`].
    pub fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        match sensor {
            Sensor::Bed => self.read(Place::Bed),
            Sensor::Hotend0 => self.read(Place::Hotend),
            // The connector of a chamber's sensor on the prototype.
            Sensor::Hotend1 if self.constants.chamber.is_some() => self.read(Place::Chamber),
            Sensor::Hotend1 | Sensor::Hotend2 | Sensor::Hotend3 => None,
        }
    }

    /// A single conversion at a sensor, 0 to 4095, for a board with a converter that adds them up itself.
    pub fn convert(&mut self, sensor: Sensor) -> Option<u16> {
        match sensor {
            Sensor::Bed => self.arrive(Place::Bed, Channel::convert),
            Sensor::Hotend0 => self.arrive(Place::Hotend, Channel::convert),
            Sensor::Hotend1 if self.constants.chamber.is_some() => self.arrive(Place::Chamber, Channel::convert),
            Sensor::Hotend1 | Sensor::Hotend2 | Sensor::Hotend3 => None,
        }
    }

    /// The reading at its internal reference, in 1/65,536 of VDDA: 1.21 V / VDDA.
    pub fn vref_sample(&mut self) -> Option<u16> {
        self.read(Place::Vrefint)
    }

    /// The faults, to be changed at any time.
    pub const fn faults(&mut self) -> &mut PlantFaults {
        &mut self.faults
    }
}

/// The reading of a thermistor under a pull-up at a temperature, in 1/65,536 of the reference.
#[must_use]
pub fn share_at(kind: &Thermistor, celsius: f64, pull_up_ohm: f64) -> u16 {
    let ohm = kind.ohm(celsius);
    (65_536.0 * ohm / (ohm + pull_up_ohm)) as u16
}

/// Heat flows between neighbours; heat that leaves one enters the other.
fn couple(c: &PlantConstants, block: &mut f64, plate: &mut f64, air: &mut f64, seconds: f64) {
    let Couplings { hotend_bed, hotend_chamber, bed_chamber } = c.couplings;
    if c.couplings == Couplings::default() {
        return;
    }
    let joule = |coupling: f64, from: f64, to: f64| seconds * coupling * (from - to);
    let [to_plate, to_air, up] =
        [joule(hotend_bed, *block, *plate), joule(hotend_chamber, *block, *air), joule(bed_chamber, *plate, *air)];
    *block -= (to_plate + to_air) / c.hotend.block_joule_per_kelvin;
    *plate += (to_plate - up) / c.bed.plate_joule_per_kelvin;
    // Without a chamber there is a room at a constant temperature.
    if let Some(chamber) = &c.chamber {
        *air += (to_air + up) / chamber.air_joule_per_kelvin;
    }
}
