//! A thermistor in its hole: it follows with a lag, and its wires may be broken.

use super::constants::SensorConstants;
use super::faults::SensorFault;

/// A thermistor and its wires.
pub(super) struct Thermometer {
    /// The bead's temperature, C.
    bead: f64,
    /// Time since a loose contact last opened, or since the fault began, s.
    phase: f64,
    /// The frozen reading.
    frozen: Option<u16>,
}

impl Thermometer {
    pub(super) const fn at(celsius: f64) -> Self {
        Self { bead: celsius, phase: 0.0, frozen: None }
    }

    /// Time passes; `hole` is the temperature of the part around the sensor.
    pub(super) fn step(&mut self, c: &SensorConstants, fault: SensorFault, hole: f64, ambient: f64, seconds: f64) {
        let (around, lag) = match fault {
            SensorFault::Slipped { lag_seconds } => (ambient, lag_seconds),
            SensorFault::ExtraLag { lag_seconds } => (hole, c.lag_seconds + lag_seconds),
            SensorFault::Leaves { share, seconds } => {
                let gone = (self.phase / seconds).min(1.0);
                (hole + (ambient - hole) * (1.0 - share) * gone, c.lag_seconds)
            }
            _ => (hole, c.lag_seconds),
        };
        self.bead += (around - self.bead) * (seconds / lag).min(1.0);

        match fault {
            SensorFault::Intermittent { period_seconds, .. } => {
                self.phase += seconds;
                if self.phase >= period_seconds {
                    self.phase -= period_seconds;
                }
            }
            SensorFault::Leaves { .. } | SensorFault::Series { .. } => self.phase += seconds,
            _ => self.phase = 0.0,
        }
        if fault != SensorFault::Frozen {
            self.frozen = None;
        }
    }

    /// The divider's output as a share of its reference, 0..=1.
    pub(super) fn share(&self, c: &SensorConstants, fault: SensorFault, pull_up_ohm: f64) -> f64 {
        let ohm = match fault {
            SensorFault::Open | SensorFault::ShortToSupply => return 1.0,
            SensorFault::ShortToGround => return 0.0,
            SensorFault::Intermittent { open_seconds, .. } if self.phase < open_seconds => return 1.0,
            SensorFault::Series { ohm, seconds } => c.thermistor.ohm(self.bead) + ohm * (self.phase / seconds).min(1.0),
            SensorFault::TenKiloOhm => c.thermistor.ohm(self.bead) / 10.0,
            _ => c.thermistor.ohm(self.bead),
        };
        ohm / (ohm + pull_up_ohm)
    }

    /// The reading that arrives: `fresh`, unless it is frozen.
    pub(super) fn reading(&mut self, fault: SensorFault, fresh: u16) -> u16 {
        match fault {
            SensorFault::Frozen => *self.frozen.get_or_insert(fresh),
            _ => {
                self.frozen = None;
                fresh
            }
        }
    }
}
