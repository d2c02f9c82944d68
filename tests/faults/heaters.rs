//! Heaters that are open, weak, swapped or stuck on (F08 to F13), and fans.

use super::{break_it, cold, constants, printing, soak_hours, until_off};
use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output};
use corehbot::fault::Cause;
use corehbot::settings::{Control, FanRole};
use corehbot::thermal::Order;
use corehbot::units::{Celsius, Watts};
use corehbot_rig::plant::{HeaterFault, Plant, SensorFault};

#[test]
fn f08_an_open_heater_is_found() {
    for (heater, target, most) in [(Heater::Hotend, 215.0, 25.0), (Heater::Bed, 60.0, 100.0)] {
        let mut printer = cold();
        break_it(&printer, |faults| {
            faults.hotend_heater = HeaterFault::OPEN;
            faults.bed_heater = HeaterFault::OPEN;
        });
        printer.set(heater, target);
        let (cause, time) = until_off(&mut printer, 200.0);
        println!("{heater:?} open: {time:.1} s");
        assert!(matches!(cause, Cause::HeatsTooSlowly | Cause::SensorFrozen), "{cause:?}");
        assert!(time <= most, "{time}");
    }
    // One that fails during a print. Its heating has shown what its power does.
    let mut printer = cold();
    printer.set(Heater::Hotend, 215.0);
    printer.run(150.0);
    break_it(&printer, |faults| faults.hotend_heater = HeaterFault::OPEN);
    let (cause, time) = until_off(&mut printer, 60.0);
    println!("hotend opens at 215 C: {cause:?} after {time:.1} s");
    assert_eq!((cause, time <= 20.0), (Cause::HeatMissing, true), "{time}");
}

#[test]
fn f09_half_of_the_power_heats_and_a_quarter_is_a_fault() {
    let mut printer = cold();
    break_it(&printer, |faults| faults.hotend_heater.power = 0.5);
    printer.set(Heater::Hotend, 180.0);
    printer.run(400.0);
    assert_eq!(printer.fault(), None);
    assert!((printer.hotend() - 180.0).abs() < 1.0, "{}", printer.hotend());
    let mut printer = cold();
    break_it(&printer, |faults| faults.hotend_heater.power = 0.25);
    printer.set(Heater::Hotend, 215.0);
    let (cause, time) = until_off(&mut printer, 60.0);
    assert_eq!((cause, time < 25.0), (Cause::HeatsTooSlowly, true), "{time}");
}

#[test]
fn f10_a_switch_that_sticks_costs_the_power_supply() {
    for (is_bed, watts) in [(false, 40.0), (false, 60.0), (true, 500.0)] {
        let mut constants = constants();
        (if is_bed { &mut constants.bed.heater } else { &mut constants.hotend.heater }).nominal_watt = watts;
        let mut printer = Printer::new(&constants, settings());
        printer.run(30.0);
        break_it(&printer, |faults| {
            (if is_bed { &mut faults.bed_heater } else { &mut faults.hotend_heater }).stuck_on = true;
        });
        let (cause, time) = until_off(&mut printer, 120.0);
        assert_eq!((cause, printer.bench.borrow().supply), (Cause::HeatsWhileOff, false));
        let mut hottest = [0.0_f64; 2];
        for _ in 0..10_000 {
            printer.period();
            hottest = [hottest[0].max(printer.hotend()), hottest[1].max(printer.bed())];
        }
        println!("{watts} W stuck on: supply off after {time:.1} s, {hottest:.0?} C at most");
        assert!(hottest[0] < 320.0 && hottest[1] < 150.0);
        assert_eq!(printer.bench.borrow().fans, [1.0; 6], "all fans cool");
    }
}

