//! False alarms are faults too: hours of printing, with every guard on, trip none. `cargo xtask soak` makes 100 hours
//! of them.

use super::{break_it, constants, soak_hours};
use crate::printer::{Printer, settings};
use corehbot::connectors::Heater;
use corehbot::thermal::Order;

/// An hour: heat up, print with flow that changes, fans that change, targets that change, a pause, cool down.
fn hour(printer: &mut Printer, seed: u32) {
    let mut state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let mut random = |most: u32| {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 16) % most
    };
    let hotend = 190.0 + f64::from(random(70));
    let bed = 50.0 + f64::from(random(50));
    printer.set(Heater::Bed, bed);
    printer.set(Heater::Hotend, hotend);
    printer.run(300.0);
    let mut flows = [0.0; 64];
    flows.iter_mut().for_each(|flow| *flow = if random(4) == 0 { 0.0 } else { f64::from(random(150)) / 10.0 });
    let begun = printer.seconds;
    for minute in 0..40 {
        printer.order(Order::Fan(0, if random(3) == 0 { 0 } else { random(65_536) as u16 }));
        if random(10) == 0 {
            printer.set(Heater::Hotend, hotend - 15.0 + f64::from(random(30)));
        }
        break_it(printer, |faults| {
            faults.supply_volts = 23.0 + f64::from(random(20)) / 10.0;
            faults.ambient_celsius = 18.0 + f64::from(random(10));
        });
        let end = f64::from(minute + 1) * 60.0;
        while printer.seconds - begun < end {
            let now = printer.seconds - begun;
            printer.period_with(|ahead| flows[((now + ahead) / 7.0) as usize % 64]);
        }
    }
    printer.order(Order::Off);
    printer.run(900.0);
}

/// Hours of printing, except in a soak.
const HOURS: u32 = 6;

/// Hours of printing, each on its own machine: noise up to three times, lags up to 1.4 times the nominal ones.
#[test]
fn hours_of_printing_trip_nothing() {
    let hours = soak_hours().unwrap_or(HOURS);
    for seed in 0..hours {
        let mut constants = constants();
        constants.converter.seed = u64::from(seed);
        constants.converter.noise_lsb *= f64::from(1 + seed % 3);
        constants.hotend.sensor.lag_seconds *= 0.7 + 0.1 * f64::from(seed % 8);
        constants.bed.sensor.lag_seconds *= 0.7 + 0.1 * f64::from(seed % 7);
        let mut printer = Printer::new(&constants, settings());
        hour(&mut printer, seed);
        assert_eq!(printer.fault(), None, "seed {seed}");
    }
    println!("{hours} hours without an alarm");
}

/// Reproducer: a hotend in a cold room that comes down to a low target. It needs 2.5 times the power that a room of 25
/// C would take, and its reading hardly rises.
#[test]
fn a_low_target_in_a_cold_room_is_held() {
    for (room, target) in (0..=6).flat_map(|room| (0..=10).map(move |target| (5 + 5 * room, 30 + 5 * target))) {
        let mut constants = constants();
        constants.ambient_celsius = f64::from(room);
        let mut printer = Printer::new(&constants, settings());
        printer.run(1.0);
        printer.set(Heater::Hotend, 144.0);
        printer.run(90.0);
        for pause in [60.0, 130.0, 200.0] {
            printer.set(Heater::Hotend, 0.0);
            printer.run(pause);
            printer.set(Heater::Hotend, f64::from(target));
            printer.run(60.0);
        }
        assert_eq!(printer.fault(), None, "{target} C in a room of {room} C");
    }
}
