//! The power supply's switch: it goes off when a heater may be on and nothing would show it.

use super::{break_it, cold, is_off, printing, until_off};
use crate::printer::Printer;
use corehbot::connectors::Heater;
use corehbot::fault::Cause;
use corehbot_rig::plant::{HeaterFault, SensorFault};

fn is_supplied(printer: &Printer) -> bool {
    printer.bench.borrow().supply
}

const SLIPPED: SensorFault = SensorFault::Slipped { lag_seconds: 10.0 };

#[test]
fn a_switch_that_sticks_behind_a_lost_sensor_costs_the_supply() {
    for (fault, most_s) in [(SensorFault::Open, 0.5), (SensorFault::ShortToGround, 0.5), (SLIPPED, 8.0)] {
        let mut printer = printing();
        break_it(&printer, |faults| {
            faults.hotend_sensor = fault;
            faults.hotend_heater = HeaterFault::STUCK_ON;
        });
        let found = printer.run_until(60.0, |printer| !is_supplied(printer)).unwrap_or(f64::INFINITY);
        println!("{fault:?}: supply off after {found:.1} s, {:.0} C", printer.hotend());
        assert!(found <= most_s, "{fault:?}: {found} s");
        let hottest = printer.hotend();
        printer.run(60.0);
        assert!(printer.hotend() < hottest, "{fault:?}: it cools, although its switch still sticks");
        assert_eq!(printer.bench.borrow().fans, [1.0; 6], "all fans cool");
    }
}

#[test]
fn a_sensor_that_is_lost_while_it_heats_costs_the_supply_too() {
    for heater in [Heater::Hotend, Heater::Bed] {
        let mut printer = printing();
        break_it(&printer, |faults| match heater {
            Heater::Hotend => faults.hotend_sensor = SensorFault::Open,
            _ => faults.bed_sensor = SensorFault::Open,
        });
        assert_eq!(until_off(&mut printer, 5.0).0, Cause::SensorOpen);
        assert!(!is_supplied(&printer), "{heater:?}: nothing shows whether its switch works");
        let printer = printer.restarted();
        assert!(!is_supplied(&printer), "a reset does not switch it on again");
    }
}

/// A broken sensor of a heater that never had power hides no heat.
#[test]
fn a_sensor_that_is_broken_while_off_costs_no_supply() {
    let mut printer = cold();
    printer.set(Heater::Bed, 60.0);
    printer.run(20.0);
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Open);
    printer.run(60.0);
    assert_eq!((printer.fault(), is_supplied(&printer)), (None, true));
    assert!(!is_off(&printer), "the bed heats on");
    // And neither does one that breaks after its heater was switched off.
    let mut printer = printing();
    printer.order(corehbot::thermal::Order::Off);
    printer.run(120.0);
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Open);
    printer.run(60.0);
    assert_eq!((printer.fault(), is_supplied(&printer)), (None, true));
}
