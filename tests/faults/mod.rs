//! Faults of heat, crash and configuration: each is a test that looks at pins and duties in virtual time.
//! docs/explanation/safety.md has the same numbers.

mod beds;
mod configuration;
mod floor;
mod fuzz;
mod heartbeats;
mod heaters;
mod latch;
mod lives;
mod loose;
mod quiet;
mod refusals;
mod rest;
mod second;
mod self_test;
mod sensors;
mod supply;

use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output};
use corehbot::fault::Cause;
use corehbot_rig::plant::{Plant, PlantConstants, PlantFaults};

/// Hours of a soak, if this is one (`cargo xtask soak`).
fn soak_hours() -> Option<u32> {
    std::env::var("COREHBOT_SOAK_HOURS").ok().map(|hours| hours.parse().unwrap())
}

/// The prototype's plant.
fn constants() -> PlantConstants {
    PlantConstants::prototype()
}

/// A printer that has been switched on cold.
fn cold() -> Printer {
    let mut printer = Printer::new(&constants(), settings());
    printer.run(1.0);
    printer
}

/// A printer at 215 and 60 C that has been so for a while.
fn printing() -> Printer {
    let mut printer = Printer::with(Plant::hot(&constants(), 215.0, 60.0), settings());
    printer.set(Heater::Hotend, 215.0);
    printer.set(Heater::Bed, 60.0);
    printer.run(60.0);
    assert_eq!(printer.fault(), None);
    printer
}

/// Breaks something.
fn break_it(printer: &Printer, what: impl FnOnce(&mut PlantFaults)) {
    what(printer.bench.borrow_mut().plant.faults());
}

/// Whether no heater gets power.
fn is_off(printer: &Printer) -> bool {
    [Output::He0, Output::Bed].into_iter().all(|output| printer.duty(output) == 0.0)
}

/// The time until a heater that is off refuses to heat because its sensor is broken. Then a target is set, and it does
/// not heat until the sensor works again.
fn until_refused(printer: &mut Printer, heater: Heater, mend: impl FnOnce(&mut PlantFaults)) -> (Cause, f64) {
    let time = printer.run_until(5.0, |printer| printer.status.heat().ailment(heater).is_some()).unwrap();
    let cause = printer.status.heat().ailment(heater).unwrap();
    printer.set(heater, 60.0);
    printer.run(2.0);
    assert_eq!(
        (printer.fault(), is_off(printer), printer.status.heat().target(heater).to_num::<i32>()),
        (None, true, 0)
    );
    break_it(printer, mend);
    // A jump back is a jump too.
    printer.run(5.0);
    assert_eq!(printer.status.heat().ailment(heater), None);
    printer.set(heater, 60.0);
    printer.run(2.0);
    assert!(!is_off(printer), "it heats again");
    (cause, time)
}

/// The time until the fault is latched and all heaters are off, and they stay off.
fn until_off(printer: &mut Printer, most: f64) -> (Cause, f64) {
    let time = printer.run_until(most, |printer| printer.fault().is_some() && is_off(printer));
    let time = time.unwrap_or_else(|| {
        panic!("no fault within {most} s: hotend at {}, bed at {}", printer.hotend(), printer.bed())
    });
    let cause = printer.fault().unwrap().cause;
    // After that no target heats.
    printer.set(Heater::Hotend, 200.0);
    printer.set(Heater::Bed, 60.0);
    for _ in 0..500 {
        printer.period();
        assert!(is_off(printer), "a heater has power after {cause:?}");
    }
    (cause, time)
}
