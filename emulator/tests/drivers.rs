//! Motors have power only while their drivers prove that they are as they should be.

use crate::common::{Bench, MS, drivers, firmware, print};
use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot_emulator::compare::{difference, scheduled, timing};
use corehbot_emulator::driver_line::DriverLines;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::{End, Injection};
use corehbot_sim::tmc2209::chopconf;

const GCODE: &str = "G28\nG1 X200 Y100 F6000\nG1 X20 Y150\nM400\n";

/// The same moves from where the tool is, without the eight seconds of homing.
const MOVES: &str = "G92 X0 Y0 Z0\nG1 X200 Y100 F6000\nG1 X20 Y150\nM400\n";

fn print_on(drivers: &DriverLines) -> Seen {
    crate::common::print_on(&firmware(), GCODE, &Bench { drivers: drivers.clone(), ..Bench::default() })
}

/// Whether the board said so in an error of its own.
fn is_reported(seen: &Seen, what: &str) -> bool {
    seen.line.said.iter().any(|line| line.starts_with("Error:") && line.contains(what))
}

/// No motor has ever had power or made a step, and the host knows why.
fn assert_refused(seen: &Seen, what: &str) {
    println!("{:?}", seen.line.said);
    assert!(seen.recorder.events.is_empty(), "{} steps", seen.recorder.events.len());
    assert!(seen.safety.switched.is_empty() && seen.safety.dangers.is_empty(), "{:?}", seen.safety.switched);
    assert!(is_reported(seen, what), "{:?}", seen.line.said);
    assert!(seen.resets.is_empty());
}

/// The file was printed with the host's steps.
fn assert_printed(seen: &Seen, gcode: &str) {
    assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{:?}", seen.line.said);
    let host = scheduled(gcode, &Settings::prototype()).unwrap();
    let events = &seen.recorder.events;
    assert!(difference(events, &host).is_none(), "{:?}", difference(events, &host));
    let timing = timing(events, &host);
    println!("late {} to {} ns", timing.late.quantile(0.0), timing.late.max());
    assert!(timing.late.quantile(0.0) >= 0 && timing.late.max() <= 5000);
    assert_eq!((seen.recorder.split_pairs, seen.recorder.unpowered), (0, 0));
}

#[test]
fn a_driver_that_is_silent_from_the_start_keeps_all_motors_without_power() {
    for motor in [prototype::M8, prototype::E0] {
        let mut drivers = drivers();
        drivers.of(motor).chip.is_silent = true;
        assert_refused(&print_on(&drivers), &format!("motor {} does not answer", prototype::NAMES[motor.index()]));
    }
}

/// Every exchange ends, whatever the pin reads.
#[test]
fn a_wire_that_is_shorted_keeps_all_motors_without_power() {
    for level in [false, true] {
        let mut drivers = drivers();
        drivers.of(prototype::M1).short = Some(level);
        assert_refused(&print_on(&drivers), "motor m1 ");
    }
}

#[test]
fn drivers_without_motor_supply_keep_all_motors_without_power() {
    let mut drivers = drivers();
    Motor::ALL.into_iter().for_each(|motor| drivers.of(motor).chip.power_off());
    assert_refused(&print_on(&drivers), "does not answer");
}

#[test]
fn replies_that_are_damaged_now_and_then_are_asked_for_again() {
    let mut drivers = drivers();
    for (noise, motor) in (3..).zip(Motor::ALL) {
        drivers.of(motor).noise = noise;
    }
    let seen = crate::common::print_on(&firmware(), MOVES, &Bench { drivers, ..Bench::default() });
    assert_printed(&seen, MOVES);
    assert!(seen.drivers.others_than(16).is_empty());
}

#[test]
fn replies_that_are_always_damaged_keep_all_motors_without_power() {
    let mut drivers = drivers();
    drivers.of(prototype::M4).noise = 1;
    assert_refused(&print_on(&drivers), "motor m4");
}

