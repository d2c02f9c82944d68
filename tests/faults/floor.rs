//! The floor finds a heater without power and a sensor that has slipped, independent of the model, the settings and the
//! commands. It never reports a heater that can reach its target, however slow it is.

use super::{break_it, constants, until_off};
use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output};
use corehbot::fault::Cause;
use corehbot::settings::{Control, HeaterSettings, ThermalSettings};
use corehbot::units::{JoulesPerKelvin, Ratio, Seconds, Watts, WattsPerKelvin};
use corehbot_rig::plant::{Drive, HeaterFault, Plant, PlantConstants, SensorFault};
use std::cell::Cell;

/// Models of no real heater: power in W, J/K, W/K, s.
const NONSENSE: [(f64, f64, f64, f64); 6] = [
    (40.0, 200.0, 0.075, 1.2),
    (1.0, 10.8, 0.075, 1.2),
    (2000.0, 0.5, 0.001, 0.1),
    (40.0, 50_000.0, 0.001, 120.0),
    (40.0, 0.5, 100.0, 0.1),
    (2000.0, 50_000.0, 100.0, 120.0),
];

fn with(heater: Heater, model: (f64, f64, f64, f64), control: Control) -> ThermalSettings {
    let mut settings = settings();
    let HeaterSettings { power, model: m, control: c, .. } = settings.heater_mut(heater);
    let (watts, capacity, loss, lag) = model;
    (*c, *power, m.capacity) = (control, Watts::from_num(watts), JoulesPerKelvin::from_num(capacity));
    (m.loss, m.heater_lag, m.sensor_lag) =
        (WattsPerKelvin::from_num(loss), Seconds::from_num(lag), Seconds::from_num(lag));
    settings
}

/// Reproducer: a heater that was almost open (1 W), and M306 E0 P40 C200, M109 S200: no fault was found in 900 s.
#[test]
fn a_heater_that_gives_nothing_is_found_whatever_its_model() {
    for model in NONSENSE {
        let mut constants = constants();
        constants.hotend.heater.nominal_watt = 1.0;
        let mut printer = Printer::new(&constants, with(Heater::Hotend, model, Control::Model));
        printer.run(1.0);
        printer.set(Heater::Hotend, 200.0);
        let found = printer.run_until(900.0, |printer| printer.fault().is_some());
        // Without any duty there is no fault to find, and no danger.
        let duty = printer.duty(Output::He0);
        println!("1 W as {model:?}: {:?} after {found:?} s, duty {duty:.3}", printer.fault().map(|fault| fault.cause));
        assert!(found.is_some_and(|time| time < 25.0) || duty < 0.1, "{model:?}");
    }
}

/// A sensor that has slipped: from cold, while heating, at its target, and switched off and on.
#[test]
fn a_sensor_that_has_slipped_is_found_whatever_the_model() {
    let mut slowest = [0.0_f64; 2];
    let mut hottest = [0.0_f64; 2];
    for (heater, watts, target) in [
        (Heater::Hotend, 25.0, 200.0),
        (Heater::Hotend, 60.0, 240.0),
        (Heater::Hotend, 100.0, 280.0),
        (Heater::Bed, 220.0, 60.0),
        (Heater::Bed, 1000.0, 110.0),
    ] {
        for model in NONSENSE {
            for control in [Control::Model, Control::Pid] {
                for before in [0.0, 20.0] {
                    let mut constants = constants();
                    let is_bed = heater == Heater::Bed;
                    let of = if is_bed { &mut constants.bed.heater } else { &mut constants.hotend.heater };
                    of.nominal_watt = watts;
                    let mut printer = Printer::new(&constants, with(heater, model, control));
                    printer.run(1.0);
                    printer.set(heater, target);
                    printer.run(before);
                    let slipped = SensorFault::Slipped { lag_seconds: 10.0 };
                    break_it(&printer, |faults| {
                        *(if is_bed { &mut faults.bed_sensor } else { &mut faults.hotend_sensor }) = slipped;
                    });
                    let is_over = |printer: &Printer| printer.fault().is_some();
                    let found = printer.run_until(900.0, is_over);
                    let is = if is_bed { printer.bed() } else { printer.hotend() };
                    let place = usize::from(is_bed);
                    hottest[place] = hottest[place].max(is);
                    if let Some(time) = found {
                        slowest[place] = slowest[place].max(time);
                    }
                    let what = format!("{heater:?} of {watts} W as {model:?}, {control:?}, slipped after {before} s");
                    assert!(found.is_some() || is < 60.0, "{what}: {is:.0} C");
                    assert!(is < if is_bed { 200.0 } else { 320.0 }, "{what}: {is:.0} C");
                }
            }
        }
    }
    println!(
        "slipped, any model: hotend {:.0} s, {:.0} C; bed {:.0} s, {:.0} C",
        slowest[0], hottest[0], slowest[1], hottest[1]
    );
}

/// Off and on again, and another target all the time, do not delay the fault.
#[test]
fn a_heater_that_is_switched_off_and_on_is_found_too() {
    for (on, off) in [(3.0, 3.0), (10.0, 10.0), (15.0, 5.0), (15.0, 30.0)] {
        let mut printer = Printer::new(&constants(), with(Heater::Hotend, NONSENSE[0], Control::Model));
        printer.run(1.0);
        break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Slipped { lag_seconds: 10.0 });
        let mut hottest = 0.0_f64;
        for n in 0..100 {
            printer.set(Heater::Hotend, 200.0 + f64::from(n % 7));
            printer.run(on);
            hottest = hottest.max(printer.hotend());
            printer.set(Heater::Hotend, 0.0);
            printer.run(off);
            hottest = hottest.max(printer.hotend());
        }
        println!("slipped, {on} s on, {off} s off: {:?} at {hottest:.0} C", printer.fault().map(|fault| fault.cause));
        assert!(printer.fault().is_some() && hottest < 250.0, "{on} {off} {hottest}");
    }
}

