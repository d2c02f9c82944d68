//! Whatever ends the firmware while a heater is on: the heater's pin is low within its time and motors lose their
//! power. The cause is reported after the reset, and nothing heats by itself any more. Times are measured at pins.

use crate::common::{Bench, MS, firmware, heated_bench, print_on};
use corehbot_emulator::heat_pins::Climate;
use corehbot_emulator::line::Manner;
use corehbot_emulator::run::Seen;
use corehbot_emulator::trap::{PANIC_CALL, Place, Trap};
use corehbot_emulator::watch::{End, Injection, With};

/// Full power for the hotend and a long move, until something happens; and the same with motors that stand.
const MOVING: &str = "M104 S200\nG92 X0 Y0 Z0\nG1 X200 Y50 F1500\nM400\n";
const STANDING: &str = "M104 S200\nM17\nG4 S60\n";

/// Limit after a crash in ns: heaters and motors are off by then.
const AT_ONCE: u64 = 20_000;

/// A processor that hangs: the heaters' timer ends its pulses by itself, after a control period at the latest. The
/// promise is 100 ms.
const BY_THE_TIMER: u64 = 20 * MS;

/// Watchdog: 500 counts of 1 kHz at the 32 kHz of the data sheet, after the last control period that was well.
const WATCHDOG: u64 = 520 * MS;

/// When the fault comes: the drivers have been set up, motors have got power one after another, and the heater has been
/// on.
const AFTER: u64 = 1500 * MS;

/// A machine at 100 C.
fn bench(injection: Injection) -> Bench<'static> {
    Bench {
        injection: Some(injection),
        climate: Climate { start: Some([100.0, 25.0]), mishap: None, ..Climate::default() },
        after_reset: 60 * MS,
        ..heated_bench()
    }
}

/// From the fault to the last heater's pin that went low, to motors without power, and to the reset, in ns.
#[derive(Debug)]
struct Times {
    heaters: u64,
    motors: u64,
    reset: u64,
}

/// Checks the required result of every crash.
fn check(seen: &Seen, told: &str) -> Times {
    assert_eq!(seen.end, End::Reset, "{:?}", seen.line.said);
    let at = seen.fallen.or(seen.injected).expect("a fault");
    let reset = seen.resets.first().expect("a reset").at.0;
    assert!(seen.safety.dangers.is_empty(), "{:?}", seen.safety.dangers);
    // The heater had been on for a while, the motors had power, and after the reset there is neither.
    assert!(seen.heat.edges.len() > 20);
    assert!(seen.safety.switched.iter().any(|(when, on)| *when < at && !on.is_empty()), "motors had power");
    let off = seen.heat.off_since().expect("heaters that are off");
    assert!(off <= reset && !seen.safety.is_hot() && seen.safety.powered.is_empty());
    assert!(seen.heat.supply.contains(&(reset, false)), "PS_ON is let go: {:?}", seen.heat.supply);
    let motors = seen.safety.switched.iter().find(|(when, on)| *when >= at && on.is_empty()).expect("motors off").0;
    assert!(seen.line.said.iter().any(|line| line.contains(told)), "{told}: {:?}", seen.line.said);
    Times { heaters: off.saturating_sub(at), motors: motors - at, reset: reset - at }
}

/// A context of a machine that heats falls into a trap.
fn fall(place: Place, trap: Trap, with: With, told: &str) -> (Times, Seen) {
    let mut firmware = firmware();
    firmware.lay_in(place, trap).unwrap();
    // Motion costs emulator time, so only faults in the contexts that make steps get moving motors.
    let gcode = if matches!(place, Place::Generator | Place::Stepper) { MOVING } else { STANDING };
    let seen = print_on(&firmware, gcode, &bench(Injection::TrapWhileHot { after: AFTER, with }));
    let times = check(&seen, told);
    println!("{trap:?} in {place:?}: {times:?} ns");
    (times, seen)
}

/// The same where heaters and motors are off at once.
fn fall_at_once(place: Place, trap: Trap, with: With, told: &str) -> Seen {
    let (times, seen) = fall(place, trap, with, told);
    assert!(times.heaters <= AT_ONCE && times.motors <= AT_ONCE && times.reset < 2 * MS, "{times:?}");
    assert_eq!(seen.resets.len(), 1);
    // The step interrupt that is under way may come to its end.
    let at = seen.fallen.or(seen.injected).expect("a fault");
    let last = seen.recorder.events.last().map(|event| event.at);
    assert!(last.is_none_or(|last| last <= at + AT_ONCE), "a step {last:?} after {at}");
    seen
}

