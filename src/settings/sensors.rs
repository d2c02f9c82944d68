//! Sensors without a heater: thermistors in places where nothing heats, and the processor's own sensor. M105 and M122
//! report them, and nothing else reads them. So a broken one is reported and stops nothing. A heater on the same input
//! has its own guards.

use super::Thermistor;
use super::rows::{Choice, Spec, ValueKind, rows};
use crate::connectors::{SENSORS, Sensor};
use serde::{Deserialize, Serialize};

/// Places of sensors without a heater: their names in machine files and reports, and their letters in M105, which are
/// Marlin's (`print_heater_states`).
pub const PLACES: [(&str, char); EXTRA_SENSORS] = [("chamber", 'C'), ("board", 'M'), ("probe", 'P')];

/// Sensors without a heater that a machine may have.
pub const EXTRA_SENSORS: usize = 3;

/// The source of a reading without a heater. No heater can have the processor's sensor.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum SensorSource {
    /// A thermistor at this input.
    At(Sensor),
    /// The sensor in the processor.
    Mcu,
}

impl SensorSource {
    /// The name in machine files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(source, _)| *source == self).map_or("", |(_, name)| name)
    }

    /// Every thermistor's input, then the processor: records hold the place in this list.
    const fn all() -> [(Self, &'static str); SENSORS + 1] {
        let mut all = [(Self::Mcu, "mcu"); SENSORS + 1];
        let (mut places, mut inputs) = (all.as_mut_slice(), Sensor::ALL.as_slice());
        while let ([place, other_places @ ..], [(input, name), other_inputs @ ..]) = (places, inputs) {
            *place = (Self::At(*input), *name);
            (places, inputs) = (other_places, other_inputs);
        }
        all
    }
}

impl Choice for SensorSource {
    const ALL: &'static [(Self, &'static str)] = &Self::all();

    fn number(self) -> u8 {
        match self {
            Self::At(sensor) => sensor.number(),
            Self::Mcu => SENSORS as u8,
        }
    }

    fn numbered(number: u8) -> Option<Self> {
        if usize::from(number) == SENSORS { Some(Self::Mcu) } else { Sensor::numbered(number).map(Self::At) }
    }
}

/// A sensor without a heater.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct ExtraSensor {
    /// Whether there is one.
    pub is_fitted: bool,
    /// Its source.
    pub sensor: SensorSource,
    /// Its kind, if it is at an input.
    pub thermistor: Thermistor,
}

impl ExtraSensor {
    /// None of them, at the inputs that the prototype leaves free.
    #[must_use]
    pub const fn prototype() -> [Self; EXTRA_SENSORS] {
        const fn at(sensor: Sensor) -> ExtraSensor {
            ExtraSensor { is_fitted: false, sensor: SensorSource::At(sensor), thermistor: Thermistor::NTC_3950 }
        }
        [at(Sensor::Hotend1), at(Sensor::Hotend2), at(Sensor::Hotend3)]
    }
}

rows! {
    for sensor in |s, part| s.sensors.get_mut(part), named &["sensors.chamber", "sensors.board", "sensors.probe"];

    /// Whether the machine has this sensor, which no heater depends on: M105 reports it.
    106 "is_fitted" = &mut sensor.is_fitted, "", [Spec::SWITCH];
    /// The input of the sensor; or mcu, the sensor in the board's processor.
    107 "sensor" = &mut sensor.sensor, "", [Spec::choice::<SensorSource>()];
    /// The kind of sensor at an input; or an NTC by three points (C, Ohm), or by Ohm at 25 C, B in K and a cubic term.
    108 "thermistor" = &mut sensor.thermistor, "", [Spec::packed((1 << 47) - 1, ValueKind::Thermistor).from_zero()];
}
