//! The connections: outputs to heaters, thermistors to channels of the converter.
//!
//! A switch that sticks belongs to its output, and a heater's power to the heater, whichever output that is plugged
//! into. When plugs are swapped, a broken thermistor stays broken in the other socket.

use super::constants::HeaterConstants;
use super::converter::Channel;
use super::faults::HeaterFault;
use super::{Drive, Plant, VREFINT_VOLTS};

/// The temperature at which a heater has its nominal power, C.
const NOMINAL_CELSIUS: f64 = 25.0;

/// A place in the converter's sequence.
#[derive(Clone, Copy)]
pub(super) enum Place {
    Bed,
    Hotend,
    Vrefint,
    Chamber,
}

impl Plant {
    /// The power of the heaters of hotend, bed and chamber, W.
    pub(super) fn watts(&self, drive: &Drive) -> [f64; 3] {
        if !drive.supply_on {
            return [0.0; 3];
        }
        let f = &self.faults;
        let conducts = |duty, fault: HeaterFault| if fault.stuck_on { 1.0 } else { unit(duty).max(fault.leaks) };
        let mut duties = [conducts(drive.hotend, f.hotend_heater), conducts(drive.bed, f.bed_heater)];
        if f.swapped_heaters {
            duties.reverse();
        }
        let watt = |duty: f64, heater: &HeaterConstants, celsius: f64, fault: HeaterFault| {
            let volts = f.supply_volts / heater.nominal_volts;
            let resistance = 1.0 + heater.ptc_per_kelvin * (celsius - NOMINAL_CELSIUS);
            duty * heater.nominal_watt * volts * volts * fault.power / resistance.max(0.1)
        };
        let [hotend, bed] = duties;
        let chamber = self.constants.chamber.as_ref().map(|chamber| {
            let duty = conducts(drive.chamber, f.chamber_heater);
            watt(duty, &chamber.heater, self.chamber.element, f.chamber_heater)
        });
        [
            watt(hotend, &self.constants.hotend.heater, self.hotend.cartridge, f.hotend_heater),
            watt(bed, &self.constants.bed.heater, self.bed.mat, f.bed_heater),
            chamber.unwrap_or_default(),
        ]
    }

    /// The reading that arrives from a place.
    pub(super) fn read(&mut self, place: Place) -> Option<u16> {
        self.arrive(place, Channel::read)
    }

    /// The reading of a place: the converter's channel computes it from the share of the reference. Only one way of
    /// reading is used with one plant: a frozen sensor keeps what arrived.
    pub(super) fn arrive(&mut self, place: Place, of: fn(&mut Channel, f64) -> u16) -> Option<u16> {
        let (c, f) = (&self.constants, &self.faults);
        if f.converter_stopped {
            return None;
        }
        let channel = &mut self.channels[place as usize];
        let shown = match (place, f.channels_slipped) {
            (place, false) => place,
            (Place::Bed, true) => Place::Hotend,
            (Place::Hotend, true) => Place::Vrefint,
            (Place::Vrefint, true) => Place::Bed,
            (Place::Chamber, true) => Place::Chamber,
        };
        if let Place::Chamber = shown {
            let (thermometer, fault) = (&mut self.chamber_sensor, f.chamber_sensor);
            let sensor = &c.chamber.as_ref()?.sensor;
            let fresh = of(channel, thermometer.share(sensor, fault, c.converter.pull_up_ohm));
            return Some(thermometer.reading(fault, fresh));
        }
        let of_hotend = match (shown, f.swapped_sensors) {
            (Place::Vrefint, _) => return Some(of(channel, VREFINT_VOLTS / f.vdda_volts)),
            (Place::Hotend, false) | (Place::Bed, true) => true,
            _ => false,
        };
        let (thermometer, constants, fault) = if of_hotend {
            (&mut self.hotend_sensor, &c.hotend.sensor, f.hotend_sensor)
        } else {
            (&mut self.bed_sensor, &c.bed.sensor, f.bed_sensor)
        };
        let fresh = of(channel, thermometer.share(constants, fault, c.converter.pull_up_ohm));
        Some(thermometer.reading(fault, fresh))
    }
}

/// Within 0..=1; 0 if it is no number.
pub(super) const fn unit(value: f64) -> f64 {
    value.max(0.0).min(1.0)
}
