//! Sensors that are open, short, loose, frozen, slipped, slow or wrong (F01 to F07, F14 to F17, F19).

use super::{break_it, cold, constants, is_off, printing, until_off, until_refused};
use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output};
use corehbot::fault::Cause;
use corehbot::settings::Thermistor;
use corehbot::thermal::Order;
use corehbot::units::Celsius;
use corehbot_rig::plant::{Plant, SensorFault};

/// A printer in each of the states in which a sensor may fail while it heats: on the ramp, at its target.
fn states() -> [(&'static str, Printer); 2] {
    let mut heating = cold();
    heating.set(Heater::Hotend, 215.0);
    heating.set(Heater::Bed, 60.0);
    heating.run(20.0);
    [("heating", heating), ("at its target", printing())]
}

#[test]
fn f01_f02_f03_an_open_or_shorted_sensor_is_off_within_half_a_second() {
    let broken = [
        (SensorFault::Open, Cause::SensorOpen),
        (SensorFault::ShortToSupply, Cause::SensorOpen),
        (SensorFault::ShortToGround, Cause::SensorShort),
    ];
    for (fault, expected) in broken {
        for is_bed in [false, true] {
            for (state, mut printer) in states() {
                break_it(&printer, |faults| {
                    *(if is_bed { &mut faults.bed_sensor } else { &mut faults.hotend_sensor }) = fault;
                });
                let (cause, time) = until_off(&mut printer, 5.0);
                println!("{fault:?} {state}: {time:.2} s");
                assert_eq!((cause, time <= 0.5), (expected, true), "{fault:?} {state}: {time} s");
                assert_eq!(printer.fault().unwrap().subject, if is_bed { 1 } else { 0 });
            }
        }
    }
}

#[test]
fn a_broken_sensor_of_a_heater_that_is_off_only_refuses_to_heat() {
    let broken = [
        (SensorFault::Open, Cause::SensorOpen),
        (SensorFault::ShortToSupply, Cause::SensorOpen),
        (SensorFault::ShortToGround, Cause::SensorShort),
    ];
    for (fault, expected) in broken {
        let mut printer = cold();
        break_it(&printer, |faults| faults.hotend_sensor = fault);
        let (cause, time) =
            until_refused(&mut printer, Heater::Hotend, |faults| faults.hotend_sensor = SensorFault::None);
        assert_eq!((cause, time <= 0.5), (expected, true), "{fault:?}: {time} s");
        let mut printer = cold();
        break_it(&printer, |faults| faults.bed_sensor = fault);
        let (cause, _) = until_refused(&mut printer, Heater::Bed, |faults| faults.bed_sensor = SensorFault::None);
        assert_eq!(cause, expected);
    }
    let mut printer = cold();
    break_it(&printer, |faults| faults.converter_stopped = true);
    let (cause, _) = until_refused(&mut printer, Heater::Hotend, |faults| faults.converter_stopped = false);
    assert_eq!(cause, Cause::ConverterStopped);
}

#[test]
fn f04_a_reading_that_stands_still_is_found_when_the_power_changes() {
    // At its target, the flow of a print changes the power.
    let mut printer = printing();
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Frozen);
    let mut time = 0.0;
    while printer.fault().is_none() && time < 60.0 {
        let at = time;
        printer.period_with(|ahead| if at + ahead > 3.0 { 15.0 } else { 0.0 });
        time += 0.02;
    }
    println!("frozen: {time:.2} s");
    assert_eq!(printer.fault().unwrap().cause, Cause::SensorFrozen);
    assert!(time <= 36.0 && printer.hotend() < 320.0, "{time} s, {} C", printer.hotend());
    // On the ramp it is at full power.
    let mut printer = cold();
    printer.set(Heater::Hotend, 215.0);
    printer.run(5.0);
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Frozen);
    let (_, time) = until_off(&mut printer, 60.0);
    println!("frozen on the way up: {time:.2} s");
    assert!(time <= 32.0 && printer.hotend() < 320.0);
}

#[test]
fn f05_a_loose_contact_never_heats_more() {
    for (period, open, is_fault) in [(10.0, 0.3, false), (1.0, 0.001, false), (1.0, 0.3, true), (0.1, 0.06, true)] {
        let mut printer = printing();
        break_it(&printer, |faults| {
            faults.hotend_sensor = SensorFault::Intermittent { period_seconds: period, open_seconds: open };
        });
        let mut hottest = 0.0_f64;
        for _ in 0..3000 {
            printer.period();
            hottest = hottest.max(printer.hotend());
        }
        println!(
            "open for {open} of {period} s: {:?}, {hottest:.1} C at most",
            printer.fault().map(|fault| fault.cause)
        );
        assert_eq!(printer.fault().is_some(), is_fault, "{open} of {period} s");
        assert!(hottest < 217.0, "{hottest}");
    }
}

#[test]
fn f06_a_sensor_that_slips_out_is_found_before_anything_burns() {
    for lag_seconds in [3.0, 10.0, 40.0] {
        let mut printer = printing();
        break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Slipped { lag_seconds });
        let (cause, time) = until_off(&mut printer, 120.0);
        println!("slipped with {lag_seconds} s: {cause:?} after {time:.1} s at {:.0} C", printer.hotend());
        assert!(printer.hotend() < 320.0);
    }
}