/// A slow plant: with the given J/K and W/K, and a supply of the given V.
fn slow(heater: Heater, [watts, capacity, loss, volts]: [f64; 4]) -> PlantConstants {
    let mut constants = constants();
    constants.supply_volts = volts;
    if heater == Heater::Bed {
        constants.bed.heater.nominal_watt = watts;
        constants.bed.plate_joule_per_kelvin = capacity - constants.bed.mat_joule_per_kelvin;
        constants.bed.plate_to_air_watt_per_kelvin = loss;
    } else {
        constants.hotend.heater.nominal_watt = watts;
        constants.hotend.block_joule_per_kelvin = capacity - constants.hotend.cartridge_joule_per_kelvin;
        constants.hotend.block_to_air_watt_per_kelvin = loss;
    }
    constants
}

/// The floor alone, with a model that finds no fault: heaters that get to 3 C above their target at full power.
#[test]
fn a_heater_that_can_reach_its_target_never_trips() {
    let mut slowest = 0.0_f64;
    for (heater, plant) in [
        (Heater::Bed, [220.0, 5500.0, 2.0, 24.0]),
        (Heater::Bed, [220.0, 5500.0, 2.0, 21.0]),
        (Heater::Bed, [220.0, 5500.0, 4.0, 24.0]),
        (Heater::Bed, [500.0, 1700.0, 7.0, 24.0]),
        (Heater::Bed, [1000.0, 600.0, 10.0, 24.0]),
        (Heater::Hotend, [25.0, 34.0, 0.07, 24.0]),
        (Heater::Hotend, [25.0, 34.0, 0.07, 19.0]),
        (Heater::Hotend, [25.0, 10.8, 0.12, 24.0]),
        (Heater::Hotend, [40.0, 16.0, 0.2, 18.0]),
        (Heater::Hotend, [100.0, 6.0, 0.3, 24.0]),
    ] {
        let constants = slow(heater, plant);
        // At full power, without a model or a guard of it: where does it end? Half a day.
        let mut end = Ceiling::of(&constants);
        let highest = end.highest(heater);
        let most = if heater == Heater::Bed { 120.0 } else { 285.0 };
        for part in [0.4, 0.7, 1.0] {
            let target = (25.0 + part * (highest - 3.0 - 25.0)).min(most);
            let mut settings = with(heater, (plant[0], 50_000.0, 100.0, 10.0), Control::Pid);
            // With P of 22 a hotend near its ceiling stays 10 C below its target: there Marlin's PID begins, with 22 *
            // 10 of 255.
            settings.heater_mut(heater).pid.p = settings.heater(heater).pid.p.max(Ratio::const_from_int(30));
            let mut printer = Printer::new(&constants, settings);
            printer.run(1.0);
            printer.set(heater, target);
            let is_slow = Cell::new(false);
            let reached = printer.run_until(40_000.0, |printer| {
                is_slow.set(is_slow.get() || printer.status.heat().is_slow(heater));
                printer.fault().is_some() || (printer.measured(heater) - target).abs() < 0.5
            });
            let what = format!("{heater:?} {plant:?}, up to {highest:.0} C, target {target:.0} C");
            println!("{what}: reached after {reached:.0?} s");
            assert_eq!((printer.fault(), is_slow.get()), (None, false), "{what}");
            assert!(reached.is_some(), "{what}");
            printer.run(300.0);
            assert_eq!(printer.fault(), None, "{what}");
            slowest = slowest.max(reached.unwrap_or_default());
        }
    }
    println!("the slowest took {slowest:.0} s");
}

/// The highest temperature that a plant's power allows.
struct Ceiling(Plant);

impl Ceiling {
    fn of(constants: &PlantConstants) -> Self {
        Self(Plant::new(constants))
    }

    fn highest(&mut self, heater: Heater) -> f64 {
        let is_bed = heater == Heater::Bed;
        let [hotend, bed] = if is_bed { [0.0, 1.0] } else { [1.0, 0.0] };
        let mut last = 0.0;
        loop {
            for _ in 0..600 {
                self.0.step(&Drive { hotend, bed, ..Drive::IDLE }, 0.5);
            }
            let now = if is_bed { self.0.bed_celsius() } else { self.0.hotend_celsius() };
            if now - last < 0.02 {
                return now;
            }
            last = now;
        }
    }
}

/// The floor alone finds a temperature that was reached and lost: F08 with a model of nonsense.
#[test]
fn an_open_heater_at_its_target_is_lost_whatever_the_model() {
    let mut printer = Printer::new(&constants(), with(Heater::Hotend, (40.0, 200.0, 0.075, 1.2), Control::Pid));
    printer.set(Heater::Hotend, 200.0);
    assert!(printer.run_until(300.0, |printer| printer.measured(Heater::Hotend) > 199.5).is_some());
    break_it(&printer, |faults| faults.hotend_heater = HeaterFault::OPEN);
    let (cause, time) = until_off(&mut printer, 60.0);
    assert_eq!((cause, time < 20.0), (Cause::LostAtFull, true), "{time}");
}
