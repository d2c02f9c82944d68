//! The image starts as the machine that is stored, whatever moves it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Bench, bench_of, firmware, lines_of, plain_firmware, print_on, root};
use crate::storage::STACK_RESERVE;
use corehbot::connectors::{ConnectorName, Heater};
use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::settings::{AxisEnd, Endstop, HomedAxis, Settings};
use corehbot_emulator::compare::{difference, scheduled};
use corehbot_emulator::driver_line::DriverLines;
use corehbot_emulator::eeprom::{At24c32, Cut};
use corehbot_emulator::firmware::Firmware;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;
use corehbot_emulator::wiring::{OCTOPUS, Pin, Slot, Wiring};
use corehbot_machine_file as machine_file;

/// Both belts and the screw, and an arc.
const GCODE: &str = "G28\nG1 X40 Y20 F12000\nG1 Z2\nG2 X60 Y40 I20 J0\nG1 X45 F9000\nM114\n";

/// Prints on the machine of a file in the EEPROM, compares the steps with the simulator's, and says which motors
/// stepped.
fn motors_of(name: &str) -> MotorSet {
    motors_on(&bench_of(machine_file::read(&root().join("examples/machines").join(name)).unwrap().settings))
}

fn motors_on(bench: &Bench<'_>) -> MotorSet {
    let settings = bench.settings;
    let seen = print_on(&firmware(), GCODE, bench);
    assert_eq!((seen.end, seen.resets.len(), &seen.line.failure), (End::Done, 0, &None));
    let host = scheduled(GCODE, &settings).unwrap();
    if let Some(difference) = difference(&seen.recorder.events, &host) {
        panic!("{difference}");
    }
    assert!(seen.safety.dangers.is_empty() && seen.recorder.unpowered == 0);
    let stored: Vec<_> = seen.line.said.iter().filter(|line| line.contains("stored settings retrieved")).collect();
    assert_eq!(stored.len(), 1, "{:?}", seen.line.said);
    host.iter().fold(MotorSet::NONE, |all, event| all.with(event.steps))
}

/// QEMU prints with these files too (`xtask/src/compare/mod.rs`).
#[test]
fn four_motors_drive_a_corexy() {
    assert_eq!(motors_of("awd-corexy.toml"), prototype::BELT.with(MotorSet::of(prototype::Z1)));
}

/// The third screw has the eighth socket of the Octopus.
#[test]
fn eight_motors_are_as_many_as_a_board_drives() {
    let mut wiring = OCTOPUS;
    let motor = Motor::ALL[prototype::COUNT];
    let [step, dir, enable, uart] = wiring.spare.unwrap().pins;
    wiring.slots[motor.index()] = Some(Slot { motor, step, dir, enable, uart: Some(uart) });
    let wiring: &'static _ = Box::leak(Box::new(wiring));
    let machine = machine_file::read(&root().join("examples/machines/corehbot-three-screws.toml")).unwrap();
    let bench = Bench { wiring, drivers: DriverLines::new(wiring), ..bench_of(machine.settings) };
    assert_eq!(motors_on(&bench), MotorSet::ALL.without(MotorSet::of(prototype::E0)));
}

#[test]
fn pulleys_may_have_different_sizes() {
    let motors = [prototype::M8, prototype::M11, prototype::Z1].into_iter().map(MotorSet::of);
    assert_eq!(motors_of("core-unequal.toml"), motors.fold(MotorSet::NONE, MotorSet::with));
}

#[test]
fn a_corexyz_lifts_with_all_four() {
    assert_eq!(motors_of("corexyz.toml"), prototype::BELT);
}

/// Motors 1 and 8 in each other's sockets, both reversed: the belt moves as before. The switches of x and y in each
/// other's inputs.
#[test]
fn motors_and_switches_are_where_the_file_has_them() {
    let file =
        "board = \"octopus\"\n[motors]\nm1 = \"!M4\"\nm8 = \"!M0\"\n[endstops]\nx = \"Y-STOP\"\ny = \"X-STOP\"\n";
    let mut wiring = OCTOPUS;
    let [(_, x), (_, y), _] = &mut wiring.endstops;
    std::mem::swap(x, y);
    let bench = Bench { wiring: Box::leak(Box::new(wiring)), ..bench_of(machine_file::load(file).unwrap()) };
    assert_eq!(motors_on(&bench), prototype::ALL.without(MotorSet::of(prototype::E0)));
}

