//! Lives of machines that are used: heated, cancelled, heated again. Without a defect no fault may be found; with a
//! defect in such a life, it is found.

use super::constants;
use crate::printer::{Printer, settings};
use corehbot::connectors::Heater;
use corehbot::settings::{Control, ThermalSettings};
use corehbot::units::{JoulesPerKelvin, Watts, WattsPerKelvin};
use corehbot_rig::plant::PlantConstants;

/// PCG (M. O'Neill, 2014), 32 bits.
struct Random(u64);

impl Random {
    fn next(&mut self, below: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as u32) % below
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.next(all.len() as u32) as usize]
    }
}

/// A machine by its seed: a hotend of 25 to 100 W, a bed of 200 to 1000 W, noise of 0 to 3 steps of 12 bits, PID or
/// model.
fn machine(random: &mut Random) -> (PlantConstants, ThermalSettings) {
    let (mut constants, mut settings) = (constants(), settings());
    let watts = random.of(&[25, 40, 50, 60, 80, 100]);
    constants.hotend.heater.nominal_watt = watts.into();
    constants.hotend.sensor.lag_seconds *= random.of(&[0.6, 1.0, 1.8]);
    let bed_watts = random.of(&[220, 500, 1000]);
    constants.bed.heater.nominal_watt = bed_watts.into();
    constants.converter.noise_lsb = random.of(&[0.0, 0.8, 1.5, 3.0]);
    constants.converter.seed = random.next(u32::MAX).into();
    constants.ambient_celsius = random.of(&[12.0, 25.0, 32.0]);
    let control = random.of(&[Control::Pid, Control::Model]);
    for (heater, watts) in [(Heater::Hotend, watts), (Heater::Bed, bed_watts)] {
        let heater = settings.heater_mut(heater);
        (heater.power, heater.control) = (Watts::from_num(watts), control);
    }
    (constants, settings)
}

/// A target, including 0, and its duration: a moment, or minutes.
fn step(printer: &mut Printer, random: &mut Random, watts: f64) {
    let is_bed = random.next(3) == 0;
    let hotter = if watts < 30.0 { 190.0 } else { 260.0 };
    let target = if is_bed {
        random.of(&[0.0, 45.0, 60.0, 60.0, 75.0])
    } else {
        random.of(&[0.0, 0.0, 215.0_f64, 215.0, 150.0, 180.0, hotter])
    };
    printer.set(if is_bed { Heater::Bed } else { Heater::Hotend }, target.min(hotter));
    let seconds = random.of(&[0.5, 3.0, 8.0, 20.0, 20.0, 60.0, 150.0]);
    printer.run(seconds * (0.5 + f64::from(random.next(100)) / 100.0));
}

/// The number of lives; a soak has more of them. Of the first 120, 56 had a false alarm before guards were episodes.
const LIVES: u64 = 60;

/// The property: any sequence of targets, including 0, on a healthy plant causes no fault.
#[test]
fn any_sequence_of_targets_raises_nothing() {
    let lives = super::soak_hours().map_or(LIVES, |hours| u64::from(hours) * 20);
    let (mut hours, mut found) = (0.0, Vec::new());
    for seed in 0..lives {
        let mut random = Random(seed);
        let (constants, settings) = machine(&mut random);
        let watts = constants.hotend.heater.nominal_watt;
        let mut printer = Printer::new(&constants, settings);
        let mut did = String::new();
        for _ in 0..14 {
            step(&mut printer, &mut random, watts);
            let targets =
                [Heater::Hotend, Heater::Bed].map(|heater| printer.status.heat().target(heater).to_num::<i32>());
            did += &format!("{targets:?} {:.0} s {:.0}/{:.0} C; ", printer.seconds, printer.hotend(), printer.bed());
            if let Some(fault) = printer.fault() {
                let control = settings.heater(Heater::Hotend).control;
                found.push(format!(
                    "seed {seed}: {fault} with {watts} W, {control:?}, {:?}: {did}",
                    constants.converter
                ));
                break;
            }
        }
        hours += printer.seconds / 3600.0;
    }
    println!("{lives} lives, {hours:.1} hours");
    assert!(found.is_empty(), "{} false alarms:\n{}", found.len(), found.join("\n"));
}

/// Reproducer: M109 S210, M104 S0, G4 S20, M109 S210 was a thermal runaway.
#[test]
fn the_second_heating_to_the_same_target_is_no_runaway() {
    for control in [Control::Model, Control::Pid] {
        let mut settings = settings();
        settings.heater_mut(Heater::Hotend).control = control;
        let mut printer = Printer::new(&constants(), settings);
        for off in [20.0, 60.0, 120.0, 2.0] {
            printer.set(Heater::Hotend, 210.0);
            assert!(printer.run_until(200.0, |p| (p.measured(Heater::Hotend) - 210.0).abs() < 1.0).is_some());
            printer.run(5.0);
            printer.set(Heater::Hotend, 0.0);
            printer.run(off);
        }
        assert_eq!(printer.fault(), None, "{control:?}");
    }
}

/// The ceiling: a model that is nonsense (M306 A3.5) heated a hotend to 300.6 C for a target of 200.
#[test]
fn a_model_that_is_nonsense_gets_no_further_than_the_ceiling_and_the_heat_under_way() {
    for (loss, capacity) in [(3.5, 10.8), (0.075, 200.0), (100.0, 50_000.0)] {
        for watts in [40.0, 60.0, 100.0] {
            let (mut constants, mut settings) = (constants(), settings());
            constants.hotend.heater.nominal_watt = watts;
            let hotend = settings.heater_mut(Heater::Hotend);
            hotend.power = Watts::from_num(watts);
            (hotend.model.loss, hotend.model.capacity) =
                (WattsPerKelvin::from_num(loss), JoulesPerKelvin::from_num(capacity));
            let mut printer = Printer::new(&constants, settings);
            printer.set(Heater::Hotend, 200.0);
            let mut hottest = 0.0_f64;
            for _ in 0..30_000 {
                printer.period();
                hottest = hottest.max(printer.hotend());
            }
            println!("A{loss} C{capacity}, {watts} W: {hottest:.1} C at most, {:?}", printer.fault());
            // Heat still in the cartridge, and not yet seen by the sensor.
            let under_way = watts / 10.8 * 2.4;
            assert!(hottest < 210.5 + under_way, "{hottest}");
        }
    }
}
