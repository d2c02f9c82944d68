//! Whatever happens to the chip: motors off, heaters off, and the cause is reported after the reset. Panics, processor
//! faults, hangs, a full stack and a crystal that stops are in `heat_crashes`, with heaters on and motors stepping or
//! not.

use crate::common::{MS, firmware, print};
use corehbot_emulator::bootloader::Bootloader;
use corehbot_emulator::firmware::branch;
use corehbot_emulator::run::Seen;
use corehbot_emulator::trap::Trap;
use corehbot_emulator::watch::{End, Injection};
use corehbot_emulator::wiring::{OCTOPUS, Pin};

const GCODE: &str = "G28\nG1 X60 Y60 F6000\nM400\n";

/// Watchdog: 500 counts of 1 kHz, and LSI may run at 17 kHz instead of 32 kHz; the model runs at 32 kHz.
const WATCHDOG_NS: u64 = 520 * MS;

fn is_reported(seen: &Seen) -> bool {
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
    assert!(is_reported(&seen), "{:?}", seen.line.said);
}

fn fall(trap: Trap, injection: Injection) -> (u64, Seen) {
    let mut firmware = firmware();
    firmware.lay(trap).unwrap();
    let seen = print(&firmware, GCODE, Some(injection));
    assert_eq!(seen.end, End::Reset);
    let off = off_after(&seen);
    println!("{trap:?}: motors off {off} ns after the event before it");
    assert!(is_reported(&seen), "{:?}", seen.line.said);
    (off, seen)
}

#[test]
fn f40_a_bit_that_flips_among_the_words_of_the_step_pins_ends_motion_and_heat_within_a_second() {
    let on_port_f = OCTOPUS.slots.iter().flatten().filter(|slot| slot.step.port == Pin::new('F', 0).port);
    // The value that lowers the step lines of a port, in the set/reset register (RM0390 rev 6, section 7.4.7).
    let word = on_port_f.map(|slot| u32::from(slot.step.mask()) << 16).sum();
    let gcode = "G92 X0 Y0 Z0\nG1 X200 Y50 F1500\nM400\n";
    let seen = print(&firmware(), gcode, Some(Injection::Flip { after: 1000, word }));
    let off = off_after(&seen);
    println!("motors off {off} ns after the flip");
    assert!(off < 1000 * MS);
    assert!(seen.line.said.iter().any(|line| line.contains("[E15]")), "{:?}", seen.line.said);
}

#[test]
fn a_supply_that_falls_switches_the_motors_off_and_is_waited_for() {
    let (off, seen) = fall(Trap::SupplyFalls, Injection::SupplyFalls { after: 1000 });
    assert!(off < 2 * MS);
    // The step interrupt that is under way comes to its end.
    assert!((1001..1010).contains(&seen.recorder.events.len()), "{}", seen.recorder.events.len());
    assert!(seen.line.said.iter().any(|line| line.contains("the supply fell")), "{:?}", seen.line.said);
    assert!(seen.has_waited, "full speed on a low supply");
    assert_eq!(seen.resets.len(), 1);
}

/// The model has the option bytes of a chip as delivered: no brown-out reset.
#[test]
fn a_chip_without_brown_out_reset_is_reported_at_the_start_and_by_m122() {
    let seen = print(&firmware(), "M122\n", None);
    assert_eq!(seen.end, End::Done);
    let told = seen.line.said.iter().filter(|line| line.contains("brown-out reset is not at level 3")).count();
    assert_eq!(told, 2, "{:?}", seen.line.said);
}

/// A bootloader that leaves SWDIO (PA13) an output, as BTT's has it while it runs: a probe could not attach to the
/// firmware.
#[test]
fn the_debug_port_has_its_pins() {
    for bootloader in [Bootloader::Btt, Bootloader::Careless] {
        let mut firmware = firmware();
        firmware.bootloader = bootloader;
        let seen = print(&firmware, "M105\n", None);
        assert_eq!(seen.end, End::Done);
        assert_eq!(seen.debug_pins, 0b11, "SWCLK, SWDIO after {bootloader:?}");
    }
}

/// The reload value needs five cycles of the slow oscillator to arrive (RM0390 rev 6, section 19.3). Start-up waits for
/// it; otherwise the first period would use the reset value, 4.1 s.
#[test]
fn the_first_period_of_the_watchdog_is_half_a_second_too() {
    let mut firmware = firmware();
    let handler = firmware.symbol("SysTick").unwrap();
    firmware.patch(handler, &branch(handler, handler)).unwrap();
    let seen = print(&firmware, GCODE, None);
    assert_eq!(seen.end, End::Reset);
    assert!(seen.resets[0].at.0 < WATCHDOG_NS + 100 * MS, "{} ms after power-up", seen.resets[0].at.0 / MS);
    assert!(seen.recorder.events.is_empty() && seen.safety.powered.is_empty());
}