/// A switch that closes when it is pressed reads inverted.
#[test]
fn a_normally_open_switch_reads_the_other_way_round() {
    let bench = bench_of(machine_file::load("[endstops]\nz = \"!Z-STOP\"\n").unwrap());
    let seen = print_on(&firmware(), "M119\n", &bench);
    for line in ["x_min: open", "y_min: open", "z_min: TRIGGERED"] {
        assert!(seen.line.said.iter().any(|said| said == line), "{:?}", seen.line.said);
    }
}

/// Parts without a connector on the board are reported, and no motor gets power.
#[test]
fn a_machine_for_another_board_is_told_of_and_not_used() {
    let mut settings = Settings::prototype();
    settings.wiring.motors[0].connector = ConnectorName::lit("M8");
    settings.thermal.heater_mut(Heater::Hotend).is_fitted = true;
    let seen = print_on(&firmware(), "M104 S200\nM501\nM104 S200\nG4 P500\nM105\nG28 Z\n", &bench_of(settings));
    assert_eq!((seen.end, seen.recorder.events.len(), seen.recorder.unpowered), (End::Done, 0, 0));
    // No target of 200 degrees was taken.
    assert!(seen.line.said.iter().all(|line| !line.contains("/200")), "{:?}", seen.line.said);
    assert!(seen.safety.dangers.is_empty());
    let why =
        "the machine is not used: motor m1: the BTT Octopus has no connector M8; it has M0, M1, M2, M3, M4, M5, M6, M7";
    for told in [
        format!("echo:{why}; no motor gets power"),
        format!("echo:Settings unchanged: {why}"),
        format!("Error:{why}; no motor got power"),
    ] {
        assert!(seen.line.said.contains(&told), "{:?}", seen.line.said);
    }
}

/// A board without a machine talks and reports. It moves nothing, heats nothing, and does not take the prototype for
/// its machine by an M500. A machine that is sent is stored, and counts after a reset.
#[test]
fn a_board_without_a_machine_says_so_and_moves_nothing() {
    let machine = Settings { keepalive_s: 9, ..Settings::prototype() };
    // A host that hears an error prints no further.
    let gcode = format!("M115\nM105\nM104 S200\nM500\nMACHINE_GET\nM114\n{}G28\n", lines_of(&machine));
    let seen = print_on(&plain_firmware(), &gcode, &Bench::default());
    assert_eq!((seen.end, seen.resets.len(), seen.recorder.events.len()), (End::Done, 0, 0));
    assert!(seen.safety.dangers.is_empty() && seen.recorder.unpowered == 0);
    let said = |text: &str| seen.line.said.iter().filter(|line| line.contains(text)).count();
    let why = "this board has no machine: send one (corehbot config send) or flash an image with one";
    for told in [
        format!("echo:{why}; no motor gets power"),
        format!("echo:Settings not stored: {why}"),
        format!("echo:machine not stored: {why}"),
        format!("Error:{why}; no motor got power"),
    ] {
        assert_eq!(said(&told), 1, "{told}: {:?}", seen.line.said);
    }
    assert_eq!((said("FIRMWARE_NAME:"), said("in effect after the next reset")), (1, 1), "{:?}", seen.line.said);
    let again = Bench { settings: machine, eeprom: At24c32::holding(seen.eeprom.cells), ..Bench::default() };
    // M502 goes back to that machine too, because the image has none.
    let seen = print_on(&plain_firmware(), "G28 Z\nM113 S3\nM502\nM113\n", &again);
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None));
    assert!(!seen.recorder.events.is_empty() && seen.line.said.contains(&"echo:M113 S9".to_owned()));
}

