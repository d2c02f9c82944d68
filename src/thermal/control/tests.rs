//! Tests of control.

extern crate std;
use super::super::order::OrderQueue;
use super::*;
use crate::port::NoHeaters;
use std::boxed::Box;

#[derive(Clone, Copy)]
struct NoWake;

impl Wake for NoWake {
    fn wake_generator(&self) {}
    fn wake_stepper(&self) {}
}

#[test]
fn f40_settings_that_change_by_themselves_are_found_within_a_second() {
    let (queue, status) = (Box::leak(Box::new(OrderQueue::new())), Box::leak(Box::new(Status::new())));
    let (mut orders, orders_in) = queue.split();
    let status: &Status = status;
    let mut control = ThermalControl::new(&ThermalSettings::prototype(), orders_in, status, NoHeaters, NoWake);
    let run = |control: &mut ThermalControl<'_, _, _>, periods: u32| {
        for _ in 0..periods {
            status.heat().beat_of_console();
            status.heat().beat_of_generator();
            status.count_look();
            control.period();
        }
        status.fault().fault().map(|fault| fault.cause)
    };
    assert_eq!(run(&mut control, 3 * SCRUB), None);
    let common = Common { fan_run_on_s: 30, ..control.common };
    orders.enqueue(Order::Common(common)).unwrap();
    assert_eq!(run(&mut control, 3 * SCRUB), None, "settings that were ordered are right");
    control.common.filament = crate::units::WattsPerKelvin::from_bits(common.filament.to_bits() ^ 1 << 20);
    assert_eq!(run(&mut control, SCRUB), Some(Cause::SettingsDamaged));
}

/// The check includes numbers that guards derive from the settings; guards keep no copy of a threshold.
#[test]
fn f40_what_was_made_of_the_settings_is_found_within_a_second_too() {
    for place in 0..4 {
        let (queue, status) = (Box::leak(Box::new(OrderQueue::new())), Box::leak(Box::new(Status::new())));
        let status: &Status = status;
        let settings = ThermalSettings::prototype();
        let mut control = ThermalControl::new(&settings, queue.split().1, status, NoHeaters, NoWake);
        control.heaters[0].damage(place);
        for _ in 0..=SCRUB {
            status.heat().beat_of_console();
            status.heat().beat_of_generator();
            status.count_look();
            control.period();
        }
        assert_eq!(status.fault().fault().map(|fault| fault.cause), Some(Cause::SettingsDamaged), "{place}");
    }
}
