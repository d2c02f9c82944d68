//! The Nucleo's own image: four unmonitored drivers, one enable line, the ST-LINK's clock and serial port.

use crate::common::{Bench, MS, lines_of, nucleo_bench, nucleo_firmware, nucleo_machine, print_on};
use corehbot::connectors::ConnectorName;
use corehbot::motors::{EndstopSet, MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot_emulator::clock_tree::Defect;
use corehbot_emulator::compare::{difference, of_motors, scheduled, timing};
use corehbot_emulator::flash::FlashSectors;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;
use corehbot_emulator::wiring::{NUCLEO, Pin, Wiring};

/// Both belts, an arc, and moves of Z and the extruder, which have no motors. Z cannot be homed for the same reason.
const GCODE: &str =
    "M119\nG28 X Y\nG92 Z0 E0\nG1 X40 Y20 F12000\nG1 Z2 F600\nG2 X60 Y40 I20 J0 E1 F6000\nG1 X45 Z1 E2 F9000\nM114\n";

fn said(seen: &Seen, words: &str) -> usize {
    seen.line.said.iter().filter(|line| line.contains(words)).count()
}

/// Compares a print with the simulator's; the board has four of its motors.
fn check(seen: &Seen, gcode: &str, machine: &Settings) {
    assert_eq!((seen.end, &seen.line.failure, seen.line.resends), (End::Done, &None, 0), "{:?}", seen.line.said);
    assert_eq!((&seen.resets, &seen.safety.dangers, &seen.gaps.found), (&vec![], &vec![], &vec![]));
    assert_eq!((&seen.flash.faults, seen.core_hz), (&vec![], 180_000_000));
    seen.check_baud(250_000).unwrap();
    let all = scheduled(gcode, machine).unwrap();
    let host = of_motors(&all, NUCLEO.motors());
    assert!(host.len() > 1000 && all.iter().any(|event| event.steps.has(prototype::Z1)));
    let pins = &seen.recorder.events;
    if let Some(difference) = difference(pins, &host) {
        panic!("{difference}");
    }
    let timing = timing(pins, &host);
    let (first, last) = (timing.late.quantile(0.0), timing.late.max());
    println!("{} events, late {first} to {last} ns, {:?}", pins.len(), seen.recorder.pulse);
    assert_eq!((timing.inexact, timing.stretched, seen.slow_accesses), (0, 0, 0));
    assert!(first >= 0 && last <= 5000);
    assert_eq!((seen.recorder.split_pairs, seen.recorder.unpowered), (0, 0));
    // TMC2209 datasheet rev 1.09, section 13.1.
    let pulse = seen.recorder.pulse;
    assert!(pulse.high >= 100 && pulse.low >= 100 && pulse.set_up >= 20, "{pulse:?}");
    // D8 gives power to all at once.
    assert!(seen.safety.switched.iter().all(|(_, motors)| [MotorSet::NONE, prototype::BELT].contains(motors)));
}

/// The image with a machine in it, as `corehbot image` makes it.
#[test]
fn the_image_steps_on_the_four_sockets() {
    let mut machine = nucleo_machine();
    let mut firmware = nucleo_firmware();
    firmware.put_machine(&mut machine).unwrap();
    let seen = print_on(&firmware, GCODE, &Bench { settings: machine, ..nucleo_bench() });
    check(&seen, GCODE, &machine);
    // All switches are released at first. No driver is asked anything.
    assert_eq!(["x_min: open", "y_min: open", "z_min: open"].map(|line| said(&seen, line)), [1; 3]);
    assert_eq!(said(&seen, "river"), 0, "{:?}", seen.line.said);
    assert!(seen.drivers.iter().all(|line| line.datagrams == [0, 0]));
    assert_eq!(seen.flash.operations, []);
}

/// Motors 1 and 8 in each other's sockets, both reversed: the belt moves as before. Each switch in another's input.
#[test]
fn motors_and_switches_are_where_the_machine_has_them() {
    let mut machine = nucleo_machine();
    let [m1, _, m8, ..] = &mut machine.wiring.motors;
    for (slot, name) in [(m1, "A"), (m8, "X")] {
        (slot.connector, slot.is_reversed) = (ConnectorName::lit(name), true);
    }
    let ends = &mut machine.wiring.endstops;
    (ends.x.connector, ends.y.connector) = (ConnectorName::lit("Z"), ConnectorName::lit("X"));
    ends.z.connector = ConnectorName::lit("Y");
    let mut wiring = NUCLEO;
    let [x, y, z] = NUCLEO.endstops.map(|(_, pin)| pin);
    wiring.endstops = [(EndstopSet::X, z), (EndstopSet::Y, x), (EndstopSet::Z, y)];
    let wiring: &'static Wiring = Box::leak(Box::new(wiring));
    let mut firmware = nucleo_firmware();
    firmware.put_machine(&mut machine).unwrap();
    let gcode = "G28 X Y\nG92 Z0\nG1 X15 Y20 Z.5 F18000\n";
    let seen = print_on(&firmware, gcode, &Bench { settings: machine, wiring, ..nucleo_bench() });
    check(&seen, gcode, &machine);
}

/// Homing meets the switches of X and Y to the step; the switch of Z is only reported, as is any wire that is pulled.
#[test]
fn the_limit_of_z_is_read_on_its_own_pin() {
    let mut machine = nucleo_machine();
    let mut firmware = nucleo_firmware();
    firmware.put_machine(&mut machine).unwrap();
    let mut wiring = NUCLEO;
    let (_, z) = &mut wiring.endstops[2];
    // The machine's own switch is elsewhere.
    let stuck = Some((std::mem::replace(z, Pin::new('C', 0)), true));
    let wiring: &'static Wiring = Box::leak(Box::new(wiring));
    let seen = print_on(&firmware, "M119\n", &Bench { settings: machine, stuck, wiring, ..nucleo_bench() });
    assert_eq!(["x_min: open", "y_min: open", "z_min: TRIGGERED"].map(|line| said(&seen, line)), [1; 3]);
}

/// The image as it is built greets, reports and moves nothing. A machine that is sent is in flash, and counts after a
/// reset.
#[test]
fn a_board_without_a_machine_moves_nothing_until_it_is_sent_one() {
    let machine = Settings { keepalive_s: 9, ..nucleo_machine() };
    let gcode = format!("M115\nM500\nM114\n{}G28 X\n", lines_of(&machine));
    let seen = print_on(&nucleo_firmware(), &gcode, &nucleo_bench());
    assert_eq!((seen.end, seen.resets.len(), seen.recorder.events.len()), (End::Done, 0, 0), "{:?}", seen.line.said);
    assert!(seen.safety.switched.is_empty() && seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    println!("start {} us after reset", seen.started.unwrap() / 1000);
    assert!(seen.started.unwrap() < 100 * MS);
    let why = "this board has no machine: send one (corehbot config send) or flash an image with one";
    for told in [
        format!("echo:{why}; no motor gets power"),
        format!("echo:Settings not stored: {why}"),
        format!("Error:{why}; no motor got power"),
    ] {
        assert_eq!(said(&seen, &told), 1, "{told}: {:?}", seen.line.said);
    }
    assert_eq!((said(&seen, "FIRMWARE_NAME:"), said(&seen, "in effect after the next reset")), (1, 1));
    assert!(seen.flash.faults.is_empty() && !seen.flash.operations.is_empty(), "{:?}", seen.flash.faults);
    let flash = FlashSectors::holding(seen.flash.cells);
    let again = print_on(&nucleo_firmware(), GCODE, &Bench { settings: machine, flash, ..nucleo_bench() });
    check(&again, GCODE, &machine);
    assert_eq!(said(&again, "stored settings retrieved"), 1, "{:?}", again.line.said);
}

/// The shield lacks the sockets of other boards.
#[test]
fn a_machine_for_another_board_is_told_of_and_not_used() {
    let mut machine = nucleo_machine();
    machine.wiring.motors[0].connector = ConnectorName::lit("M0");
    let seen = print_on(&nucleo_firmware(), &lines_of(&machine), &nucleo_bench());
    let told = "the CNC shield has no connector M0; it has A, X, Y, Z";
    assert_eq!((said(&seen, told), seen.flash.operations.len()), (1, 0), "{:?}", seen.line.said);
}

/// The ST-LINK gives the processor's clock. Without it the serial line reports that, again and again, and nothing gets
/// power.
#[test]
fn a_st_link_that_gives_no_clock_is_reported() {
    let bench = Bench { defect: Defect::NoClock, whole: 900 * MS, ..nucleo_bench() };
    let seen = print_on(&nucleo_firmware(), "M105\n", &bench);
    assert_eq!((seen.end, seen.resets.len(), seen.started), (End::Late, 0, None), "{:?}", seen.line.said);
    let told = "Error:the ST-LINK gives no clock of 8 MHz, this board cannot print";
    assert!(said(&seen, told) >= 2 && seen.line.said.iter().all(|line| line == told), "{:?}", seen.line.said);
    seen.check_baud(250_000).unwrap();
    assert!(seen.safety.switched.is_empty() && seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
}
