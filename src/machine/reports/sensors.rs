//! What the temperature sensors say, before anybody makes degrees of it.

use crate::machine::console::{Console, PortSet};
use crate::port::{Pend, Sensor, ThermalPort};

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Part of M122: each sensor's share of the reference voltage in 1/65,536, or `-` if there is none or the
    /// converter has stopped. An open thermistor reads nearly 65,536, a shorted one nearly 0.
    pub(in crate::machine) fn say_sensors(&mut self) {
        for (sensor, name) in Sensor::ALL {
            match self.ports.sensors.sample(sensor) {
                Some(share) => self.say(format_args!("echo:sensor {name} {share}/65536")),
                None => self.say(format_args!("echo:sensor {name} -")),
            }
        }
    }
}
