//! Whatever happens to the chip: motors off, heaters off, and the cause is told after the reset.

mod common;

use common::{MS, firmware, print};
use corehbot::motors::MotorSet;
use corehbot_emulator::firmware::branch;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::{End, Injection};

const GCODE: &str = "G28 X Y\nG1 X60 Y60 F6000\nM400\n";

/// Watchdog: 500 counts of 1 kHz, and LSI may run at 17 kHz instead of 32 kHz; the model runs at 32 kHz.
const WATCHDOG_NS: u64 = 520 * MS;

fn is_told(seen: &Seen) -> bool {
    seen.line.said.iter().any(|line| line.contains("the last reset came"))
}

#[test]
fn before_the_greeting_nothing_has_power_and_nothing_heats() {
    let seen = print(&firmware(), "M105\n", None);
    assert_eq!(seen.end, End::Done);
    let started = seen.started.expect("a greeting");
    println!("greeting {started} ns after reset");
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    assert!(seen.safety.switched.is_empty(), "{:?}", seen.safety.switched);
    assert!(seen.recorder.events.is_empty());
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
}

#[test]
fn a_bus_error_while_stepping_switches_the_motors_off_at_once() {
    let seen = print(&firmware(), GCODE, Some(Injection::BusError { after: 1000 }));
    assert_eq!(seen.end, End::Reset);
    let at = seen.injected.expect("a fault");
    let off = seen.safety.switched.iter().find(|(when, on)| *when >= at && on.is_empty());
    let (off, _) = off.expect("motors without power");
    println!("motors off {} ns after the fault", off - at);
    assert!(off - at < MS);
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    assert!(seen.safety.powered.is_empty() && !seen.safety.is_hot());
    assert!(is_told(&seen), "{:?}", seen.line.said);
}

#[test]
fn an_illegal_instruction_in_the_step_interrupt_switches_the_motors_off_at_once() {
    let mut firmware = firmware();
    let handler = firmware.symbol("TIM2").unwrap();
    // `udf #0`
    firmware.patch(handler, &[0xDE00]).unwrap();
    let seen = print(&firmware, GCODE, None);
    assert_eq!(seen.end, End::Reset);
    assert!(seen.recorder.events.is_empty() && seen.safety.powered.is_empty());
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    assert!(is_told(&seen), "{:?}", seen.line.said);
}

#[test]
fn a_step_interrupt_that_hangs_is_ended_by_the_watchdog() {
    let mut firmware = firmware();
    let handler = firmware.symbol("TIM2").unwrap();
    firmware.patch(handler, &branch(handler, handler)).unwrap();
    let seen = print(&firmware, GCODE, None);
    assert_eq!(seen.end, End::Reset);
    println!("{:?}", seen.safety.switched);
    // It hangs at its first run.
    assert!(seen.resets[0].at.0 < WATCHDOG_NS + 100 * MS, "{:?}", seen.resets);
    assert!(seen.recorder.events.is_empty());
    assert_eq!(seen.safety.switched.last().map_or(MotorSet::NONE, |s| s.1), MotorSet::NONE);
    assert!(seen.safety.dangers.is_empty() && is_told(&seen), "{:?}", seen.line.said);
}