/// Starts with a hotend of 60 W and a switch that sticks from a random moment on: the seed selects rooms, lags, masses
/// and noise. A soak has 1000.
#[test]
fn f10_stuck_switches_of_any_machine_burn_nothing() {
    let mut hottest = 0.0_f64;
    let seeds = if soak_hours().is_some() { 1000 } else { 100 };
    for seed in 0..seeds {
        let part = |shift: u32, least: f64, most: f64| {
            least
                + (most - least) * f64::from(u32::wrapping_mul(seed, 2_654_435_761).rotate_left(shift) >> 16) / 65_536.0
        };
        let mut constants = constants();
        constants.converter.seed = u64::from(seed);
        constants.hotend.heater.nominal_watt = 60.0;
        constants.ambient_celsius = part(3, 5.0, 40.0);
        constants.hotend.sensor.lag_seconds = part(7, 0.5, 5.0);
        constants.hotend.block_joule_per_kelvin = part(11, 6.0, 15.0);
        let mut printer = Printer::new(&constants, settings());
        let heats_before = seed % 3 == 0;
        if heats_before {
            printer.set(Heater::Hotend, part(17, 100.0, 215.0));
            printer.run(part(19, 1.0, 100.0));
            printer.order(Order::Off);
        }
        printer.run(part(13, 0.1, 20.0));
        break_it(&printer, |faults| faults.hotend_heater = HeaterFault::STUCK_ON);
        for _ in 0..3000 {
            printer.period();
            hottest = hottest.max(printer.hotend());
        }
        assert!(!printer.bench.borrow().supply, "seed {seed}: the supply is on, {:?}", printer.fault());
    }
    println!("{seeds} stuck switches: {hottest:.0} C at most");
    assert!(hottest < 320.0, "{hottest}");
}

#[test]
fn f11_a_switch_that_sticks_during_a_print_too() {
    let mut printer = printing();
    break_it(&printer, |faults| faults.hotend_heater.stuck_on = true);
    let (cause, time) = until_off(&mut printer, 60.0);
    println!("stuck at 215 C: {cause:?} after {time:.1} s at {:.0} C", printer.hotend());
    assert!(!printer.bench.borrow().supply);
    let mut hottest = 0.0_f64;
    for _ in 0..5000 {
        printer.period();
        hottest = hottest.max(printer.hotend());
    }
    assert!(hottest < 320.0, "{hottest}");
    assert!(matches!(cause, Cause::Overshoot | Cause::TooHot));
}

#[test]
fn f12_f13_swapped_plugs_are_found_before_anything_is_hot() {
    for swaps_sensors in [true, false] {
        for (heater, target) in [(Heater::Hotend, 215.0), (Heater::Bed, 60.0)] {
            let mut printer = cold();
            break_it(&printer, |faults| {
                (faults.swapped_sensors, faults.swapped_heaters) = (swaps_sensors, !swaps_sensors);
            });
            printer.set(heater, target);
            let (cause, time) = until_off(&mut printer, 100.0);
            let (hotend, bed) = (printer.hotend(), printer.bed());
            println!(
                "swapped {}, {heater:?}: {cause:?} after {time:.1} s at {hotend:.0} and {bed:.0} C",
                if swaps_sensors { "sensors" } else { "heaters" }
            );
            assert!(hotend < 100.0 && bed < 100.0, "{hotend} {bed}");
            assert_eq!(
                cause,
                if swaps_sensors || heater == Heater::Bed { Cause::SensorsSwapped } else { Cause::HeatsTooSlowly }
            );
        }
    }
}

/// Both heaters are ordered at once, as slicers do.
fn joint(watts: f64, control: Control) -> Printer {
    let (mut constants, mut settings) = (constants(), settings());
    constants.hotend.heater.nominal_watt = watts;
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.heater_mut(heater).control = control;
    }
    settings.heater_mut(Heater::Hotend).power = Watts::from_num(watts);
    let mut printer = Printer::new(&constants, settings);
    printer.run(1.0);
    printer
}

#[test]
fn f12_f13_swapped_plugs_are_found_in_a_joint_preheat_too() {
    for control in [Control::Pid, Control::Model] {
        for watts in [25.0, 40.0, 60.0, 100.0] {
            for swaps_sensors in [true, false] {
                let mut printer = joint(watts, control);
                break_it(&printer, |faults| {
                    (faults.swapped_sensors, faults.swapped_heaters) = (swaps_sensors, !swaps_sensors);
                });
                printer.set(Heater::Bed, 60.0);
                printer.set(Heater::Hotend, 215.0);
                let (cause, time) = until_off(&mut printer, 400.0);
                let (hotend, bed) = (printer.hotend(), printer.bed());
                let what = if swaps_sensors { "sensors" } else { "heaters" };
                println!(
                    "{watts} W, {control:?}, swapped {what}: {cause:?} after {time:.1} s at {hotend:.0}, {bed:.0} C"
                );
                if swaps_sensors {
                    assert_eq!((cause, time < 10.0, hotend < 60.0), (Cause::SensorsSwapped, true, true));
                }
                // At full power each gets the other's heat: it shows when the first of them is at its target.
                assert!(hotend < 320.0 && bed < 100.0);
            }
        }
    }
}

