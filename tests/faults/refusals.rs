//! Readings that cannot be right and cost nothing but the heat: a winter night, another kind of sensor than set.
//! Nothing of that halts the machine, and no heater gets power by such a reading.

use super::{break_it, constants, is_off, until_off};
use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output};
use corehbot::fault::Cause;
use corehbot::settings::Thermistor;
use corehbot::status::SelfTest;
use corehbot::thermal::Order;
use corehbot::units::Celsius;
use corehbot_rig::plant::{HeaterFault, Plant, PlantConstants, SensorFault, Thermistor as Real};

/// The printer in a room of -16 C.
fn arctic() -> PlantConstants {
    PlantConstants { ambient_celsius: -16.0, ..constants() }
}

/// A bed with a PT1000, in place of the NTC that the settings name.
fn platinum() -> PlantConstants {
    let mut constants = constants();
    constants.bed.sensor.thermistor = Real::Platinum;
    constants
}

fn ailment(printer: &Printer, heater: Heater) -> Option<Cause> {
    printer.status.heat().ailment(heater)
}

/// Runs, and no output ever has power.
fn run_off(printer: &mut Printer, seconds: f64) {
    for _ in 0..(seconds * 50.0) as u32 {
        printer.period();
        assert!(is_off(printer), "a heater has power at {} s", printer.seconds);
    }
    assert_eq!(printer.fault(), None);
}

#[test]
fn a_room_that_is_too_cold_refuses_heat_until_it_is_warmer() {
    // Twice on one printer, by a reset between; the target comes before the first reading, and later.
    let mut printer = Printer::new(&arctic(), settings());
    for _ in 0..2 {
        printer.set(Heater::Hotend, 200.0);
        printer.set(Heater::Bed, 60.0);
        run_off(&mut printer, 1.0);
        for heater in [Heater::Hotend, Heater::Bed] {
            assert_eq!(ailment(&printer, heater), Some(Cause::TooCold));
            assert!((printer.measured(heater) + 16.0).abs() < 1.0, "hosts see the reading");
            printer.set(heater, 60.0);
            run_off(&mut printer, 2.0);
            assert_eq!(printer.status.heat().target(heater), Celsius::ZERO);
        }
        printer = printer.restarted();
    }
    break_it(&printer, |faults| faults.ambient_celsius = 18.0);
    let warm = printer.run_until(20_000.0, |printer| {
        Heater::ALL.into_iter().all(|heater| printer.status.heat().ailment(heater).is_none())
    });
    assert!(warm.is_some() && printer.fault().is_none());
    printer.set(Heater::Bed, 40.0);
    printer.run(1200.0);
    assert_eq!(printer.fault(), None);
    assert!((printer.bed() - 40.0).abs() < 1.0, "{}", printer.bed());
}

#[test]
fn a_night_that_gets_too_cold_refuses_heat_and_a_heater_that_is_on_faults() {
    // After an earlier heating, with the heaters off.
    let mut printer = Printer::new(&PlantConstants { ambient_celsius: -12.0, ..constants() }, settings());
    printer.set(Heater::Bed, 20.0);
    printer.run(300.0);
    printer.order(Order::Off);
    break_it(&printer, |faults| faults.ambient_celsius = -20.0);
    let cold = printer.run_until(40_000.0, |printer| ailment(printer, Heater::Bed).is_some());
    assert!(cold.is_some() && printer.fault().is_none());
    assert_eq!(ailment(&printer, Heater::Bed), Some(Cause::TooCold));
    // Its sensor slips out into the cold while the bed heats.
    let mut printer = Printer::new(&PlantConstants { ambient_celsius: -12.0, ..constants() }, settings());
    printer.set(Heater::Bed, 20.0);
    printer.run(5.0);
    break_it(&printer, |faults| {
        faults.ambient_celsius = -25.0;
        faults.bed_sensor = SensorFault::Slipped { lag_seconds: 2.0 };
    });
    assert_eq!(until_off(&mut printer, 10.0).0, Cause::TooCold);
}

#[test]
fn a_bed_with_another_sensor_than_set_is_refused_and_the_hotend_heats() {
    let mut printer = Printer::new(&platinum(), settings());
    for _ in 0..2 {
        printer.set(Heater::Bed, 60.0);
        run_off(&mut printer, 2.0);
        assert_eq!((ailment(&printer, Heater::Bed), ailment(&printer, Heater::Hotend)), (Some(Cause::TooHot), None));
        printer.set(Heater::Hotend, 200.0);
        for _ in 0..5000 {
            printer.period();
            assert_eq!(printer.duty(Output::Bed), 0.0);
        }
        assert_eq!(printer.fault(), None);
        assert!((printer.hotend() - 200.0).abs() < 2.0, "{}", printer.hotend());
        // A reset, with the hotend still hot.
        printer = printer.restarted();
        printer.run(0.1);
    }
    // The cure is a setting; then it heats, by its true temperature.
    let mut bed = *settings().heater(Heater::Bed);
    bed.thermistor = Thermistor::PT1000;
    printer.order(Order::Heater(Heater::Bed, bed));
    printer.run(1.0);
    assert_eq!((ailment(&printer, Heater::Bed), printer.fault()), (None, None));
    printer.set(Heater::Bed, 60.0);
    printer.run(900.0);
    assert_eq!(printer.fault(), None);
    assert!((printer.bed() - 60.0).abs() < 1.0, "{}", printer.bed());
}

