//! Raw readings of the temperature sensors, before conversion to degrees.

use crate::machine::answers::speaker::Speaker;
use crate::port::Sensor;
use crate::status::Heat;

/// Part of M122: each sensor's share of the reference voltage in 1/65,536, or `-` if there is none or the
/// converter has stopped. An open thermistor reads nearly 65,536, a shorted one nearly 0.
pub(in crate::machine) fn report_sensors(to: &mut Speaker<'_>, heat: &Heat) {
    for (sensor, name) in Sensor::ALL {
        match heat.sample(sensor) {
            Some(share) => to.say(format_args!("echo:sensor {name} {share}/65536")),
            None => to.say(format_args!("echo:sensor {name} -")),
        }
    }
}
