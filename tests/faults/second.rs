//! A second sensor on a heater: its limit takes the power, and the heater does not work without it.

use super::{break_it, is_off, until_off};
use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output, Sensor};
use corehbot::fault::Cause;
use corehbot::settings::{SensorSource, ThermalSettings};
use corehbot::thermal::Order;
use corehbot::units::{Celsius, Watts};
use corehbot_rig::plant::{PlantConstants, SensorFault};

/// A bed of 1000 W with a sensor in its plate, and a second one in its mat.
fn with_second(most: i32) -> (PlantConstants, ThermalSettings) {
    let mut constants = PlantConstants::prototype();
    constants.bed.heater.nominal_watt = 1000.0;
    let mut known = settings();
    known.heater_mut(Heater::Bed).power = Watts::from_num(1000);
    let [.., second] = &mut known.sensors;
    (second.is_fitted, second.sensor) = (true, SensorSource::At(Sensor::Hotend2));
    (second.guards, second.most) = (Some(Heater::Bed), Celsius::from_num(most));
    (constants, known)
}

fn mat(printer: &Printer) -> f64 {
    printer.bench.borrow_mut().plant.hottest_celsius()
}

/// Without it the mat is 25 K hotter than the plate at full power.
#[test]
fn a_mat_at_its_limit_gets_no_power_and_the_bed_arrives_later() {
    let hottest = |most: i32| {
        let (constants, known) = with_second(most);
        let mut printer = Printer::new(&constants, known);
        printer.set(Heater::Bed, 80.0);
        let (mut hottest, mut arrived) = (0.0f64, None);
        for second in 0..1200 {
            printer.run(1.0);
            hottest = hottest.max(mat(&printer));
            arrived = arrived.or((printer.bed() > 79.0).then_some(second));
        }
        assert_eq!(printer.fault(), None, "{most}");
        (hottest, arrived.expect("it arrives"))
    };
    let ((free, early), (held, late)) = (hottest(150), hottest(90));
    println!("mat {free:.1} C after {early} s, with a limit of 90 C {held:.1} C after {late} s");
    assert!(free > 95.0 && held < 92.0 && late > early, "{free} C, {held} C, {early} s, {late} s");
}

/// The plate's sensor reads the room: nothing else would find that before its own guards do.
#[test]
fn a_mat_beyond_its_limit_costs_the_supply() {
    let (constants, known) = with_second(60);
    let mut printer = Printer::new(&constants, known);
    printer.set(Heater::Bed, 55.0);
    printer.run(600.0);
    assert_eq!(printer.fault(), None);
    break_it(&printer, |faults| faults.bed_heater = corehbot_rig::plant::HeaterFault::STUCK_ON);
    let (cause, _) = until_off(&mut printer, 120.0);
    println!("{cause:?} at {:.0} C in the mat, {:.0} C in the plate", mat(&printer), printer.bed());
    assert_eq!(cause, Cause::SecondHot);
    assert!(!printer.bench.borrow().supply && mat(&printer) < 80.0);
}

#[test]
fn a_broken_second_sensor_stops_its_heater_alone_and_refuses_it_when_it_is_off() {
    for fault in [SensorFault::Open, SensorFault::ShortToGround] {
        let (constants, known) = with_second(120);
        let mut printer = Printer::new(&constants, known);
        printer.set(Heater::Bed, 60.0);
        printer.run(60.0);
        break_it(&printer, |faults| faults.second_sensor = fault);
        let (cause, seconds) = until_off(&mut printer, 5.0);
        assert_eq!((cause, seconds < 0.6), (Cause::SecondBroken, true), "{fault:?}: {seconds} s");
        assert!(printer.bench.borrow().supply, "the first sensor still shows its heat");

        let mut printer = Printer::new(&constants, known);
        break_it(&printer, |faults| faults.second_sensor = fault);
        printer.run(1.0);
        printer.set(Heater::Bed, 60.0);
        printer.set(Heater::Hotend, 200.0);
        printer.run(30.0);
        assert_eq!((printer.fault(), printer.duty(Output::Bed)), (None, 0.0), "{fault:?}");
        assert!(!is_off(&printer), "the hotend heats");
        assert_eq!(printer.status.heat().ailment(Heater::Bed), Some(Cause::SecondBroken));
        // Mended, it heats again.
        break_it(&printer, |faults| faults.second_sensor = SensorFault::None);
        printer.run(2.0);
        printer.set(Heater::Bed, 60.0);
        printer.run(5.0);
        assert!(printer.duty(Output::Bed) > 0.5 && printer.fault().is_none());
        printer.order(Order::Off);
    }
}
