//! Heaters, fans and temperature sensors.

use crate::connectors::{OUTPUTS, OutputSet, Sensor};
use crate::units::Celsius;

/// Heaters, fans, temperature sensors, and their watchdog. Called from the thermal context only; no call may block or
/// lock.
pub trait ThermalPort {
    /// The converter's reading: its part of the reference voltage, in units of 1/65,536. `None` if there is no such
    /// sensor, or if the converter has stopped: a value is never older than some milliseconds.
    fn sample(&mut self, sensor: Sensor) -> Option<u16>;

    /// The converter's reading of its internal reference, as a part of the supply in units of 1/65,536; `None` if the
    /// board does not measure it.
    fn reference(&mut self) -> Option<u16> {
        None
    }

    /// The processor's own temperature at the last [`reference`](Self::reference); `None` if it is not measured.
    fn mcu(&mut self) -> Option<Celsius> {
        None
    }

    /// Outputs that may heat: hardware switches them off by itself if [`heat`](Self::heat) is not called any more.
    fn outputs(&self) -> OutputSet {
        OutputSet::NONE
    }

    /// Switches each output on for this part of the coming control period, in units of 1/65,535; then it goes off by
    /// itself. Called once a period.
    fn heat(&mut self, _duties: &[u16; OUTPUTS]) {}

    /// Fans that there are, FAN0 and so on.
    fn fans(&self) -> usize {
        0
    }

    /// Runs a fan at this part of full speed, in units of 1/65,535, until the next call.
    fn set_fan(&mut self, _fan: usize, _duty: u16) {}

    /// The pulses that a fan's tachometer has given, wrapping; `None` where there is no tachometer.
    fn tachometer(&self, _fan: usize) -> Option<u16> {
        None
    }

    /// Whether filament presses the switch of its sensor; `None` without a sensor.
    fn filament(&self) -> Option<bool> {
        None
    }

    /// Whether the board can switch the power supply off (PS_ON).
    fn has_supply_switch(&self) -> bool {
        false
    }

    /// Switches the power supply on or off. A board that has switched it off keeps it off over resets, until power was
    /// cut or a user has asked twice (M999).
    fn switch_supply(&mut self, _on: bool) {}

    /// Every context has sent its heartbeat: restarts the watchdog's time.
    fn feed_watchdog(&mut self) {}
}

/// For machines without heaters.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHeaters;

impl ThermalPort for NoHeaters {
    fn sample(&mut self, _sensor: Sensor) -> Option<u16> {
        None
    }
}