#[test]
fn f31_a_panic_is_off_at_once_in_every_context() {
    // The control period's is in F39.
    for place in [Place::Console, Place::Generator, Place::Stepper] {
        let seen = fall_at_once(place, Trap::Panic, With::Nothing, "a panic, called at 0");
        let call = format!(" {PANIC_CALL:08x}");
        assert!(seen.line.said.iter().any(|line| line.contains(&call)), "{call}: {:?}", seen.line.said);
    }
}

/// Faults that the processor raises. It divides by zero without a fault (DIV_0_TRP is 0), and Rust checks before it
/// divides.
#[test]
fn f32_a_processor_fault_is_off_at_once() {
    for (place, trap, cause) in [
        (Place::Console, Trap::BadPointer, "CFSR 00000082"),
        (Place::Stepper, Trap::IllegalInstruction, "CFSR 00010000"),
        (Place::Generator, Trap::Unaligned, "CFSR 01000000"),
        (Place::Console, Trap::ExecuteRam, "CFSR 00000001"),
        (Place::Thermal, Trap::ExecuteZero, "CFSR 00020000"),
    ] {
        fall_at_once(place, trap, With::Nothing, &format!("a hard fault: {cause}"));
    }
}

/// The lowest KiB of RAM is an MPU region without access, and so is the memory below. The handler takes a fresh stack,
/// because nothing can be pushed on the full one. The test makes no access fail: below RAM the model answers 0.
#[test]
fn f33_a_stack_that_overflows_ends_at_its_guard() {
    // The stack has to be filled first, by 32 bytes in two instructions.
    let (times, seen) = fall(Place::Console, Trap::StackOverflow, With::Nothing, "a stack overflow");
    assert!(times.heaters < MS && times.motors < MS, "{times:?}");
    let told = seen.line.said.iter().find(|line| line.contains("a stack overflow")).expect("the cause");
    println!("{told}");
    let after = |word: &str| {
        let digits = told.split(word).nth(1).and_then(|rest| rest.split(' ').next());
        u32::from_str_radix(digits.expect(word), 16).expect(word)
    };
    let guard = 0x2000_0000..0x2000_0400;
    assert!(guard.contains(&after("MMFAR ")) && guard.contains(&after("SP ")), "{told}");
    // The push failed (DACCVIOL, and MMFAR says where), and so did the exception's (MSTKERR; ARM DDI 0403E, B3.2.15).
    assert_eq!(after("CFSR "), 0x92, "{told}");
}

#[test]
fn f22_a_supply_that_falls_is_off_at_once_and_waited_for() {
    let seen = fall_at_once(Place::Stepper, Trap::SupplyFalls, With::LowSupply, "the supply fell");
    assert!(seen.has_waited, "full speed on a low supply");
}

#[test]
fn f37_a_crystal_that_stops_is_off_at_once() {
    fall_at_once(Place::Console, Trap::ClockFailure, With::StoppedCrystal, "the crystal has stopped");
}

/// The dead man alone: nothing is executed any more but a branch to itself, and no interrupt gets through.
#[test]
fn the_timer_ends_the_pulses_of_a_processor_that_hangs() {
    let (times, seen) = fall(Place::Console, Trap::MaskedHang, With::Nothing, "the watchdog");
    assert!(times.heaters <= BY_THE_TIMER, "{times:?}");
    assert!(times.motors <= WATCHDOG && times.reset <= WATCHDOG, "{times:?}");
    // The pin was high when it began to hang.
    let fallen = seen.fallen.unwrap();
    assert!(seen.heat.edges.iter().rfind(|edge| edge.at <= fallen).is_some_and(|edge| edge.is_high));
}

/// Contexts above the control period take its time away: the timer ends the pulses. The control period itself is in
/// F38.
#[test]
fn f30_a_generator_or_stepper_that_hangs_is_ended_by_timer_and_watchdog() {
    for place in [Place::Generator, Place::Stepper] {
        let (times, _) = fall(place, Trap::Hang, With::Nothing, "the watchdog");
        assert!(times.heaters <= BY_THE_TIMER, "{times:?}");
        assert!(times.motors <= WATCHDOG && times.reset <= WATCHDOG, "{times:?}");
    }
}

/// The Console hangs alone, and all others continue: the control period notices, and stops feeding after half of the
/// time.
#[test]
fn f30_a_console_that_hangs_is_found_before_the_watchdog_bites() {
    let (times, _) = fall(Place::Console, Trap::Hang, With::Nothing, "a part of the firmware hangs");
    assert!((350 * MS..=500 * MS).contains(&times.heaters), "{times:?}");
    assert!(times.reset > times.heaters && times.reset <= 200 * MS + WATCHDOG, "{times:?}");
}

