//! Settings in the EEPROM, by the driver of the image: its messages, and the state after a power cut.

use crate::common::{Bench, MS, firmware, print_on};
use corehbot::settings::Settings;
use corehbot::units::{MmPerSec, MmPerSec2};
use corehbot_emulator::compare::{difference, scheduled, scheduled_with};
use corehbot_emulator::eeprom::{At24c32, Cut};
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;
use corehbot_emulator::wiring::Pin;
use corehbot_sim::eeprom::Eeprom;

/// Clock and data of the EEPROM's bus.
const LINES: [Pin; 2] = [Pin::new('B', 8), Pin::new('B', 9)];

/// A page of 32 bytes and two of address are on the bus for 0.9 ms, and the survey at the start reads two slots.
const START_NS: u64 = 200 * MS;

/// Bytes of a page (AT24C32 datasheet).
const PAGE: usize = 32;

/// Bytes that mark a record.
const MAGIC: usize = 4;

fn talk(eeprom: &At24c32, gcode: &str) -> Seen {
    let seen = print_on(&firmware(), gcode, &Bench { eeprom: eeprom.clone(), ..Bench::default() });
    assert!(seen.resets.is_empty() && seen.gaps.found.is_empty(), "{:?} {:?}", seen.resets, seen.gaps.found);
    seen
}

fn said<'s>(seen: &'s Seen, words: &str) -> Option<&'s String> {
    seen.line.said.iter().find(|line| line.contains(words))
}

/// The keepalive of M113, which M503 reports.
fn keepalive(seen: &Seen) -> u32 {
    let line = said(seen, "M113 S").unwrap_or_else(|| panic!("{:?}", seen.line.said));
    line.rsplit('S').next().unwrap().parse().unwrap()
}

#[test]
fn settings_are_kept_and_found_after_power_up() {
    let first = talk(&At24c32::default(), "M503\nM113 S7\nM203 X250.5\nM500\nM504\nM115\n");
    assert_eq!(first.end, End::Done);
    println!("start {} us after reset, blank", first.started.unwrap() / 1000);
    assert!(first.started.unwrap() < START_NS);
    assert!(said(&first, "echo:Settings Stored").is_some(), "{:?}", first.line.said);
    assert!(said(&first, "echo:stored settings valid").is_some() && said(&first, "Cap:EEPROM:1").is_some());
    let pages = first.eeprom.writes.clone();
    println!("pages {pages:?}, asked {} times while it wrote", first.eeprom.refusals);
    assert!(pages.iter().all(|(at, size)| at / 32 == (at + size - 1) / 32), "{pages:?}");
    assert!(first.eeprom.refusals > 0, "it was asked whether it is ready");
    // Once a turn of the Console, and not without a pause.
    assert!(first.eeprom.refusals as usize <= 12 * pages.len());

    let second = talk(&At24c32::holding(first.eeprom.cells), "M503\nM500\n");
    println!("start {} us after reset, with settings", second.started.unwrap() / 1000);
    assert!(second.started.unwrap() < START_NS);
    assert!(said(&second, "echo:stored settings retrieved").is_some(), "{:?}", second.line.said);
    assert_eq!(keepalive(&second), 7);
    assert!(said(&second, "M203 X250.5").is_some());
    assert_eq!(second.eeprom.writes, [], "what is stored already is not written again");
}

/// The machine of `--machine`.
#[test]
fn a_machine_in_the_eeprom_prints_as_the_simulator_does() {
    let gcode = "G92 X0 Y0 Z0\nG1 X60 Y30 F18000\nG1 X20\nM400\n";
    let (made, mut machine) = (Settings::prototype(), Settings::prototype());
    machine.axes.x.max_speed = MmPerSec::from_num(90);
    machine.travel_acceleration = MmPerSec2::from_num(1500);
    let mut eeprom = Eeprom::blank();
    eeprom.save(&machine).unwrap();
    let seen = talk(&At24c32::holding(eeprom.cells().to_vec()), gcode);
    assert!(seen.line.failure.is_none(), "{:?}", seen.line.failure);
    let host = scheduled_with(gcode, &made, &mut eeprom, None).unwrap();
    assert_eq!(difference(&seen.recorder.events, &host), None);
    assert_ne!(host, scheduled(gcode, &made).unwrap(), "the machine is another one");
}

