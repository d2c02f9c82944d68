//! Temperature sensors: those that control no heater in degrees, and raw readings of all.
//!
//! They are read here from the last sample of their input or of the processor. One that guards a heater is read by the
//! thermal control too (`thermal::second_sensor`).

use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::Hundredths;
use crate::port::Sensor;
use crate::settings::{EXTRA_SENSORS, PLACES, SensorSource, Settings};
use crate::status::Heat;
use crate::thermal::sensor::{Curve, Reading};
use core::fmt;

/// The readings of the sensors without a heater that are fitted, in the order of [`PLACES`].
pub(super) type ExtraReadings = [Option<Reading>; EXTRA_SENSORS];

/// Their latest readings. The chamber has none here if its heater has a sensor.
pub(super) fn extra_readings(settings: &Settings, heat: &Heat) -> ExtraReadings {
    let mut readings = settings.thermal.sensors.map(|extra| {
        let read = || match extra.sensor {
            SensorSource::At(sensor) => Curve::new(extra.thermistor).read(heat.sample(sensor)),
            SensorSource::Mcu => heat.mcu().map_or(Reading::Silent, Reading::Celsius),
        };
        extra.is_fitted.then(read)
    });
    let [chamber, ..] = &mut readings;
    if settings.thermal.heaters.chamber.is_fitted {
        *chamber = None;
    }
    readings
}

/// The same as M105 has them: ` C:25.00 /0.00`, a target of 0 as Marlin has it. A broken sensor has a word in place of
/// its number, which hosts that read numbers pass over.
pub(super) struct Extra<'r>(pub &'r ExtraReadings);

impl fmt::Display for Extra<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for ((_, letter), reading) in PLACES.into_iter().zip(self.0) {
            match reading {
                Some(Reading::Celsius(celsius)) => put!(f, " {letter}:{} /0.00", Hundredths::of(*celsius))?,
                Some(broken) => write!(f, " {letter}:{}", what_is_wrong(*broken))?,
                None => {}
            }
        }
        Ok(())
    }
}

/// Part of M122: the same, a line each.
pub(super) fn report_extra(to: &mut ReplyWriter<'_>, readings: &ExtraReadings) {
    for ((place, _), reading) in PLACES.into_iter().zip(readings) {
        match reading {
            Some(Reading::Celsius(celsius)) => to.say(text!("echo:{place} {} C", Hundredths::of(*celsius))),
            Some(broken) => to.say(text!("echo:{place} has no reading: {}", what_is_wrong(*broken))),
            None => {}
        }
    }
}

/// Why there is no temperature, in a word.
pub(super) const fn what_is_wrong(reading: Reading) -> &'static str {
    match reading {
        Reading::Open => "open",
        Reading::Short => "short",
        Reading::Silent | Reading::Celsius(_) => "none",
    }
}

/// Part of M122: each sensor's share of the reference voltage in 1/65,536, or `-` if there is none or the
/// converter has stopped. An open thermistor reads nearly 65,536, a shorted one nearly 0.
pub(in crate::machine) fn report_sensors(to: &mut ReplyWriter<'_>, heat: &Heat) {
    for (sensor, name) in Sensor::ALL {
        match heat.sample(sensor) {
            Some(share) => to.say(text!("echo:sensor {name} {share}/65536")),
            None => to.say(text!("echo:sensor {name} -")),
        }
    }
}