/// `corehbot image` puts a machine into the image, which is all that such a board needs: it has the motors, switches
/// and serial rate of that machine.
#[test]
fn an_image_with_a_machine_in_it_starts_as_that() {
    let mut settings = machine_file::read(&root().join("examples/machines/hbot.toml")).unwrap().settings;
    // Away from 0, and from behind; the order is another as well.
    settings.endstops.y = Endstop { end: AxisEnd::Max, position: settings.axes.y.length };
    settings.homing_order = [HomedAxis::Y, HomedAxis::X, HomedAxis::Z];
    settings.baud = 115_200;
    let mut firmware = firmware();
    firmware.put_machine(&mut settings).unwrap();
    let bench = Bench { settings, ..Bench::default() };
    let seen = print_on(&firmware, GCODE, &bench);
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None));
    assert!(seen.line.said.iter().any(|line| line.contains("Hardcoded Default Settings")), "{:?}", seen.line.said);
    assert!((seen.line.baud - 115_200.0).abs() < 600.0, "{}", seen.line.baud);
    let host = scheduled(GCODE, &settings).unwrap();
    if let Some(difference) = difference(&seen.recorder.events, &host) {
        panic!("{difference}");
    }
}

/// A machine from the serial line is stored and reported. After a reset the board is that machine, a CoreXY with two
/// belt motors and one screw.
#[test]
fn a_machine_that_was_sent_is_there_after_a_reset() {
    let machine = machine_file::read(&root().join("examples/machines/corexy.toml")).unwrap().settings;
    let seen = print_on(&firmware(), &lines_of(&machine), &Bench::default());
    assert_eq!((seen.end, &seen.line.failure, seen.line.resends), (End::Done, &None, 0));
    let told = |line: &&String| line.starts_with("echo:machine stored (") && line.ends_with("after the next reset");
    assert_eq!(seen.line.said.iter().filter(told).count(), 1, "{:?}", seen.line.said);
    let motors = [prototype::M8, prototype::M11, prototype::Z1].into_iter().map(MotorSet::of);
    let again = Bench { settings: machine, eeprom: At24c32::holding(seen.eeprom.cells), ..Bench::default() };
    assert_eq!(motors_on(&again), motors.fold(MotorSet::NONE, MotorSet::with));
}

/// A power cut while a machine that was sent is being stored leaves the old machine or the new one. Every byte is cut
/// on the host (`tests/storage` of the core); here two runs cost some seconds, so that `cargo xtask soak` alone cuts
/// 200 bytes.
#[test]
fn a_power_cut_while_a_machine_is_stored_leaves_the_old_or_the_new() {
    let store = |keepalive_s| {
        let machine = Settings { keepalive_s, ..Settings::prototype() };
        lines_of(&machine)
    };
    let talk = |eeprom: At24c32, gcode: &str| print_on(&firmware(), gcode, &Bench { eeprom, ..Bench::default() });
    let old = talk(At24c32::default(), &store(8)).eeprom;
    let written: usize = old.writes.iter().map(|(_, size)| size).sum();
    let cuts: usize = std::env::var("COREHBOT_SOAK_CUTS").map_or(4, |cuts| cuts.parse().unwrap());
    let mut kept = Vec::new();
    // From the first bytes to just after the last.
    for (number, after) in (0..cuts).map(|cut| 3 + written * cut / (cuts - 1)).enumerate() {
        let mut eeprom = At24c32::holding(old.cells.clone());
        eeprom.cut = Some(Cut { after, whole_page: number % 2 == 0 });
        let cut = talk(eeprom, &store(9));
        assert!(cut.stack_free >= STACK_RESERVE, "{}", cut.stack_free);
        let told = cut.line.said.iter().any(|line| line.starts_with("echo:machine stored"));
        assert_eq!(told, cut.end == End::Done, "after {after}: {:?}", cut.line.said);
        let seen = talk(At24c32::holding(cut.eeprom.cells), "M113\n");
        assert!(seen.line.said.iter().any(|line| line.starts_with("echo:stored settings retrieved")), "after {after}");
        let [is_old, is_new] =
            ["echo:M113 S8", "echo:M113 S9"].map(|line| seen.line.said.iter().any(|said| said == line));
        assert!(is_old != is_new && (is_new || !told), "after {after}: {:?}", seen.line.said);
        kept.push(is_new);
    }
    let new = kept.iter().filter(|is_new| **is_new).count();
    println!("{cuts} cuts: {} left the old machine, {new} the new one", kept.len() - new);
    assert!((1..kept.len()).contains(&new), "{kept:?}");
}