/// The slow oscillator may have 17 to 47 kHz (STM32F446 datasheet, LSI).
#[test]
fn f30_f38_a_control_period_that_hangs_is_ended_within_a_second_by_the_slowest_watchdog() {
    let mut firmware = firmware();
    firmware.lay_in(Place::Thermal, Trap::Hang).unwrap();
    let trap = Injection::TrapWhileHot { after: AFTER, with: With::Nothing };
    let seen = print_on(&firmware, STANDING, &Bench { slow_oscillator: Some(17_000), ..bench(trap) });
    let times = check(&seen, "the watchdog");
    println!("17 kHz: {times:?} ns");
    assert!(times.heaters <= BY_THE_TIMER && (900 * MS..1000 * MS).contains(&times.reset), "{times:?}");
}

#[test]
fn f38_a_quick_watchdog_bites_nobody_who_is_well() {
    // Start, drivers, EEPROM, motion and heat.
    let gcode = "M104 S120\nM17\nG92 X0 Y0 Z0\nG1 X20 Y20 F9000\nM500\nM122\nG4 P500\n";
    let climate = Climate { start: Some([118.0, 25.0]), mishap: None, ..Climate::default() };
    let seen = print_on(&firmware(), gcode, &Bench { slow_oscillator: Some(47_000), climate, ..heated_bench() });
    assert_eq!((seen.end, seen.resets.len()), (End::Done, 0), "{:?}", seen.line.said);
    assert!(seen.virtual_ns > 2000 * MS && seen.heat.edges.len() > 100);
}

/// An interrupt that never goes away: its handler runs again and again, and only the Stepper and the supply's detector
/// are above it. It is masked after a number of calls, and the machine stops without a reset; hosts on the other lines
/// are told why.
#[test]
fn f35_a_storm_of_interrupts_is_masked_and_ends_heat_and_motion() {
    /// OTG_FS and USART2, which is the line of the host (RM0390 rev 6, vector table).
    const USB: u16 = 67;
    const OWN_LINE: u16 = 38;
    for line in [USB, OWN_LINE] {
        // The quickest watchdog does not bite: the control of heat runs again in time.
        let storm = Injection::Storm { after: AFTER, line };
        let seen = print_on(&firmware(), MOVING, &Bench { slow_oscillator: Some(47_000), ..bench(storm) });
        let at = seen.injected.unwrap();
        let off = seen.heat.off_since().expect("heaters that are off").saturating_sub(at);
        let motors =
            seen.safety.switched.iter().find(|(when, on)| *when >= at && on.is_empty()).expect("motors off").0 - at;
        let during: Vec<_> = seen.recorder.events.iter().filter(|event| event.at > at).collect();
        let late = during.iter().filter_map(|event| event.schedule).map(|schedule| schedule.late).max();
        println!(
            "storm of {line}: heaters {off} ns, motors {motors} ns; {} events, at most {late:?} ns late",
            during.len()
        );
        assert!(
            seen.resets.is_empty() && seen.safety.dangers.is_empty(),
            "{:?} {:?}",
            seen.resets,
            seen.safety.dangers
        );
        assert!(off <= BY_THE_TIMER && motors <= 100 * MS, "{off} {motors}");
        assert!(!during.is_empty() && late.is_some_and(|late| late <= 5000), "{late:?}");
        let told = format!("interrupt {line}: came without end (interrupt storm), masked [E25]");
        let is_told = seen.line.said.iter().any(|said| said.contains(&told));
        assert_eq!(is_told, line != OWN_LINE, "{:?}", seen.line.said);
    }
}

/// A fault that comes again at every start: the third one ends it, and then nothing heats, moves or has power any more.
#[test]
fn f39_three_faults_in_a_minute_lock_heaters_and_motors() {
    let mut firmware = firmware();
    firmware.lay_in(Place::Thermal, Trap::Panic).unwrap();
    let trap = Injection::TrapWhileHot { after: AFTER, with: With::Repetition };
    let manner = Manner { is_impatient: true, insists: true, ..Manner::default() };
    let seen = print_on(&firmware, STANDING, &Bench { manner, after_reset: 2800 * MS, ..bench(trap) });
    let times = check(&seen, "three faults within a minute");
    let last = seen.resets.last().unwrap().at.0;
    println!("{times:?} ns; {} resets within {} ms", seen.resets.len(), (last - seen.resets[0].at.0) / MS);
    assert_eq!(seen.resets.len(), 3, "{:?}", seen.resets);
    // Whatever the host says, and it has said it again: no heater, no motor, no supply, all fans.
    assert!(seen.line.said.iter().filter(|line| line.contains("stay off")).count() > 1, "{:?}", seen.line.said);
    assert!(seen.virtual_ns > last + 2400 * MS && seen.heat.off_since().unwrap() < seen.resets[0].at.0);
    assert!(!seen.heat.supply.last().unwrap().1, "{:?}", seen.heat.supply);
    let fans = seen.heat.samples.last().unwrap().fans;
    assert!(fans.iter().all(|fan| *fan > 0.99), "{fans:?}");
}
