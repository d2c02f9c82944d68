//! Accelerometer: a sensor at the tool that measures how the tool vibrates.
//!
//! A board reads it through [`port::Accelerometer`](crate::port::Accelerometer); the machine measures resonances by it.
//! Here are the types that both share.
//!
//! | word | means |
//! |---|---|
//! | sample | the acceleration along the three axes of the sensor, at one time |
//! | sensor axis | an axis of the sensor, by its own name |

use serde::{Deserialize, Serialize};

/// A type of sensor.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum SensorKind {
    /// Analog Devices.
    Adxl345,
    /// STMicroelectronics.
    Lis2dw12,
}

impl SensorKind {
    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Adxl345 => "ADXL345",
            Self::Lis2dw12 => "LIS2DW12",
        }
    }
}

/// The acceleration along the sensor's x, y and z, in mm/s^2.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Sample {
    /// x, y, z.
    pub axes: [i32; 3],
}

impl Sample {
    /// Along an axis of the sensor.
    #[must_use]
    pub fn along(&self, axis: SensorAxis) -> i32 {
        let (number, is_reversed) = axis.place();
        let value = self.axes.get(number).copied().unwrap_or_default();
        if is_reversed { value.saturating_neg() } else { value }
    }
}

/// An axis of the sensor, with its direction.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
#[allow(missing_docs, reason = "their names say it")]
pub enum SensorAxis {
    X,
    MinusX,
    Y,
    MinusY,
    Z,
    MinusZ,
}

impl SensorAxis {
    /// Its number, and whether it points the other way.
    const fn place(self) -> (usize, bool) {
        match self {
            Self::X => (0, false),
            Self::MinusX => (0, true),
            Self::Y => (1, false),
            Self::MinusY => (1, true),
            Self::Z => (2, false),
            Self::MinusZ => (2, true),
        }
    }
}

/// Why a sensor gives no samples.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SensorFault {
    /// The board has no connector for one.
    Absent,
    /// Its identity register read this: another sensor, or none.
    WrongId(u8),
    /// A register did not keep the value written to it.
    Register,
    /// Its FIFO was full, so samples are lost.
    Overflow,
    /// It has stopped to give samples.
    Silent,
    /// It gives the same sample all the time, or no possible one.
    Stuck,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_may_be_mounted_any_way_round() {
        let sample = Sample { axes: [1, -2, i32::MIN] };
        let all = [SensorAxis::X, SensorAxis::MinusX, SensorAxis::Y, SensorAxis::MinusY, SensorAxis::Z];
        assert_eq!(all.map(|axis| sample.along(axis)), [1, -1, -2, 2, i32::MIN]);
        assert_eq!(sample.along(SensorAxis::MinusZ), i32::MAX);
    }
}
