//! PTC hotends: M303 finds how their power falls, and no guard takes a hot one for a weak one.

use super::tuning::tune;
use crate::printer::{Printer, settings};
use corehbot::connectors::Heater;
use corehbot::settings::ThermalSettings;
use corehbot::status::Tuning;
use corehbot::thermal::Order;
use corehbot::units::{JoulesPerKelvin, Ratio, Seconds, Watts, WattsPerKelvin};
use corehbot_rig::plant::PlantConstants;

/// Hotends of 50 to 100 W, with blocks of 6 to 20 J/K.
const HOTENDS: u32 = 8;

/// A hotend with such a heater, and the settings of an owner who knows its power alone.
fn hotend(n: u32, ptc: f64, noise: f64) -> (PlantConstants, ThermalSettings) {
    let part = f64::from(n) / f64::from(HOTENDS - 1);
    let mut plant = PlantConstants { ambient_celsius: 18.0 + 2.0 * f64::from(n), ..PlantConstants::prototype() };
    let h = &mut plant.hotend;
    h.heater.nominal_watt = 50.0 + 50.0 * part;
    h.heater.ptc_per_kelvin = ptc;
    h.block_joule_per_kelvin = 6.0 + 14.0 * f64::from(n * 3 % HOTENDS) / f64::from(HOTENDS - 1);
    h.cartridge_joule_per_kelvin = 1.2 + f64::from(n * 5 % HOTENDS) / f64::from(HOTENDS - 1);
    plant.converter.noise_lsb = noise;
    plant.converter.seed = u64::from(n);
    let mut known = settings();
    known.heater_mut(Heater::Hotend).power = Watts::from_num(h.heater.nominal_watt);
    (plant, known)
}

/// What M303 finds of one: ptc, and capacity over the true one.
fn tuned(printer: &mut Printer, plant: &PlantConstants) -> (f64, f64) {
    printer.run(1.0);
    let (tuning, _) = tune(printer, Heater::Hotend, 215);
    assert_eq!((printer.fault(), tuning), (None, Tuning::Done));
    let tuned = printer.status.heat().tuned();
    let truth = plant.hotend.cartridge_joule_per_kelvin + plant.hotend.block_joule_per_kelvin;
    (Ratio::from_bits(tuned.ptc).to_num(), JoulesPerKelvin::from_bits(tuned.capacity).to_num::<f64>() / truth)
}

#[test]
fn m303_finds_how_the_power_of_a_hotend_falls() {
    for n in 0..HOTENDS {
        for (ptc, noise) in [(0.0, 0.3), (0.0, 3.0), (0.002 + 0.0025 * f64::from(n) / 7.0, 0.8), (0.003, 3.0)] {
            let (plant, known) = hotend(n, ptc, noise);
            let (found, capacity) = tuned(&mut Printer::new(&plant, known), &plant);
            println!("{n}: {ptc:.4} found {found:.4}, capacity {:+.0} %", 100.0 * (capacity - 1.0));
            if ptc == 0.0 {
                assert!(found < 0.0003, "{n}: {found}");
            } else {
                assert!((found / ptc - 1.0).abs() < 0.35, "{n}: {found} of {ptc}");
            }
            assert!((capacity - 1.0).abs() < 0.18, "{n}: capacity {capacity}");
        }
    }
}

/// Reproducer: the balance of heat stopped a PTC hotend that heated as it should (E08).
#[test]
fn a_tuned_ptc_hotend_prints_without_an_alarm() {
    for n in 0..HOTENDS {
        // At 240 C it has half of its power, so it has more of it to begin with.
        let (mut plant, mut known) = hotend(n, 0.0045, 0.8);
        plant.hotend.heater.nominal_watt *= 1.5;
        known.heater_mut(Heater::Hotend).power = Watts::from_num(plant.hotend.heater.nominal_watt);
        let mut printer = Printer::new(&plant, known);
        tuned(&mut printer, &plant);
        let found = printer.status.heat().tuned();
        let model = &mut known.heater_mut(Heater::Hotend).model;
        (model.capacity, model.loss) =
            (JoulesPerKelvin::from_bits(found.capacity), WattsPerKelvin::from_bits(found.loss));
        (model.fan_loss, model.ptc) = (WattsPerKelvin::from_bits(found.fan_loss), Ratio::from_bits(found.ptc));
        let lag = Seconds::from_bits(found.lag / 2);
        (model.heater_lag, model.sensor_lag) = (lag, lag);
        let mut printer = Printer::new(&plant, known);
        for round in 0..4u32 {
            let target = [200.0, 240.0, 215.0, 250.0][round as usize];
            printer.set(Heater::Hotend, target);
            printer.run(240.0);
            assert!((printer.hotend() - target).abs() < 3.0, "{n}: {} of {target}", printer.hotend());
            for second in 0..420u32 {
                printer.order(Order::Fan(0, if second / 60 % 2 == 1 { 32_768 } else { 0 }));
                let flow = if second % 40 < 30 { 5.0 } else { 0.0 };
                (0..50).for_each(|_| printer.period_with(|_| flow));
            }
            assert_eq!(printer.fault(), None, "{n}: {target}");
            printer.order(Order::Off);
            printer.run(if round == 1 { 600.0 } else { 20.0 });
        }
        assert_eq!(printer.fault(), None, "{n}");
    }
}
