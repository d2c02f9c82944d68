//! The self-test: wiring that is wrong is found before the first heating, with everything still cold enough to touch.

use super::{break_it, cold, constants, until_off};
use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output};
use corehbot::fault::Cause;
use corehbot::status::SelfTest;
use corehbot::thermal::Order;
use corehbot::units::Celsius;
use corehbot_rig::plant::{HeaterFault, Plant, PlantConstants, SensorFault};

/// Orders a self-test and a target, and runs until the test has ended or a fault is latched. Returns the time, and the
/// highest temperatures of the hotend and the bed.
fn tested(printer: &mut Printer) -> (SelfTest, f64, [f64; 2]) {
    printer.order(Order::SelfTest);
    printer.set(Heater::Hotend, 200.0);
    printer.period();
    let mut hottest = [0.0_f64; 2];
    let begun = printer.seconds;
    while printer.status.heat().self_test() == SelfTest::Testing && printer.fault().is_none() {
        printer.period();
        hottest = [hottest[0].max(printer.hotend()), hottest[1].max(printer.bed())];
        assert!(printer.seconds - begun < 300.0, "a test without end");
    }
    (printer.status.heat().self_test(), printer.seconds - begun, hottest)
}

#[test]
fn heaters_that_warm_their_own_sensors_pass_and_the_target_waits_meanwhile() {
    for seed in 0..20 {
        let mut printer = Printer::new(&constants_of(seed), settings());
        printer.run(1.0);
        let (end, seconds, [hotend, bed]) = tested(&mut printer);
        assert_eq!((end, printer.fault()), (SelfTest::Passed, None), "{seed}");
        assert!(seconds < 60.0 && hotend < 35.0 && bed < 35.0, "{seconds} s, {hotend} C, {bed} C");
        if seed == 0 {
            println!("passed after {seconds:.0} s, hotend {hotend:.1} C, bed {bed:.1} C at most");
            let reached = printer.run_until(120.0, |printer| printer.measured(Heater::Hotend) > 199.0);
            assert!(reached.is_some(), "the target that waited counts now");
        }
    }
}

/// The prototype with other noise.
fn constants_of(seed: u64) -> PlantConstants {
    let mut constants = constants();
    constants.converter.seed = seed;
    constants
}

#[test]
fn heaters_with_half_or_twice_the_power_or_a_slow_sensor_pass() {
    for power in [0.5, 2.0] {
        let mut constants = constants();
        constants.hotend.heater.nominal_watt *= power;
        constants.bed.heater.nominal_watt *= power;
        let mut printer = Printer::new(&constants, settings());
        printer.run(1.0);
        assert_eq!(tested(&mut printer).0, SelfTest::Passed, "{power}");
    }
    let mut printer = cold();
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::ExtraLag { lag_seconds: 2.0 });
    assert_eq!(tested(&mut printer).0, SelfTest::Passed);
}

#[test]
fn f12_f13_swapped_sensors_and_heaters_are_found_while_cold() {
    let mut swapped_sensors = settings();
    let (hotend, bed) = (&mut swapped_sensors.heaters.hotend, &mut swapped_sensors.heaters.bed);
    core::mem::swap(&mut hotend.sensor, &mut bed.sensor);
    let mut swapped_outputs = settings();
    let (hotend, bed) = (&mut swapped_outputs.heaters.hotend, &mut swapped_outputs.heaters.bed);
    core::mem::swap(&mut hotend.output, &mut bed.output);
    for settings in [swapped_sensors, swapped_outputs] {
        let mut printer = Printer::new(&constants(), settings);
        printer.run(1.0);
        let (end, seconds, [hotend, bed]) = tested(&mut printer);
        println!("swapped: off after {seconds:.0} s, hotend {hotend:.1} C, bed {bed:.1} C at most");
        let fault = printer.fault().unwrap();
        assert!(matches!(fault.cause, Cause::SelfTest | Cause::SensorsSwapped), "{fault}");
        assert_ne!(end, SelfTest::Passed);
        assert!(hotend < 100.0 && bed < 50.0, "{hotend} C, {bed} C");
        printer.run(10.0);
        assert_eq!([Output::Bed, Output::He0].map(|output| printer.duty(output)), [0.0; 2]);
    }
}

#[test]
fn f08_an_open_heater_does_not_pass() {
    for is_bed in [false, true] {
        let mut printer = cold();
        break_it(&printer, |faults| {
            (if is_bed { &mut faults.bed_heater } else { &mut faults.hotend_heater }).power = HeaterFault::OPEN.power;
        });
        let (_, seconds, _) = tested(&mut printer);
        let fault = printer.fault().unwrap();
        println!("{fault}: after {seconds:.0} s");
        assert_eq!((fault.cause, fault.subject), (Cause::SelfTest, u8::from(is_bed)));
        assert_eq!(until_off(&mut printer, 1.0).0, Cause::SelfTest);
    }
}

#[test]
fn what_is_hot_or_has_no_reading_puts_the_test_off_and_heats_as_ordered() {
    let mut hot = Printer::with(Plant::hot(&constants(), 120.0, 25.0), settings());
    hot.run(1.0);
    assert_eq!(tested(&mut hot).0, SelfTest::PutOff);
    hot.run(1.0);
    assert!(hot.duty(Output::He0) > 0.5 && hot.fault().is_none());
    let mut blind = cold();
    break_it(&blind, |faults| faults.bed_sensor = SensorFault::Open);
    blind.run(2.0);
    assert_eq!(tested(&mut blind).0, SelfTest::PutOff);
    assert_eq!(blind.fault(), None);
}

#[test]
fn everything_off_ends_a_test_and_no_target_beyond_the_limit_waits() {
    let mut printer = cold();
    printer.order(Order::SelfTest);
    printer.set(Heater::Hotend, 900.0);
    printer.run(1.0);
    assert_eq!(printer.status.heat().self_test(), SelfTest::Testing);
    assert_eq!(printer.status.heat().target(Heater::Hotend), settings().heaters.hotend.most);
    assert!(printer.duty(Output::Bed) > 0.9, "the bed has its pulse");
    printer.order(Order::Off);
    printer.run(0.1);
    assert_eq!(printer.status.heat().self_test(), SelfTest::None);
    assert_eq!([Output::Bed, Output::He0].map(|output| printer.duty(output)), [0.0; 2]);
    printer.run(60.0);
    assert_eq!((printer.fault(), printer.status.heat().target(Heater::Hotend).to_bits()), (None, 0));
}

/// Reproducer: the target waited out the refusal, and the test gave it to the heater at its end.
#[test]
fn a_target_that_waits_is_gone_for_good_when_its_heater_is_refused() {
    let mut printer = cold();
    printer.order(Order::SelfTest);
    printer.set(Heater::Hotend, 200.0);
    printer.set(Heater::Bed, 60.0);
    printer.run(1.0);
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Open);
    let refused = printer.run_until(10.0, |printer| printer.status.heat().ailment(Heater::Hotend).is_some());
    assert!(refused.is_some());
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::None);
    let ended = printer.run_until(300.0, |printer| printer.status.heat().self_test() != SelfTest::Testing);
    assert!(ended.is_some_and(|seconds| seconds > 5.0), "it outlives the refusal");
    printer.run(5.0);
    let targets = [Heater::Hotend, Heater::Bed].map(|heater| printer.status.heat().target(heater));
    assert_eq!(targets, [Celsius::ZERO, Celsius::const_from_int(60)]);
    assert_eq!((printer.fault(), printer.duty(Output::He0)), (None, 0.0));
}