/// A start while a heater is hotter than it may get: it cools and heats again, and a switch that sticks is found.
#[test]
fn a_switch_that_sticks_behind_a_refusal_cuts_the_supply() {
    for (hot, heater) in [([312.0, 25.0], Heater::Hotend), ([25.0, 140.0], Heater::Bed)] {
        let [hotend, bed] = hot;
        let start = || Printer::with(Plant::hot(&constants(), hotend, bed), settings());
        let mut printer = start();
        run_off(&mut printer, 0.5);
        assert_eq!(ailment(&printer, heater), Some(Cause::TooHot));
        let cooled = printer.run_until(3000.0, |printer| ailment(printer, heater).is_none());
        assert!(cooled.is_some() && printer.fault().is_none(), "{heater:?}");
        printer.set(heater, 60.0);
        printer.run_until(3000.0, |printer| !is_off(printer)).unwrap();
        assert_eq!(printer.fault(), None);
        for seconds in [0.0, 5.0] {
            let mut printer = start();
            run_off(&mut printer, seconds);
            break_it(&printer, |faults| {
                *(if heater == Heater::Bed { &mut faults.bed_heater } else { &mut faults.hotend_heater }) =
                    HeaterFault::STUCK_ON;
            });
            let time = printer.run_until(120.0, |printer| !printer.bench.borrow().supply).unwrap();
            println!("{heater:?} stuck on {seconds} s after the start: {time:.1} s");
            assert!(printer.fault().unwrap().cause.is_stuck_on());
            let [more, least] = [printer.hotend() - hotend, printer.bed() - bed];
            assert!(more < 20.0 && least < 12.0, "{more} C, {least} C more");
        }
    }
}

#[test]
fn no_self_test_pulses_a_heater_whose_reading_cannot_be_right() {
    for plant in [arctic(), platinum()] {
        let mut printer = Printer::new(&plant, settings());
        run_off(&mut printer, 1.0);
        printer.order(Order::SelfTest);
        run_off(&mut printer, 60.0);
        assert_eq!(printer.status.heat().self_test(), SelfTest::PutOff);
    }
}

#[test]
fn the_fan_of_a_hotend_runs_whose_reading_cannot_be_right() {
    let mut printer = Printer::new(&arctic(), settings());
    printer.run(1.0);
    assert_eq!(printer.bench.borrow().fans[1], 1.0);
}

/// The printer in a room, with other thermistors than the settings name.
fn with(hotend: Real, bed: Real, celsius: f64) -> Printer {
    let mut constants = PlantConstants { ambient_celsius: celsius, ..constants() };
    (constants.hotend.sensor.thermistor, constants.bed.sensor.thermistor) = (hotend, bed);
    Printer::new(&constants, settings())
}

/// G8 of the guards' list: a file for an NTC of 100 kOhm, and another sensor.
#[test]
fn sensors_of_another_kind_are_found_by_a_comparison_while_all_is_cold() {
    let (right, bed) = (constants().hotend.sensor.thermistor, constants().bed.sensor.thermistor);
    let of = |ohm_at_25: f64| Real::Beta { ohm_at_25, beta: 4500.0 };
    for celsius in [12.0, 22.0, 32.0] {
        for (what, hotend, bed) in [
            ("500 kOhm", of(500_000.0), bed),
            ("10 kOhm", of(10_000.0), bed),
            ("PT1000", Real::Platinum, bed),
            ("bed of 10 kOhm", right, of(10_000.0)),
        ] {
            let mut printer = with(hotend, bed, celsius);
            run_off(&mut printer, 90.0);
            for heater in [Heater::Hotend, Heater::Bed] {
                let told = ailment(&printer, heater);
                let readings = [Heater::Hotend, Heater::Bed].map(|heater| printer.measured(heater));
                assert!(told.is_some(), "{what} at {celsius} C: {heater:?}, {readings:.1?}");
                printer.set(heater, 60.0);
            }
            run_off(&mut printer, 60.0);
        }
        let mut healthy = with(right, bed, celsius);
        run_off(&mut healthy, 600.0);
        assert_eq!([Heater::Hotend, Heater::Bed].map(|heater| ailment(&healthy, heater)), [None; 2]);
    }
}

#[test]
fn after_a_print_the_comparison_waits_an_hour_and_finds_nothing_on_a_healthy_printer() {
    let mut printer = Printer::new(&constants(), settings());
    printer.set(Heater::Hotend, 215.0);
    printer.set(Heater::Bed, 60.0);
    printer.run(600.0);
    printer.order(Order::Off);
    for _ in 0..80 {
        printer.run(60.0);
        assert_eq!(
            (printer.fault(), ailment(&printer, Heater::Hotend), ailment(&printer, Heater::Bed)),
            (None, None, None)
        );
    }
    printer.set(Heater::Hotend, 215.0);
    printer.run(60.0);
    assert!(printer.hotend() > 100.0);
}