#[test]
fn f07_a_slow_sensor_trips_nothing_and_overshoots_little() {
    let mut printer = cold();
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::ExtraLag { lag_seconds: 20.0 });
    printer.set(Heater::Hotend, 215.0);
    let mut hottest = 0.0_f64;
    for _ in 0..15_000 {
        printer.period();
        hottest = hottest.max(printer.hotend());
    }
    println!("20 s of lag: {hottest:.1} C at most");
    assert_eq!(printer.fault(), None);
    assert!(hottest < 230.0, "{hottest}");
}

#[test]
fn f14_a_thermistor_of_ten_kiloohm_does_not_heat() {
    // It reads 95 C in a room of 25 C: far too hot for a bed of 60 C, so nothing heats; a hotend stays far below its
    // reading.
    let mut printer = cold();
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::TenKiloOhm);
    let mut fresh = Printer::new(&constants(), settings());
    break_it(&fresh, |faults| faults.hotend_sensor = SensorFault::TenKiloOhm);
    fresh.set(Heater::Hotend, 215.0);
    fresh.run(300.0);
    assert!(fresh.hotend() < 150.0, "{}", fresh.hotend());
    // Plugged in while it runs, it is a jump.
    let (cause, _) = until_refused(&mut printer, Heater::Hotend, |faults| faults.hotend_sensor = SensorFault::None);
    assert_eq!(cause, Cause::SensorFlickers);
}

#[test]
fn f15_a_supply_that_sags_changes_no_temperature_and_a_bad_one_is_told() {
    let mut printer = printing();
    let before = printer.measured(Heater::Hotend);
    break_it(&printer, |faults| faults.vdda_volts = 3.1);
    printer.run(5.0);
    assert_eq!(printer.fault(), None);
    assert!((printer.measured(Heater::Hotend) - before).abs() < 0.5);
    break_it(&printer, |faults| faults.vdda_volts = 2.8);
    let (cause, time) = until_off(&mut printer, 5.0);
    assert_eq!((cause, time < 0.5), (Cause::Reference, true));
}

#[test]
fn f16_a_converter_that_stops_is_off_within_half_a_second() {
    for (state, mut printer) in states() {
        break_it(&printer, |faults| faults.converter_stopped = true);
        let (cause, time) = until_off(&mut printer, 5.0);
        println!("converter stops {state}: {time:.2} s");
        assert_eq!((cause, time <= 0.5), (Cause::ConverterStopped, true), "{state}");
    }
}

#[test]
fn f17_channels_that_slip_by_one_are_found() {
    for (state, mut printer) in states() {
        break_it(&printer, |faults| faults.channels_slipped = true);
        let (cause, time) = until_off(&mut printer, 5.0);
        println!("channels slip {state}: {cause:?} after {time:.2} s");
        assert!(time <= 0.5, "{state}: {time}");
    }
}

#[test]
fn f19_a_cold_room_heats_and_colder_than_any_room_is_refused() {
    let mut winter = constants();
    winter.ambient_celsius = -5.0;
    let mut printer = Printer::new(&winter, settings());
    printer.set(Heater::Bed, 60.0);
    printer.run(600.0);
    assert_eq!(printer.fault(), None);
    assert!((printer.bed() - 60.0).abs() < 1.0, "{}", printer.bed());
    let mut arctic = constants();
    arctic.ambient_celsius = -25.0;
    let mut printer = Printer::new(&arctic, settings());
    printer.set(Heater::Hotend, 200.0);
    for _ in 0..250 {
        printer.period();
        assert!(is_off(&printer));
    }
    assert_eq!((printer.fault(), printer.status.heat().ailment(Heater::Hotend)), (None, Some(Cause::TooCold)));
}

#[test]
fn too_hot_is_off_whatever_the_target() {
    // It was within its range, and is beyond it now.
    let mut printer = Printer::with(Plant::hot(&constants(), 230.0, 25.0), settings());
    printer.run(1.0);
    let mut hotend = *settings().heater(Heater::Hotend);
    hotend.most = Celsius::const_from_int(200);
    printer.order(Order::Heater(Heater::Hotend, hotend));
    let (cause, time) = until_off(&mut printer, 5.0);
    assert_eq!((cause, time <= 0.5, printer.bench.borrow().supply), (Cause::TooHot, true, false));
    assert_eq!(hotend.thermistor, Thermistor::SEMITEC_104GT2);
}

/// Reproducer: while readings were doubtful a heater kept its power, even when it was switched off.
#[test]
fn a_heater_that_is_switched_off_while_its_sensor_flickers_is_off_in_the_next_period() {
    let mut printer = printing();
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Open);
    printer.run(0.1);
    assert!(printer.duty(Output::He0) > 0.0 && printer.fault().is_none());
    printer.set(Heater::Hotend, 0.0);
    printer.period();
    assert_eq!(printer.duty(Output::He0), 0.0);
    printer.run(1.0);
    assert_eq!((printer.fault(), printer.duty(Output::He0)), (None, 0.0), "nothing is lost that was off");
}
