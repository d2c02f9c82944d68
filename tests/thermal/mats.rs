//! Beds with a sensor in the mat: M303 waits for the plate, and the model that it finds raises no alarm.

use super::tuning::tune;
use crate::printer::{Printer, settings};
use corehbot::connectors::Heater;
use corehbot::settings::ThermalSettings;
use corehbot::status::{Tuned, Tuning};
use corehbot::thermal::Order;
use corehbot::units::{JoulesPerKelvin, Seconds, Watts, WattsPerKelvin};
use corehbot_rig::plant::PlantConstants;

/// A bed of such power and heat capacities of mat and plate, with W/K between them and to the room.
fn bed([watt, mat, plate, between, loss]: [f64; 5], lag: f64, in_mat: bool) -> (PlantConstants, ThermalSettings) {
    let mut constants = PlantConstants::prototype();
    let b = &mut constants.bed;
    (b.heater.nominal_watt, b.mat_joule_per_kelvin, b.plate_joule_per_kelvin) = (watt, mat, plate);
    (b.mat_to_plate_watt_per_kelvin, b.plate_to_air_watt_per_kelvin) = (between, loss);
    (b.sensor.lag_seconds, b.is_sensor_in_mat) = (lag, in_mat);
    let mut known = settings();
    known.heater_mut(Heater::Bed).power = Watts::from_num(watt);
    (constants, known)
}

/// Mats of 300 to 1500 W under plates of 700 to 6000 J/K.
const BEDS: [[f64; 5]; 4] = [
    [300.0, 80.0, 700.0, 20.0, 1.6],
    [500.0, 200.0, 1500.0, 40.0, 3.5],
    [750.0, 220.0, 3000.0, 50.0, 3.5],
    [1500.0, 350.0, 6000.0, 90.0, 6.0],
];

/// The first heating with what M303 has found, to a hotter target, for half an hour.
fn heat_with(constants: &PlantConstants, mut known: ThermalSettings, found: Tuned) {
    let model = &mut known.heater_mut(Heater::Bed).model;
    (model.capacity, model.loss) = (JoulesPerKelvin::from_bits(found.capacity), WattsPerKelvin::from_bits(found.loss));
    let lag = Seconds::from_bits(found.lag / 2);
    (model.heater_lag, model.sensor_lag) = (lag, lag);
    let mut printer = Printer::new(constants, known);
    for target in [60.0, 90.0, 70.0] {
        printer.set(Heater::Bed, target);
        printer.run(1140.0);
        // A relay of 1 s swings a mat of 1500 W by 4 K: the mean counts.
        let mut sum = 0.0;
        for _ in 0..300 {
            printer.run(0.2);
            sum += printer.measured(Heater::Bed);
        }
        assert_eq!(printer.fault(), None, "{target}");
        let mean = sum / 300.0;
        println!("   {mean:.2} of {target}");
        assert!((mean - target).abs() < 1.5, "{mean} of {target}");
    }
    printer.order(Order::Off);
    printer.run(900.0);
    assert_eq!(printer.fault(), None);
}

#[test]
fn m303_of_a_bed_waits_for_the_plate() {
    for values in BEDS {
        for (lag, in_mat) in [(0.5, true), (2.0, true), (6.0, true), (5.0, false)] {
            let (constants, known) = bed(values, lag, in_mat);
            let mut printer = Printer::new(&constants, known);
            printer.run(1.0);
            let (tuning, time) = tune(&mut printer, Heater::Bed, 60);
            assert_eq!((printer.fault(), tuning), (None, Tuning::Done), "{values:?}, {lag} s, {in_mat}");
            let found = printer.status.heat().tuned();
            let capacity = JoulesPerKelvin::from_bits(found.capacity).to_num::<f64>() / (values[1] + values[2]);
            // What the sensor's place gives up: the plate is colder than the mat.
            let truth = if in_mat { values[4] * values[3] / (values[3] + values[4]) } else { values[4] };
            let loss = WattsPerKelvin::from_bits(found.loss).to_num::<f64>() / truth;
            println!(
                "{values:?} {lag} s, in the mat {in_mat}: {time:.0} s, capacity {:+.0} %, loss {:+.0} %",
                100.0 * (capacity - 1.0),
                100.0 * (loss - 1.0)
            );
            assert!(time <= 1200.0, "{values:?}: {time} s");
            assert!((0.75..=1.1).contains(&capacity), "{values:?}, {lag} s, {in_mat}: capacity {capacity}");
            assert!((0.9..=1.1).contains(&loss), "{values:?}, {lag} s, {in_mat}: loss {loss}");
            heat_with(&constants, known, found);
        }
    }
}
