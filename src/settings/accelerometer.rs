//! The accelerometer at the tool: its type, and how it is mounted.

use super::rows::{Choice, Spec, numbers, rows};
use super::{Cartesian, ranges};
use crate::accelerometer::{SensorAxis, SensorKind};
use serde::{Deserialize, Serialize};

impl Choice for Option<SensorKind> {
    const ALL: &'static [(Self, &'static str)] =
        &[(None, "none"), (Some(SensorKind::Adxl345), "adxl345"), (Some(SensorKind::Lis2dw12), "lis2dw12")];

    fn number(self) -> u8 {
        self.map_or(0, |kind| 1 + kind as u8)
    }

    fn numbered(number: u8) -> Option<Self> {
        match number {
            0 => Some(None),
            1 => Some(Some(SensorKind::Adxl345)),
            2 => Some(Some(SensorKind::Lis2dw12)),
            _ => None,
        }
    }
}

impl Choice for SensorAxis {
    const ALL: &'static [(Self, &'static str)] = &[
        (Self::X, "x"),
        (Self::MinusX, "-x"),
        (Self::Y, "y"),
        (Self::MinusY, "-y"),
        (Self::Z, "z"),
        (Self::MinusZ, "-z"),
    ];

    numbers!(X MinusX Y MinusY Z MinusZ);
}

/// The accelerometer.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct AccelerometerSettings {
    /// Its type; none if there is none.
    pub kind: Option<SensorKind>,
    /// The axis of the sensor that points along each axis of the machine.
    pub axes: Cartesian<SensorAxis>,
    /// Samples a second.
    pub rate: u16,
}

impl AccelerometerSettings {
    /// None. The rate is Klipper's (adxl345.py).
    pub(super) const fn prototype() -> Self {
        Self { kind: None, axes: Cartesian { x: SensorAxis::X, y: SensorAxis::Y, z: SensorAxis::Z }, rate: 3200 }
    }
}

rows! {
    for sensor in |s, _| Some(&mut s.accelerometer), named &["accelerometer"];

    /// The accelerometer at the tool, plugged into the board's connector for one: "none", "adxl345" or "lis2dw12".
    148 "kind" = &mut sensor.kind, "", [Spec::choice::<Option<SensorKind>>()];
    /// Samples a second. The sensor takes the nearest rate that it has; a LIS2DW12 has 1600 at most.
    149 "rate" = &mut sensor.rate, "Hz", [ranges::SAMPLES.spec()];
}

/// Rows of [`AccelerometerSettings::axes`].
pub(super) mod axes {
    use super::*;

    rows! {
        for axis in |s, part| s.accelerometer.axes.get_mut(part),
            named &["accelerometer.axes.x", "accelerometer.axes.y", "accelerometer.axes.z"];

        /// The axis of the sensor that points this way: "x", "-x", "y", "-y", "z" or "-z".
        150 "" = axis, "", [Spec::choice::<SensorAxis>()];
    }
}