/// Cuts the power after a number of bytes of a save and switches it on again. The last page, which holds the header, is
/// written last. Host tests cut at every byte (`tests/storage.rs` of the core); here a cut costs three seconds.
#[test]
fn a_power_cut_in_any_page_leaves_the_old_or_the_new() {
    let old = talk(&At24c32::default(), "M113 S7\nM500\nM113 S8\nM500\n").eeprom.cells;
    let whole = talk(&At24c32::holding(old.clone()), "M113 S9\nM500\n");
    let size: usize = whole.eeprom.writes.iter().map(|(_, size)| size).sum();
    assert!(size > 100, "{:?}", whole.eeprom.writes);
    let before_header = size - PAGE;
    assert_eq!(whole.eeprom.writes.last().unwrap().1, PAGE);
    let (mut came_up_new, mut wall) = (0, std::time::Duration::ZERO);
    // The last two: in the magic with the whole page torn, and behind it with a part.
    for after in [9, 310, before_header + 1, before_header + 18] {
        let mut eeprom = At24c32::holding(old.clone());
        eeprom.cut = Some(Cut { after, whole_page: after % 4 < 2 });
        let cut = talk(&eeprom, "M113 S9\nM500\n");
        assert_eq!(cut.end, End::PowerCut, "after {after}: {:?}", cut.line.said);
        assert!(said(&cut, "Stored").is_none(), "after {after}");
        let is_as_before = cut.eeprom.cells == old;
        let seen = talk(&At24c32::holding(cut.eeprom.cells), "M503\n");
        assert_eq!(seen.end, End::Done, "after {after}");
        assert!(seen.started.unwrap() < START_NS);
        assert!(said(&seen, "echo:stored settings retrieved").is_some(), "after {after}: {:?}", seen.line.said);
        let kept = keepalive(&seen);
        assert!(kept == 8 || kept == 9, "after {after}: {kept}");
        came_up_new += usize::from(kept == 9);
        // A torn slot is reported. A slot with unchanged content, or with a torn magic, does not count as torn.
        let is_told = said(&seen, "echo:storage slot A not used").is_some();
        let may_be_silent = is_as_before || (before_header..before_header + MAGIC).contains(&after);
        assert!(kept == 9 || is_told || may_be_silent, "after {after}: {:?}", seen.line.said);
        wall += cut.wall + seen.wall;
    }
    println!("{size} bytes, {came_up_new} times the new settings, {wall:?}");
}

#[test]
fn without_an_eeprom_the_machine_starts_and_says_that_nothing_is_stored() {
    let mut absent = At24c32::default();
    absent.answers = false;
    let seen = talk(&absent, "M500\nM501\nM113\n");
    complains(&seen);
}

fn complains(seen: &Seen) {
    assert_eq!(seen.end, End::Done, "{:?}", seen.line.said);
    println!("start {} us after reset", seen.started.unwrap() / 1000);
    assert!(seen.started.unwrap() < START_NS);
    for line in ["echo:storage does not answer", "echo:Settings not stored: storage", "echo:Settings unchanged: "] {
        assert!(said(seen, line).is_some(), "{line}: {:?}", seen.line.said);
    }
    assert!(said(seen, "Hardcoded Default").is_some() && said(seen, "M113 S2").is_some(), "{:?}", seen.line.said);
}

#[test]
fn a_bus_that_is_held_low_costs_no_more() {
    for line in LINES {
        let seen =
            print_on(&firmware(), "M500\nM501\nM113\n", &Bench { stuck: Some((line, false)), ..Bench::default() });
        assert!(seen.resets.is_empty(), "{line}: {:?}", seen.resets);
        complains(&seen);
    }
}

/// The guard of the stack, its lowest KiB, and the reserve above it for cases outside this test.
pub const STACK_RESERVE: u32 = 1024 + 2048;

/// Settings are the largest things on the stack: built at the start, read, saved and read again, while steps are made
/// and all drivers are monitored.
#[test]
fn the_stack_is_deep_enough_for_settings_and_steps_at_once() {
    let gcode = "M500\nM203 X250.5\nM500\nM501\nM504\nM502\nM503\nM122\nM115\nG28\nM593 F40\nM900 K0.05\nM569 S1\n\
                 G1 X30 Y30 E2 F6000\nG2 X50 Y50 I10 J10 E1\nG10\nG11\nM92 X81\nM501\nG1 X10 E1\nM906 X700\nM400\nM500\n";
    let first = talk(&At24c32::default(), gcode);
    let second = talk(&At24c32::holding(first.eeprom.cells.clone()), gcode);
    for seen in [&first, &second] {
        assert_eq!(seen.end, End::Done, "{:?}", seen.line.said);
        println!("{} bytes of the stack are left", seen.stack_free);
        assert!(seen.stack_free >= STACK_RESERVE, "{}", seen.stack_free);
    }
}
