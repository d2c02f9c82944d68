//! Sensors besides those that heaters are controlled by: thermistors in places where nothing heats, second sensors on a
//! heater, and the processor's own sensor. M105 and M122 report them. One that guards a heater takes its power at a
//! limit, and stops it beyond (`thermal::second_sensor`). Any other broken one is reported and stops nothing.

use super::Thermistor;
use crate::connectors::{Heater, SENSORS, Sensor};
use crate::settings::ranges;
use crate::settings::rows::{Choice, Spec, ValueKind, rows};
use crate::units::Celsius;
use serde::{Deserialize, Serialize};

/// Places of these sensors: their names in machine files and reports, and their letters in M105, which are Marlin's
/// (`print_heater_states`; R is its redundant sensor). A record holds them in this order.
pub const PLACES: [(&str, char); EXTRA_SENSORS] = [("chamber", 'C'), ("board", 'M'), ("probe", 'P'), ("second", 'R')];

/// Such sensors that a machine may have.
pub const EXTRA_SENSORS: usize = 4;

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

impl Choice for Option<Heater> {
    const ALL: &'static [(Self, &'static str)] = &[
        (None, "none"),
        (Some(Heater::Hotend), "hotend"),
        (Some(Heater::Bed), "bed"),
        (Some(Heater::Chamber), "chamber"),
    ];

    fn number(self) -> u8 {
        self.map_or(0, |heater| 1 + heater as u8)
    }

    fn numbered(number: u8) -> Option<Self> {
        match number {
            0 => Some(None),
            1 => Some(Some(Heater::Hotend)),
            2 => Some(Some(Heater::Bed)),
            3 => Some(Some(Heater::Chamber)),
            _ => None,
        }
    }
}

/// A sensor by which no heater is controlled.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct ExtraSensor {
    /// Whether there is one.
    pub is_fitted: bool,
    /// Its source.
    pub sensor: SensorSource,
    /// Its kind, if it is at an input.
    pub thermistor: Thermistor,
    /// The heater that gets no power while this sensor is hotter than [`most`](Self::most).
    pub guards: Option<Heater>,
    /// The highest temperature here, if it guards a heater.
    pub most: Celsius,
}

impl ExtraSensor {
    /// None of them, at the inputs that the prototype leaves free.
    #[must_use]
    pub const fn prototype() -> [Self; EXTRA_SENSORS] {
        const fn at(sensor: Sensor) -> ExtraSensor {
            ExtraSensor {
                is_fitted: false,
                sensor: SensorSource::At(sensor),
                thermistor: Thermistor::NTC_3950,
                guards: None,
                // Adhesives of mats end there.
                most: Celsius::const_from_int(150),
            }
        }
        [at(Sensor::Hotend1), at(Sensor::Hotend2), at(Sensor::Hotend3), at(Sensor::Hotend1)]
    }

    /// The heater that it guards, and its input.
    #[must_use]
    pub fn guarded(&self) -> Option<(Heater, Sensor)> {
        let SensorSource::At(sensor) = self.sensor else { return None };
        self.guards.filter(|_| self.is_fitted).map(|heater| (heater, sensor))
    }
}

rows! {
    for sensor in |s, part| s.thermal.sensors.get_mut(part),
        named &["sensors.chamber", "sensors.board", "sensors.probe", "sensors.second"];

    /// Whether the machine has this sensor, by which no heater is controlled: M105 reports it.
    106 "is_fitted" = &mut sensor.is_fitted, "", [Spec::SWITCH];
    /// The input of the sensor; or mcu, the sensor in the board's processor.
    107 "sensor" = &mut sensor.sensor, "", [Spec::choice::<SensorSource>()];
    /// The kind of sensor at an input; or an NTC by three points (C, Ohm), or by Ohm at 25 C, B in K and a cubic term.
    108 "thermistor" = &mut sensor.thermistor, "", [Spec::packed((1 << 47) - 1, ValueKind::Thermistor).from_zero()];
    /// The heater that it guards: a second sensor, as in the mat of a bed with the other one in its plate.
    160 "guards" = &mut sensor.guards, "", [Spec::choice::<Option<Heater>>()];
    /// Highest temperature at a sensor that guards: above it its heater gets no power; 15 C above it is a fault.
    161 "most" = &mut sensor.most, "C", [ranges::SECOND.spec()];
}