/// Reproducer: with PID, M140 S60, M104 S215, M109 S215 ended in "swapped" when the hotend's power was cut at its
/// target. With the model it did when the hotend was switched off soon after.
#[test]
fn a_hotend_that_goes_off_while_the_bed_heats_is_not_swapped() {
    for control in [Control::Pid, Control::Model] {
        for watts in [40.0, 60.0, 100.0] {
            for off_after in [2.0, 5.0, 10.0, 20.0, 400.0] {
                let mut printer = joint(watts, control);
                printer.set(Heater::Bed, 60.0);
                printer.set(Heater::Hotend, 215.0);
                printer.run(off_after);
                printer.set(Heater::Hotend, 0.0);
                printer.run(60.0);
                assert_eq!(printer.fault(), None, "{watts} W, {control:?}, off after {off_after} s");
            }
        }
    }
}

/// M303 cuts the power at full heat while the bed heats.
#[test]
fn a_tuning_while_the_bed_heats_is_not_swapped() {
    for watts in [60.0, 100.0] {
        for before in [1.0, 10.0, 60.0] {
            let mut printer = joint(watts, Control::Model);
            printer.set(Heater::Bed, 100.0);
            printer.run(before);
            printer.order(Order::Tune(Heater::Hotend, Celsius::from_num(215), 3));
            printer.run(400.0);
            assert_eq!(printer.fault(), None, "{watts} W, {before} s after the bed");
        }
    }
}

#[test]
fn f18_fans_that_cool_run_on_their_own() {
    let mut printer = cold();
    assert_eq!(printer.bench.borrow().fans, [0.0; 6]);
    printer.set(Heater::Hotend, 100.0);
    printer.run(0.1);
    assert_eq!(printer.bench.borrow().fans[1..3], [0.0, 1.0], "controller's with the heater, hotend's not yet");
    printer.run(60.0);
    assert!(printer.bench.borrow().fans[1] == 1.0 && printer.hotend() > 90.0);
    printer.order(Order::Off);
    printer.run(1.0);
    assert_eq!(printer.bench.borrow().fans[1..3], [1.0, 1.0], "it is warm, and the controller's runs on");
    let time = printer.run_until(900.0, |printer| printer.bench.borrow().fans == [0.0; 6]);
    assert!(time.is_some() && printer.hotend() < 52.0, "{time:?} {}", printer.hotend());
    printer.order(Order::Motors(true));
    printer.run(1.0);
    assert_eq!(printer.bench.borrow().fans[2], 1.0);
}

#[test]
fn a_target_beyond_the_limit_is_the_limit() {
    let mut printer = Printer::with(Plant::hot(&constants(), 215.0, 25.0), settings());
    printer.set(Heater::Hotend, 2000.0);
    printer.period();
    assert_eq!(printer.status.heat().target(Heater::Hotend).to_num::<f64>(), 285.0);
    printer.set(Heater::Hotend, -5.0);
    printer.period();
    assert_eq!((printer.status.heat().target(Heater::Hotend).to_num::<f64>(), printer.duty(Output::He0)), (0.0, 0.0));
    printer.set(Heater::Chamber, 60.0);
    printer.run(5.0);
    assert_eq!(printer.bench.borrow().duties.iter().filter(|duty| **duty > 0.0).count(), 0, "there is no chamber");
}

