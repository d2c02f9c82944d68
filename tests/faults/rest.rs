//! Beds and hotends that come to rest below a target that they cannot reach: full power, and a reading that stays. That
//! is no frozen reading, with any noise of the converter, and a frozen one on the way up is found as before.

use super::{break_it, constants, until_off};
use crate::printer::{Printer, settings};
use corehbot::connectors::Heater;
use corehbot::settings::Control;
use corehbot::thermal::Order;
use corehbot::units::{JoulesPerKelvin, Watts, WattsPerKelvin};
use corehbot_rig::plant::{PlantConstants, SensorFault};

/// A weak bed, that comes to rest at about this temperature in a room of 14 C. Its firmware knows a model that is off:
/// its capacity and its losses by these factors.
fn weak(rest: f64, joule_per_kelvin: f64, noise: f64, control: Control, [capacity, loss]: [f64; 2]) -> Printer {
    let watt = 220.0;
    let watt_per_kelvin = watt / (rest - 14.0);
    let mut plant = PlantConstants { ambient_celsius: 14.0, ..constants() };
    let share = joule_per_kelvin / (plant.bed.mat_joule_per_kelvin + plant.bed.plate_joule_per_kelvin);
    plant.bed.mat_joule_per_kelvin *= share;
    plant.bed.plate_joule_per_kelvin *= share;
    plant.bed.mat_to_plate_watt_per_kelvin *= share;
    plant.bed.plate_to_air_watt_per_kelvin = watt_per_kelvin;
    plant.bed.heater.nominal_watt = watt;
    plant.converter.noise_lsb = noise;
    let mut settings = settings();
    let bed = settings.heater_mut(Heater::Bed);
    (bed.power, bed.control) = (Watts::from_num(watt), control);
    bed.model.capacity = JoulesPerKelvin::from_num(joule_per_kelvin * capacity);
    bed.model.loss = WattsPerKelvin::from_num(watt_per_kelvin * loss);
    Printer::new(&plant, settings)
}

#[test]
fn a_bed_that_comes_to_rest_at_full_power_below_its_target_is_healthy() {
    let mut number = 0;
    for (rest, target) in [(60.0, 66.0), (75.0, 79.0), (95.0, 110.0)] {
        for noise in [0.0, 0.1, 0.3] {
            for model in [[1.0, 1.0], [0.8, 0.6], [1.25, 1.3]] {
                let control = [Control::Model, Control::Pid][number % 2];
                number += 1;
                let mut printer = weak(rest, 1075.0, noise, control, model);
                printer.set(Heater::Bed, target);
                printer.run(3600.0);
                let at = printer.bed();
                assert_eq!(printer.fault(), None, "rest {rest}, noise {noise}, {control:?}, model {model:?}: {at:.2}");
                assert!((at - rest).abs() < 3.0, "{at}");
            }
        }
    }
}

/// The part fan takes what a weak supply gives.
#[test]
fn a_hotend_that_comes_to_rest_in_the_wind_at_full_power_is_healthy() {
    for noise in [0.0, 0.1, 0.3] {
        let mut plant = PlantConstants { ambient_celsius: 14.0, ..constants() };
        (plant.converter.noise_lsb, plant.supply_volts) = (noise, 21.0);
        let mut printer = Printer::new(&plant, settings());
        printer.order(Order::Fan(0, u16::MAX));
        printer.set(Heater::Hotend, 260.0);
        printer.run(1500.0);
        assert_eq!(printer.fault(), None, "noise {noise}");
        assert!((170.0..257.0).contains(&printer.hotend()), "{}", printer.hotend());
    }
}

/// At any place of the way up, with a converter that is quiet or noisy.
#[test]
fn a_bed_whose_reading_freezes_on_the_way_up_is_off_within_a_minute() {
    for (rest, target) in [(75.0, 79.0), (130.0, 110.0)] {
        for noise in [0.0, 0.3, 1.0] {
            for freezes_at in [20.0, 40.0, 55.0, f64::min(0.85 * rest, 95.0)] {
                let mut printer = weak(rest, 1075.0, noise, Control::Pid, [1.0, 1.0]);
                printer.set(Heater::Bed, target);
                printer.run_until(3600.0, |printer| printer.bed() > freezes_at).unwrap();
                break_it(&printer, |faults| faults.bed_sensor = SensorFault::Frozen);
                let (cause, time) = until_off(&mut printer, 65.0);
                println!("frozen at {freezes_at:.0} of {rest} C, noise {noise}: {cause:?} after {time:.1} s");
            }
        }
    }
}
