//! The latch: the first cause wins over all later ones.

use super::{break_it, is_off, printing};
use corehbot::fault::{Cause, Fault, Record};
use corehbot_rig::plant::SensorFault;

#[test]
fn the_first_cause_is_the_one_that_is_told() {
    let mut printer = printing();
    break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Open);
    printer.run(1.0);
    break_it(&printer, |faults| (faults.bed_sensor, faults.vdda_volts) = (SensorFault::ShortToGround, 2.0));
    printer.run(1.0);
    let fault = printer.fault().unwrap();
    assert_eq!((fault.cause, fault.subject, is_off(&printer)), (Cause::SensorOpen, 0, true));
    assert!(printer.status.fault().more() > 0);
    assert_eq!(fault.to_string(), "hotend: sensor open or unplugged [E01]: plug its sensor in, or mend the wire");
}

#[test]
fn a_fault_that_somebody_else_sets_ends_the_heat_within_a_period() {
    let mut printer = printing();
    printer.status.fault().set(Fault { cause: Cause::Driver, subject: 2, value: 0, limit: 0 });
    printer.period();
    assert!(is_off(&printer));
}

#[test]
fn f39_faults_that_come_one_after_the_other_are_a_series() {
    let fault = Fault::plain(Cause::SensorOpen);
    let mut words = None;
    for (uptime, is_series) in [(2, false), (3, false), (2, true)] {
        let before = words.and_then(|words| Record::from_words(&words));
        let record = Record::next(before, fault, uptime);
        assert_eq!(record.is_series(), is_series);
        words = Some(record.to_words());
    }
}