#[test]
fn f18_a_hotend_fan_with_a_tachometer_that_stands_still_switches_off() {
    let mut printer = cold();
    printer.bench.borrow_mut().tachometer = Some(u16::MAX - 50);
    printer.set(Heater::Hotend, 215.0);
    printer.run(120.0);
    assert_eq!(printer.fault(), None);
    printer.bench.borrow_mut().is_stuck = true;
    let (cause, time) = until_off(&mut printer, 10.0);
    println!("hotend fan stuck: off after {time:.1} s");
    assert_eq!((cause, time <= 6.1), (Cause::FanFailed, true), "{time}");
    assert_eq!(printer.fault().unwrap().to_string(), "FAN1: fan stands still [E12]: free the fan, or plug it in");
    // One that never turns.
    let mut printer = cold();
    printer.bench.borrow_mut().tachometer = Some(0);
    printer.bench.borrow_mut().is_stuck = true;
    printer.set(Heater::Hotend, 215.0);
    assert_eq!(until_off(&mut printer, 60.0).0, Cause::FanFailed);
    assert!(printer.hotend() < 150.0, "{}", printer.hotend());
}

/// A print without its part fan, or drivers without theirs, is no danger.
#[test]
fn f18_any_other_fan_that_stands_still_is_reported_and_stops_nothing() {
    for role in [FanRole::Part, FanRole::Commanded, FanRole::Controller] {
        let mut settings = settings();
        settings.fans[1].role = role;
        let mut printer = Printer::with(Plant::hot(&constants(), 215.0, 25.0), settings);
        printer.bench.borrow_mut().tachometer = Some(0);
        printer.set(Heater::Hotend, 215.0);
        printer.order(Order::Fan(1, u16::MAX));
        printer.run(10.0);
        let heat = printer.status.heat();
        assert_eq!((heat.tachometer(0), heat.tachometer(1), heat.still_fans()), (None, Some(200), 0));
        printer.bench.borrow_mut().is_stuck = true;
        printer.run(20.0);
        let heat = printer.status.heat();
        assert_eq!((printer.fault(), heat.tachometer(1), heat.still_fans()), (None, Some(0), 1 << 1), "{role:?}");
        printer.bench.borrow_mut().is_stuck = false;
        printer.run(5.0);
        assert_eq!(printer.status.heat().still_fans(), 0);
    }
}

/// Reproducer: the hotend's open sensor was reported first, in every period, so a bed that could not be switched off
/// kept its supply.
#[test]
fn an_open_hotend_sensor_masks_no_stuck_bed_switch() {
    for opens_after in [0.0, 70.0] {
        let mut printer = cold();
        printer.set(Heater::Hotend, 215.0);
        printer.run(15.0);
        break_it(&printer, |faults| faults.bed_heater.stuck_on = true);
        printer.run(opens_after);
        break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Open);
        let found = printer.run_until(200.0, |printer| !printer.bench.borrow().supply);
        println!("supply off {found:?} s after the sensor, at {:.0} C", printer.bed());
        assert!(found.is_some() && printer.bed() < 80.0);
        printer.run(1.0);
        assert_eq!(printer.bench.borrow().fans, [1.0; 6], "all fans cool");
    }
}

/// A start does not switch a supply on that the board keeps off.
#[test]
fn the_power_supply_stays_off_over_a_start_after_a_switch_that_stuck() {
    let mut printer = cold();
    break_it(&printer, |faults| faults.hotend_heater = HeaterFault::STUCK_ON);
    assert_eq!(until_off(&mut printer, 60.0).0, Cause::HeatsWhileOff);
    let mut printer = printer.restarted();
    printer.set(Heater::Bed, 60.0);
    printer.run(60.0);
    assert!(!printer.bench.borrow().supply, "and the heater that is stuck cools");
}

/// Reproducer: without a reading the hotend's fan stood still, and its cold end got hot.
#[test]
fn the_hotends_fan_runs_when_its_sensor_breaks_while_it_is_hot() {
    for is_heating in [true, false] {
        let mut printer = printing();
        if !is_heating {
            printer.order(Order::Off);
        }
        printer.run(1.0);
        break_it(&printer, |faults| faults.hotend_sensor = SensorFault::Open);
        printer.run(30.0);
        assert!(printer.hotend() > 100.0);
        assert_eq!(printer.bench.borrow().fans[1], 1.0, "heating: {is_heating}");
    }
}
