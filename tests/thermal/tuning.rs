//! M303: what the tuning finds is what the plant is, and control with it is as good as with the plant's own figures.

use crate::predictive::heat_up;
use crate::printer::{Printer, settings};
use corehbot::connectors::Heater;
use corehbot::settings::{Control, Pid};
use corehbot::status::{Tuned, Tuning};
use corehbot::thermal::Order;
use corehbot::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, WattsPerKelvin};
use corehbot_rig::plant::{HeaterFault, PlantConstants, SensorFault};

/// Tunes a heater of a cold printer.
fn tune(printer: &mut Printer, heater: Heater, target: i32) -> (Tuning, f64) {
    printer.order(Order::Tune(heater, Celsius::from_num(target), 5));
    let time = printer.run_until(7200.0, |printer| {
        printer.fault().is_some() || matches!(printer.status.heat().tuning(), Tuning::Done | Tuning::Failed)
    });
    (printer.status.heat().tuning(), time.unwrap_or(7200.0))
}

#[test]
fn a_tuned_hotend_is_the_plant_and_heats_as_well() {
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    let (tuning, time) = tune(&mut printer, Heater::Hotend, 215);
    assert_eq!((printer.fault(), tuning), (None, Tuning::Done));
    let Tuned { capacity, loss, fan_loss, lag, p, i, d } = printer.status.heat().tuned();
    let [capacity, loss] = [JoulesPerKelvin::from_bits(capacity), JoulesPerKelvin::from_bits(loss >> 8)];
    let lag = Seconds::from_bits(lag);
    let pid = Pid { p: Ratio::from_bits(p), i: Ratio::from_bits(i), d: Ratio::from_bits(d) };
    println!("{time:.0} s: {capacity:.2} J/K, {loss:.4} W/K, {lag:.2} s, P {:.1} I {:.2} D {:.1}", pid.p, pid.i, pid.d);
    assert!((9.0..13.0).contains(&capacity.to_num::<f64>()));
    assert!((0.06..0.1).contains(&loss.to_num::<f64>()));
    let fan_loss = f64::from(fan_loss) / f64::from(1 << 24);
    let truth = PlantConstants::prototype().hotend.part_fan_watt_per_kelvin;
    println!("{fan_loss:.4} W/K with the part fan, of {truth}");
    assert!((fan_loss - truth).abs() < 0.1 * truth);
    assert_eq!(printer.bench.borrow().fans[0], 0.0, "the fan stands still again");
    assert!((1.5..3.5).contains(&lag.to_num::<f64>()));
    assert_eq!(printer.duty(corehbot::connectors::Output::He0), 0.0, "it is off afterwards");
    // With what was found.
    let mut tuned = settings();
    let hotend = tuned.heater_mut(Heater::Hotend);
    (hotend.model.capacity, hotend.model.loss) = (capacity, WattsPerKelvin::from_num(loss));
    (hotend.model.heater_lag, hotend.model.sensor_lag) = (lag / 2, lag / 2);
    let heated = heat_up(&mut Printer::new(&PlantConstants::prototype(), tuned), 215.0);
    println!("with the model found: {heated:.2?}");
    assert!(heated.overshoot <= 1.0 && heated.settled <= 1.05 * 65.1, "{heated:?}");
    let hotend = tuned.heater_mut(Heater::Hotend);
    (hotend.control, hotend.pid) = (Control::Pid, pid);
    let heated = heat_up(&mut Printer::new(&PlantConstants::prototype(), tuned), 215.0);
    println!("with the PID found: {heated:.2?}");
    assert!(heated.overshoot <= 3.0, "{heated:?}");
}

#[test]
fn a_bed_is_tuned_too() {
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    let (tuning, time) = tune(&mut printer, Heater::Bed, 60);
    assert_eq!((printer.fault(), tuning), (None, Tuning::Done));
    let tuned = printer.status.heat().tuned();
    let (capacity, lag) = (JoulesPerKelvin::from_bits(tuned.capacity), Seconds::from_bits(tuned.lag));
    println!("{time:.0} s: {capacity:.0} J/K, {:.2} W/K, {lag:.1} s", f64::from(tuned.loss) / f64::from(1 << 24));
    assert!((1500.0..2000.0).contains(&capacity.to_num::<f64>()));
}

#[test]
fn f21_protections_hold_while_it_tunes() {
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    printer.bench.borrow_mut().plant.faults().hotend_heater = HeaterFault::OPEN;
    let (_, time) = tune(&mut printer, Heater::Hotend, 215);
    assert!(printer.fault().is_some() && time < 30.0, "{time}");
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    printer.order(Order::Tune(Heater::Hotend, Celsius::from_num(215), 5));
    printer.run(100.0);
    printer.bench.borrow_mut().plant.faults().hotend_sensor = SensorFault::Open;
    printer.run(0.5);
    assert!(printer.fault().is_some() && printer.duty(corehbot::connectors::Output::He0) == 0.0);
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    printer.order(Order::Tune(Heater::Hotend, Celsius::from_num(215), 5));
    printer.run(100.0);
    printer.bench.borrow_mut().plant.faults().hotend_heater = HeaterFault::STUCK_ON;
    let mut hottest = 0.0_f64;
    for _ in 0..10_000 {
        printer.period();
        hottest = hottest.max(printer.hotend());
    }
    assert!(printer.fault().is_some() && hottest < 320.0, "{hottest}");
    // M108: it ends, and the heater with it.
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    printer.order(Order::Tune(Heater::Hotend, Celsius::from_num(215), 5));
    printer.run(10.0);
    printer.order(Order::StopTuning);
    printer.run(0.04);
    assert_eq!((printer.status.heat().tuning(), printer.duty(corehbot::connectors::Output::He0)), (Tuning::None, 0.0));
}
