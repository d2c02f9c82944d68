//! M303: the tuning finds the plant's values, and control with them is as good as with the plant's own figures.

use super::predictive::heat_up;
use crate::printer::{Printer, settings};
use corehbot::connectors::Heater;
use corehbot::settings::{Control, Pid};
use corehbot::status::{SelfTest, Tuned, Tuning, TuningFailure};
use corehbot::thermal::Order;
use corehbot::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, Watts, WattsPerKelvin};
use corehbot_rig::plant::{HeaterFault, Plant, PlantConstants, SensorFault};

/// Tunes a heater of a cold printer.
pub fn tune(printer: &mut Printer, heater: Heater, target: i32) -> (Tuning, f64) {
    printer.order(Order::Tune(heater, Celsius::from_num(target), 5));
    let time = printer.run_until(7200.0, |printer| {
        printer.fault().is_some()
            || matches!(printer.status.heat().tuning(), Tuning::Done | Tuning::DoneWithoutFan | Tuning::Failed(_))
    });
    (printer.status.heat().tuning(), time.unwrap_or(7200.0))
}

#[test]
fn a_tuned_hotend_is_the_plant_and_heats_as_well() {
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    let (tuning, time) = tune(&mut printer, Heater::Hotend, 215);
    assert_eq!((printer.fault(), tuning), (None, Tuning::Done));
    let Tuned { capacity, loss, fan_loss, lag, p, i, d, ptc: _ } = printer.status.heat().tuned();
    let (capacity, loss) = (JoulesPerKelvin::from_bits(capacity), WattsPerKelvin::from_bits(loss));
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
    // With the tuned values.
    let mut tuned = settings();
    let hotend = tuned.heater_mut(Heater::Hotend);
    (hotend.model.capacity, hotend.model.loss) = (capacity, loss);
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

/// A strong fan on a weak heater: 24 minutes ended without any result.
#[test]
fn a_hotend_that_the_part_fan_keeps_below_its_target_is_tuned_without_the_fan() {
    let mut weak = PlantConstants::prototype();
    weak.hotend.heater.nominal_watt = 25.0;
    weak.hotend.part_fan_watt_per_kelvin = 0.12;
    let mut known = settings();
    known.heater_mut(Heater::Hotend).power = Watts::from_num(25);
    let mut printer = Printer::new(&weak, known);
    printer.run(1.0);
    let (tuning, time) = tune(&mut printer, Heater::Hotend, 215);
    assert_eq!((printer.fault(), tuning), (None, Tuning::DoneWithoutFan));
    assert!(time < 20.0 * 60.0, "{time} s");
    let tuned = printer.status.heat().tuned();
    let capacity = JoulesPerKelvin::from_bits(tuned.capacity).to_num::<f64>();
    println!("{time:.0} s: {capacity:.2} J/K");
    assert!((9.0..13.0).contains(&capacity) && tuned.fan_loss == 0, "{capacity} J/K");
    printer.run(1.0);
    assert_eq!(printer.bench.borrow().fans[0], 0.0, "the fan stands still again");
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

/// J/K and s that a tuning of a hotend gives, from this temperature.
fn figures_from(celsius: f64, constants: &PlantConstants) -> [f64; 2] {
    let mut printer = Printer::with(Plant::hot(constants, celsius, 25.0), settings());
    printer.run(1.0);
    let (tuning, time) = tune(&mut printer, Heater::Hotend, 215);
    assert_eq!((printer.fault(), tuning), (None, Tuning::Done), "from {celsius} C");
    let tuned = printer.status.heat().tuned();
    let figures = [JoulesPerKelvin::from_bits(tuned.capacity).to_num(), Seconds::from_bits(tuned.lag).to_num()];
    println!("from {celsius} C: {figures:.2?} after {time:.0} s");
    figures
}

/// On 6f0e814, 130 J/K came of it from 215 C.
#[test]
fn a_tuning_from_the_heat_cools_first_and_finds_what_one_from_the_cold_finds() {
    let constants = PlantConstants::prototype();
    let [cold, cold_lag] = figures_from(25.0, &constants);
    for celsius in [100.0, 119.0, 150.0, 214.0, 215.0, 240.0] {
        let [capacity, lag] = figures_from(celsius, &constants);
        assert!((capacity / cold - 1.0).abs() < 0.15, "{capacity} J/K, {cold} from the cold");
        assert!((lag - cold_lag).abs() < 0.5, "{lag} s, {cold_lag} from the cold");
    }
}

#[test]
fn what_is_not_as_it_should_be_ends_a_tuning_with_a_reason() {
    let failure = |plant: Plant, target: i32| {
        let mut printer = Printer::with(plant, settings());
        printer.run(1.0);
        let (tuning, _) = tune(&mut printer, Heater::Hotend, target);
        assert_eq!(printer.fault(), None);
        assert_eq!(printer.duty(corehbot::connectors::Output::He0), 0.0);
        tuning
    };
    // A room of 60 C never cools a hotend to half-way to 60.
    let warm = PlantConstants { ambient_celsius: 60.0, ..PlantConstants::prototype() };
    assert_eq!(failure(Plant::new(&warm), 60), Tuning::Failed(TuningFailure::StaysHot));
    // 20 W hold some 265 C.
    let mut weak = PlantConstants::prototype();
    weak.hotend.heater.nominal_watt = 20.0;
    assert_eq!(failure(Plant::new(&weak), 280), Tuning::Failed(TuningFailure::OutOfReach));
    // 40 W in a block of 2 J/K: no hotend is so light.
    let mut light = PlantConstants::prototype();
    (light.hotend.cartridge_joule_per_kelvin, light.hotend.block_joule_per_kelvin) = (0.07, 0.6);
    light.hotend.cartridge_to_block_watt_per_kelvin = 0.5;
    assert_eq!(failure(Plant::new(&light), 215), Tuning::Failed(TuningFailure::Impossible));
}

/// Heaters that are far from the default model: a bed of 5500 J/K with 220 W, blocks of 34 J/K, in noise too. Without
/// the model's guards, which stopped them with E08 on 6f0e814.
#[test]
fn heavy_beds_and_heavy_blocks_are_tested_and_tuned() {
    for (heater, watt, joule, noise) in [
        (Heater::Hotend, 25.0, 34.0, 0.8),
        (Heater::Hotend, 60.0, 34.0, 3.0),
        (Heater::Hotend, 100.0, 8.0, 3.0),
        (Heater::Bed, 220.0, 5500.0, 0.8),
        (Heater::Bed, 1500.0, 5500.0, 3.0),
        (Heater::Bed, 120.0, 400.0, 0.8),
    ] {
        let mut plant = PlantConstants::prototype();
        plant.converter.noise_lsb = noise;
        let mut known = settings();
        known.heater_mut(heater).power = Watts::from_num(watt);
        let target = if heater == Heater::Bed {
            let share = joule / (plant.bed.mat_joule_per_kelvin + plant.bed.plate_joule_per_kelvin);
            plant.bed.heater.nominal_watt = watt;
            plant.bed.mat_joule_per_kelvin *= share;
            plant.bed.plate_joule_per_kelvin *= share;
            plant.bed.mat_to_plate_watt_per_kelvin *= share;
            plant.bed.plate_to_air_watt_per_kelvin = watt / 100.0;
            60
        } else {
            let hotend = &mut plant.hotend;
            let share = joule / (hotend.cartridge_joule_per_kelvin + hotend.block_joule_per_kelvin);
            hotend.heater.nominal_watt = watt;
            hotend.cartridge_joule_per_kelvin *= share;
            hotend.block_joule_per_kelvin *= share;
            hotend.cartridge_to_block_watt_per_kelvin *= share;
            200
        };
        let mut printer = Printer::new(&plant, known);
        printer.run(1.0);
        printer.order(Order::SelfTest);
        printer.run_until(600.0, |printer| printer.status.heat().self_test() != SelfTest::Testing);
        assert_eq!(
            (printer.status.heat().self_test(), printer.fault()),
            (SelfTest::Passed, None),
            "{heater:?} {joule}"
        );
        let (tuning, time) = tune(&mut printer, heater, target);
        assert_eq!((printer.fault(), tuning), (None, Tuning::Done), "{heater:?} {watt} W, {joule} J/K");
        let found = JoulesPerKelvin::from_bits(printer.status.heat().tuned().capacity).to_num::<f64>();
        println!("{heater:?} of {watt} W and {joule} J/K: {found:.1} J/K after {time:.0} s");
        assert!((found / joule - 1.0).abs() < 0.25, "{found} for {joule} J/K");
    }
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
    printer.order(Order::StopTrials);
    printer.run(0.04);
    assert_eq!((printer.status.heat().tuning(), printer.duty(corehbot::connectors::Output::He0)), (Tuning::None, 0.0));
}

#[test]
fn a_tuning_ends_the_one_of_another_heater() {
    let mut printer = Printer::new(&PlantConstants::prototype(), settings());
    printer.run(1.0);
    printer.order(Order::Tune(Heater::Hotend, Celsius::from_num(215), 5));
    printer.run(10.0);
    assert!(printer.duty(corehbot::connectors::Output::He0) > 0.0);
    let (tuning, _) = tune(&mut printer, Heater::Bed, 60);
    assert_eq!((printer.fault(), tuning), (None, Tuning::Done));
    assert_eq!(printer.status.heat().target(Heater::Hotend), Celsius::ZERO);
}
