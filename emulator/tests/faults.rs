//! Whatever happens to the chip: motors off, heaters off, and the cause is told after the reset.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod common;

use common::{MS, firmware, print};
use corehbot_emulator::firmware::branch;
use corehbot_emulator::run::Seen;
use corehbot_emulator::trap::Trap;
use corehbot_emulator::watch::{End, Injection};

const GCODE: &str = "G28\nG1 X60 Y60 F6000\nM400\n";

/// Watchdog: 500 counts of 1 kHz, and LSI may run at 17 kHz instead of 32 kHz; the model runs at 32 kHz.
const WATCHDOG_NS: u64 = 520 * MS;

fn is_told(seen: &Seen) -> bool {
    seen.line.said.iter().any(|line| line.contains("the last reset came"))
}

/// From the fault until no motor had power, in ns; heaters never had it.
fn off_after(seen: &Seen) -> u64 {
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    assert!(seen.safety.powered.is_empty() && !seen.safety.is_hot());
    let at = seen.injected.expect("a fault");
    let off = seen.safety.switched.iter().find(|(when, on)| *when >= at && on.is_empty());
    off.expect("motors without power").0 - at
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
    assert_eq!(seen.laps.out_of_step, 0, "the firmware's time");
}

#[test]
fn a_bus_error_while_stepping_switches_the_motors_off_at_once() {
    let seen = print(&firmware(), GCODE, Some(Injection::BusError { after: 1000 }));
    assert_eq!(seen.end, End::Reset);
    let off = off_after(&seen);
    println!("motors off {off} ns after the fault");
    assert!(off < MS);
    assert!(is_told(&seen), "{:?}", seen.line.said);
}

/// Runs into `trap` in mid-motion; from there until no motor had power, in ns, and what was seen.
fn fall_into(trap: Trap) -> (u64, Seen) {
    let mut firmware = firmware();
    firmware.lay(trap).unwrap();
    let seen = print(&firmware, GCODE, Some(Injection::Trap { after: 1000 }));
    assert_eq!((seen.end, seen.recorder.events.len()), (End::Reset, 1000));
    let off = off_after(&seen);
    println!("{trap:?}: motors off {off} ns after the event before it");
    assert!(is_told(&seen), "{:?}", seen.line.said);
    (off, seen)
}

#[test]
fn an_illegal_instruction_in_the_step_interrupt_switches_the_motors_off_at_once() {
    // The trap springs at the next event.
    assert!(fall_into(Trap::IllegalInstruction).0 < 2 * MS);
}

#[test]
fn a_panic_in_the_step_interrupt_switches_the_motors_off_and_is_told() {
    let (off, seen) = fall_into(Trap::Panic);
    assert!(off < 2 * MS);
    assert!(seen.line.said.iter().any(|line| line.contains("trap")), "{:?}", seen.line.said);
}

#[test]
fn a_step_interrupt_that_hangs_is_ended_by_the_watchdog() {
    assert!(fall_into(Trap::Hang).0 < WATCHDOG_NS);
}

/// The stack lies at the bottom of RAM, so it cannot grow into anything; the handler takes a fresh one, because
/// nothing can be pushed on the full one.
#[test]
fn a_stack_that_overflows_ends_at_the_edge_of_the_memory() {
    let (off, seen) = fall_into(Trap::StackOverflow);
    assert!(off < 2 * MS);
    let told = seen.line.said.iter().find(|line| line.contains("a hard fault")).expect("the cause");
    println!("{told}");
    let stack = told.rsplit("SP ").next().map(|digits| u32::from_str_radix(digits, 16));
    assert!(matches!(stack, Some(Ok(address)) if (0x1FFF_FF00..0x2000_0000).contains(&address)), "{told}");
    // The push failed (PRECISERR, and BFAR says where), and so did the exception's (STKERR; ARM DDI 0403E, B3.2.15).
    assert!(told.contains("CFSR 00009200"), "{told}");
}

#[test]
fn a_crystal_that_stops_switches_the_motors_off_and_is_told() {
    let (off, seen) = fall_into(Trap::ClockFailure);
    assert!(off < 2 * MS);
    assert!(seen.line.said.iter().any(|line| line.contains("the crystal has stopped")), "{:?}", seen.line.said);
}

/// The reload value needs five cycles of the slow oscillator to arrive (RM0390 rev 6, section 19.3); start-up waits
/// for it, or the first period would be that of the reset value, 4.1 s.
#[test]
fn the_first_period_of_the_watchdog_is_half_a_second_too() {
    let mut firmware = firmware();
    let handler = firmware.symbol("TIM2").unwrap();
    firmware.patch(handler, &branch(handler, handler)).unwrap();
    let seen = print(&firmware, GCODE, None);
    assert_eq!(seen.end, End::Reset);
    assert!(seen.resets[0].at.0 < WATCHDOG_NS + 100 * MS, "{} ms after power-up", seen.resets[0].at.0 / MS);
    assert!(seen.recorder.events.is_empty() && seen.safety.powered.is_empty());
}