#[test]
fn a_driver_that_says_other_microsteps_keeps_all_motors_without_power() {
    let mut drivers = drivers();
    let other = 0x1000_0053 | 5 << chopconf::MRES;
    drivers.of(prototype::M11).chip.answer_wrongly(chopconf::ADDRESS, other);
    assert_refused(&print_on(&drivers), "motor m11");
}

#[test]
fn a_driver_that_does_not_take_writes_keeps_all_motors_without_power() {
    let mut drivers = drivers();
    drivers.of(prototype::Z1).chip.is_deaf = true;
    assert_refused(&print_on(&drivers), "motor");
}

/// Time from a driver fault in mid-motion until the motors of `failed` lose power, and until the last step, in ns; the
/// host gets one of `causes`.
fn off_after(injection: Injection, failed: MotorSet, causes: &[&str]) -> (u64, u64, Seen) {
    let seen = print(&firmware(), GCODE, Some(injection));
    let at = seen.injected.expect("a fault");
    let last = seen.recorder.events.last().map_or(0, |event| event.at);
    let without = |motors: MotorSet| {
        let mut later = seen.safety.switched.iter().filter(|(when, _)| *when >= at);
        later.find(|(_, on)| on.without(motors) == *on).expect("motors without power").0
    };
    let (off, all_off) = (without(failed), without(prototype::ALL));
    println!(
        "{injection:?}: off {:.1} ms, last step {:.1} ms and no power {:.1} ms after it, {:?}",
        (off - at) as f64 / 1e6,
        (last as f64 - at as f64) / 1e6,
        (all_off - at) as f64 / 1e6,
        seen.line.said.iter().find(|line| line.starts_with("Error"))
    );
    assert!(last <= all_off, "steps after the power was cut");
    // The failed motor has no power: its step pulses move nothing while the others bring the tool to its place.
    assert!(seen.recorder.without_power.without(failed).is_empty(), "{:?}", seen.recorder.without_power);
    let is_reported = causes.iter().any(|cause| is_reported(&seen, cause));
    assert!(seen.safety.powered.is_empty() && is_reported, "{:?}", seen.line.said);
    assert!(seen.resets.is_empty() && seen.line.failure.is_some(), "the host knows");
    (off - at, last.saturating_sub(at), seen)
}

/// Steps by which the Z screws rise after an instant.
fn raised(seen: &Seen, at: u64) -> i64 {
    let later = seen.recorder.events.iter().filter(|event| event.at >= at && event.steps.has(prototype::Z1));
    later.map(|event| if event.forward.has(prototype::Z1) { 1 } else { -1 }).sum()
}

/// A driver that was reset makes the microsteps of its pins, eight instead of sixteen. If it turns the belt it is off
/// within 100 ms, and the other three raise z by 10 mm and park the tool.
#[test]
fn a_driver_that_loses_its_configuration_while_it_steps_is_off_and_the_others_of_its_belt_park_the_tool() {
    for motor in [prototype::M1, prototype::M11] {
        let fault = Injection::DriverReset { after: 45_000, motor };
        let reset = format!("motor {} was reset", prototype::NAMES[motor.index()]);
        let (off, _, seen) = off_after(fault, MotorSet::of(motor), &[&reset]);
        assert!(off < 100 * MS, "{off} ns");
        assert!(
            seen.line.said.iter().any(|line| line == "echo:tool parked, z raised by 10 mm"),
            "{:?}",
            seen.line.said
        );
        assert_eq!(raised(&seen, seen.injected.unwrap()), 8000);
    }
}

#[test]
fn a_z_driver_that_loses_its_configuration_while_it_steps_stops_all_motors() {
    let fault = Injection::DriverReset { after: 46_000, motor: prototype::Z2 };
    assert!(off_after(fault, prototype::ALL, &["motor z2 was reset"]).0 < 200 * MS);
}

#[test]
fn a_motor_supply_that_goes_away_stops_all_motors() {
    let (_, last, seen) = off_after(Injection::SupplyLost { after: 45_000 }, prototype::ALL, &["does not answer"]);
    assert!(last < 100 * MS, "{last} ns");
    assert!(!seen.line.said.iter().any(|line| line.contains("parked, ")), "{:?}", seen.line.said);
}
