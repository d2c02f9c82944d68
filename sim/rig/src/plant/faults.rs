//! The faults of a plant: a test writes these values at any time, and they hold from the next step or sample on. All of
//! them may be broken at once.

use super::constants::PlantConstants;
use corehbot::connectors::Heater;

/// The fault of a thermistor or its wires.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SensorFault {
    /// Nothing.
    #[default]
    None,
    /// A wire is off: full scale.
    Open,
    /// Shorted to ground: 0.
    ShortToGround,
    /// Shorted to 24 V; the clamp diodes hold the pin at the rail: full scale.
    ShortToSupply,
    /// The reading stays as it is at the next sample.
    Frozen,
    /// A loose contact: open for the first `open_seconds` of each `period_seconds`.
    Intermittent {
        /// s.
        period_seconds: f64,
        /// s.
        open_seconds: f64,
    },
    /// Out of its hole: it follows the room's temperature instead, with this time constant.
    Slipped {
        /// s.
        lag_seconds: f64,
    },
    /// In its hole, but badly: this much is added to its time constant.
    ExtraLag {
        /// s.
        lag_seconds: f64,
    },
    /// It leaves its hole in `seconds`, and shows the room from then on by all but `share` of the rise above it.
    Leaves {
        /// What it shows of the rise at the end: 0 is out.
        share: f64,
        /// s.
        seconds: f64,
    },
    /// Resistance of its plug, which grows in `seconds`.
    Series {
        /// Ohm at the end.
        ohm: f64,
        /// s.
        seconds: f64,
    },
    /// A thermistor of 10 kOhm at 25 C instead of 100 kOhm: a tenth of the resistance at any temperature.
    TenKiloOhm,
}

/// The fault of a heater or the switch (MOSFET) before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeaterFault {
    /// The part of its power that it has: 1 is healthy, 0 is an open heater.
    pub power: f64,
    /// Its switch conducts at any duty. Without supply (PS_ON) it is off all the same.
    pub stuck_on: bool,
    /// The part of full power that its switch leaks at any duty.
    pub leaks: f64,
    /// The part of its contact with what it heats: a cartridge that slides out has less. Only of the hotend.
    pub contact: f64,
}

impl HeaterFault {
    /// Nothing.
    pub const NONE: Self = Self { power: 1.0, stuck_on: false, leaks: 0.0, contact: 1.0 };
    /// No current flows.
    pub const OPEN: Self = Self { power: 0.0, ..Self::NONE };
    /// The switch conducts always.
    pub const STUCK_ON: Self = Self { stuck_on: true, ..Self::NONE };
    /// Three tenths of the current flow always.
    pub const LEAKY: Self = Self { leaks: 0.3, ..Self::NONE };
}

/// Everything that a test may break, and the surroundings that it may change.
#[derive(Clone, Debug)]
pub struct PlantFaults {
    /// The thermistor in the hotend's block.
    pub hotend_sensor: SensorFault,
    /// The thermistor at the bed's plate.
    pub bed_sensor: SensorFault,
    /// The thermistor in the chamber's air.
    pub chamber_sensor: SensorFault,
    /// A second sensor on a heater: of its faults, those of its wire.
    pub second_sensor: SensorFault,
    /// Each thermistor of hotend and bed is plugged into the other's socket.
    pub swapped_sensors: bool,
    /// The hotend's heater (`power`), and the switch of the hotend's output (`stuck_on`).
    pub hotend_heater: HeaterFault,
    /// The bed's heater, and the switch of the bed's output.
    pub bed_heater: HeaterFault,
    /// The chamber's heater, and the switch of the chamber's output.
    pub chamber_heater: HeaterFault,
    /// Each heater of hotend and bed is plugged into the other's output.
    pub swapped_heaters: bool,
    /// The part fan is blocked.
    pub part_fan_broken: bool,
    /// The hotend fan is blocked.
    pub hotend_fan_broken: bool,
    /// No more readings come.
    pub converter_stopped: bool,
    /// The readings are off by one place in the order bed, hotend, VREFINT: each place shows the following one's.
    pub channels_slipped: bool,
    /// Supply and reference of the converter, V. Thermistors are supplied by it too, so their readings do not change
    /// with it.
    pub vdda_volts: f64,
    /// Supply of the heaters while it is on, V.
    pub supply_volts: f64,
    /// The room's temperature, C.
    pub ambient_celsius: f64,
    /// A draught: the hotend's block loses so many times as much to the air.
    pub draught: f64,
}

impl PlantFaults {
    /// The thermistor of a heater.
    pub const fn sensor_of(&mut self, heater: Heater) -> &mut SensorFault {
        match heater {
            Heater::Hotend => &mut self.hotend_sensor,
            Heater::Bed => &mut self.bed_sensor,
            Heater::Chamber => &mut self.chamber_sensor,
        }
    }

    /// A heater and its switch.
    pub const fn heater_of(&mut self, heater: Heater) -> &mut HeaterFault {
        match heater {
            Heater::Hotend => &mut self.hotend_heater,
            Heater::Bed => &mut self.bed_heater,
            Heater::Chamber => &mut self.chamber_heater,
        }
    }

    /// Nothing broken.
    #[must_use]
    pub const fn none(constants: &PlantConstants) -> Self {
        Self {
            hotend_sensor: SensorFault::None,
            bed_sensor: SensorFault::None,
            chamber_sensor: SensorFault::None,
            second_sensor: SensorFault::None,
            swapped_sensors: false,
            hotend_heater: HeaterFault::NONE,
            bed_heater: HeaterFault::NONE,
            chamber_heater: HeaterFault::NONE,
            swapped_heaters: false,
            part_fan_broken: false,
            hotend_fan_broken: false,
            converter_stopped: false,
            channels_slipped: false,
            vdda_volts: constants.converter.vdda_volts,
            supply_volts: constants.supply_volts,
            ambient_celsius: constants.ambient_celsius,
            draught: 1.0,
        }
    }
}