/// Prints some moves from the machine's current position, compares the steps with the simulator's, and returns the rest
/// of the record. All switches are open, and each is read on its own input.
fn moves_on(firmware: &Firmware, file: &str, wiring: Wiring) -> Seen {
    let wiring: &'static _ = Box::leak(Box::new(wiring));
    let bench = Bench { wiring, drivers: DriverLines::new(wiring), ..bench_of(machine_file::load(file).unwrap()) };
    let gcode = "M119\nG92 X0 Y0 Z0\nG1 X8 Y4 Z.5 E1 F12000\nG1 X4\nG2 X6 Y6 I2 J0\n";
    let seen = print_on(firmware, gcode, &bench);
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None));
    assert_eq!(difference(&seen.recorder.events, &scheduled(gcode, &bench.settings).unwrap()), None);
    assert_eq!((&seen.safety.dangers, &seen.gaps.found, seen.recorder.unpowered), (&vec![], &vec![], 0));
    for line in ["x_min: open", "y_min: open", "z_min: open"] {
        assert!(seen.line.said.iter().any(|said| said == line), "{:?}", seen.line.said);
    }
    seen
}

/// The image steps on the pins of each board as the simulator does. Motor 4 is in a socket, and the switch of x at an
/// input, that the prototype does not use. On the Octopus the direction line of that socket is the debug port's clock.
/// A slow direction pin rises within 100 ns (STM32F446 datasheet, I/O AC characteristics at the lowest speed), and the
/// driver wants it 20 ns before a step.
#[test]
fn the_image_steps_on_each_of_its_boards() {
    for board in corehbot_boards::OCTOPUS.map(|entry| entry.board.connectors) {
        let mut firmware = firmware();
        firmware.set_board(board.key).unwrap();
        let mut wiring = *Wiring::called(board.key).unwrap_or_else(|| panic!("src/wiring.rs has no {}", board.key));
        let mut file = format!("board = \"{}\"\n", board.key);
        let mut has_slow_dir = false;
        if let Some(spare) = wiring.spare {
            let slot = wiring.slots[prototype::M4.index()].as_mut().unwrap();
            let [step, dir, enable, uart] = spare.pins;
            (slot.step, slot.dir, slot.enable, slot.uart) = (step, dir, enable, Some(uart));
            wiring.endstops[0].1 = spare.input.1;
            file += &format!("[motors]\nm4 = \"{}\"\n[endstops]\nx = \"{}\"\n", spare.socket, spare.input.0);
            // PC13 to PC15 (STM32F446 datasheet, pin definitions).
            has_slow_dir = dir.port == Pin::new('C', 0).port && dir.bit >= 13;
        }
        let seen = moves_on(&firmware, &file, wiring);
        println!("{}: dir to step {} ns", board.key, seen.recorder.pulse.set_up);
        assert!(seen.recorder.pulse.set_up >= if has_slow_dir { 120 } else { 20 }, "{:?}", seen.recorder.pulse);
        // SWDIO and SWCLK are the port's, unless a motor or a fan has the line.
        let is_taken = |bit| {
            let pin = Pin::new('A', bit);
            wiring.spare.is_some_and(|spare| spare.pins.contains(&pin)) || wiring.fans.iter().any(|fan| fan.pin == pin)
        };
        let left = [13, 14].map(|bit| u16::from(!is_taken(bit)));
        assert_eq!(seen.debug_pins, left[0] | left[1] << 1, "{}", board.key);
    }
    let usual = print_on(&firmware(), "M119\n", &Bench::default());
    assert_eq!(usual.debug_pins, 0b11, "without a motor there the port has its clock");
}

/// An image that several boards share starts on each as that.
#[test]
fn an_image_may_be_on_another_of_its_boards() {
    let mut firmware = firmware();
    firmware.set_board("octopus-pro").unwrap();
    let mut elsewhere = Settings::prototype();
    elsewhere.wiring.motors[0].connector = ConnectorName::lit("A");
    let seen = print_on(&firmware, "M114\n", &bench_of(elsewhere));
    let told = "echo:the machine is not used: motor m1: the BTT Octopus Pro V1.0 has no connector A; it has M0, ";
    assert!(seen.line.said.iter().any(|said| said.starts_with(told)), "{:?}", seen.line.said);
    assert!(firmware.set_board("nucleo").is_err());
}
