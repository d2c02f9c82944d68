//! The accelerometer.

use crate::accelerometer::{Sample, SensorFault, SensorKind};

/// An accelerometer at the tool. Nothing here blocks: the board reads the sensor by itself, and the Console takes the
/// samples.
pub trait Accelerometer {
    /// Identifies a sensor of this kind and starts it at the rate nearest to so many samples a second. Samples of an
    /// earlier start are dropped. What fails is the answer of the following [`take`](Self::take).
    fn start(&mut self, kind: SensorKind, rate: u16);

    /// Moves as many of the oldest samples as are there and fit, and returns their number. The Console calls it every
    /// millisecond or so, and at least every 20 ms.
    ///
    /// # Errors
    /// [`SensorFault`], from then on up to the next start.
    fn take(&mut self, into: &mut [Sample]) -> Result<usize, SensorFault>;

    /// Stops the sensor.
    fn stop(&mut self);
}

/// For machines without a connector for an accelerometer.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoAccelerometer;

impl Accelerometer for NoAccelerometer {
    fn start(&mut self, _kind: SensorKind, _rate: u16) {}

    fn take(&mut self, _into: &mut [Sample]) -> Result<usize, SensorFault> {
        Err(SensorFault::Absent)
    }

    fn stop(&mut self) {}
}
