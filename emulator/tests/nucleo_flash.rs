//! Settings in the Nucleo's flash, by the driver of the image: what it says, and what a power cut leaves.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod common;

use common::{Bench, MS, nucleo_bench, nucleo_firmware, nucleo_machine, print_on};
use corehbot_emulator::flash::{FlashCut, FlashSectors, Operation, Tear};
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;

/// All pages of a log that is nearly full are found in 130 ms.
const START_NS: u64 = 150 * MS;

/// To erase a sector at the most (STM32F446 datasheet, t_ERASE16KB at 32 bits).
const ERASE_NS: u64 = 500 * MS;

fn talk(flash: &FlashSectors, gcode: &str) -> Seen {
    let mut firmware = nucleo_firmware();
    firmware.put_machine(&mut nucleo_machine()).unwrap();
    let seen = print_on(&firmware, gcode, &Bench { flash: flash.clone(), ..nucleo_bench() });
    assert!(seen.resets.is_empty() && seen.gaps.found.is_empty(), "{:?} {:?}", seen.resets, seen.gaps.found);
    assert_eq!(seen.flash.faults, Vec::<&str>::new());
    seen
}

/// The same flash in a board that is switched on.
fn left(seen: &Seen) -> FlashSectors {
    FlashSectors::holding(seen.flash.cells.clone())
}

fn said(seen: &Seen, words: &str) -> usize {
    seen.line.said.iter().filter(|line| line.contains(words)).count()
}

fn says(seen: &Seen, words: &str) -> bool {
    said(seen, words) > 0
}

/// The keepalive of M113.
fn keepalive(seen: &Seen) -> u32 {
    let line = seen.line.said.iter().rfind(|line| line.contains("M113 S"));
    line.unwrap_or_else(|| panic!("{:?}", seen.line.said)).rsplit('S').next().unwrap().parse().unwrap()
}

/// Saves settings of these numbers one after the other.
fn saves(numbers: std::ops::Range<u32>) -> String {
    numbers.map(|n| format!("M113 S{n}\nM500\n")).collect()
}

#[test]
fn settings_are_kept_and_found_after_a_reset() {
    let first = talk(&FlashSectors::default(), "M503\nM113 S7\nM203 X250.5\nM500\nM504\nM115\n");
    assert_eq!(first.end, End::Done);
    assert!(says(&first, "echo:Settings Stored"), "{:?}", first.line.said);
    assert!(says(&first, "echo:stored settings valid") && says(&first, "Cap:EEPROM:1"));
    println!("{} words, {} erases", first.flash.operations.len(), first.flash.erases());
    let second = talk(&left(&first), "M113\nM503\nM500\n");
    println!("start {} us after reset, with settings", second.started.unwrap() / 1000);
    assert!(second.started.unwrap() < START_NS);
    assert!(says(&second, "echo:stored settings retrieved") && says(&second, "M203 X250.5"), "{:?}", second.line.said);
    assert_eq!(keepalive(&second), 7);
    assert_eq!(second.flash.operations, [], "what is stored already is not written again");
}

/// Code of another image in the sectors: they are erased, half a second each, in which the processor stands still. The watchdog
/// waits for it, and the board goes on.
#[test]
fn sectors_that_held_code_are_taken_over() {
    let mut state = 1_u32;
    let code = (0..0x8000).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    let before = FlashSectors::holding(code.collect());
    let seen = talk(&before, "M113 S7\nM500\nM113 S8\nM501\nM113\nG28 X\n");
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{:?}", seen.line.said);
    assert!(says(&seen, "echo:Settings Stored") && !seen.recorder.events.is_empty());
    let erased = [1, 2].map(|sector| seen.flash.operations.contains(&Operation::Erase { sector }));
    assert_eq!((erased, seen.laps.out_of_step, keepalive(&seen)), ([true, true], 0, 7), "{:?}", seen.line.said);
    println!("start {} us after reset, over code", seen.started.unwrap() / 1000);
    assert!(seen.started.unwrap() < START_NS);
}

/// What is stored after the power goes in an operation of the saves of `numbers`, counted from the last one that was told to be done: 0 or 1.
/// The board is switched on again, and saves once more. The log is cut in every operation on this computer
/// (`chips/stm32f446/tests/flash_pages.rs`).
fn cut(after: usize, tear: Tear, numbers: std::ops::Range<u32>) -> u32 {
    let mut flash = FlashSectors::default();
    flash.cut = Some(FlashCut { after, tear });
    let seen = talk(&flash, &saves(numbers));
    assert_eq!((seen.end, seen.flash.operations.len()), (End::PowerCut, after + 1), "{:?}", seen.line.said);
    let stored = seen.line.said.iter().filter(|line| line.starts_with("echo:Settings Stored")).count() as u32;
    let again = talk(&left(&seen), "M113\nM113 S59\nM500\nM501\nM113\n");
    println!("start {} us after reset, with what a cut has left", again.started.unwrap() / 1000);
    // A sector that is half erased is erased again.
    assert!(again.started.unwrap() < START_NS + again.flash.erases() as u64 * ERASE_NS);
    assert_eq!((again.end, keepalive(&again)), (End::Done, 59), "{:?}", again.line.said);
    let first = again.line.said.iter().find_map(|line| line.strip_prefix("echo:M113 S"));
    let kept: u32 = first.unwrap().parse().unwrap();
    assert!(kept == stored || kept == stored + 1, "{after} {tear:?}: {kept} after {stored}");
    kept - stored
}

/// Words that a save programs: of the first one also those that begin the log.
const WORDS: usize = 176;

#[test]
fn a_power_cut_while_a_word_is_programmed_leaves_the_old_or_the_new() {
    assert_eq!(cut(WORDS + WORDS / 2, Tear::Bits, 1..3), 0);
}

/// So many saves that the log goes round once, which costs an erase.
const SAVES: u32 = 28;

/// Reproducer: the save with which the log goes round kept the Console for seconds, which ended in the watchdog's reset.
#[test]
fn a_log_that_goes_round_keeps_nobody_waiting_and_survives_a_power_cut() {
    let seen = talk(&FlashSectors::default(), &saves(1..SAVES));
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{:?}", seen.line.said);
    let operations = &seen.flash.operations;
    println!("{} operations, {} erases, {} ms", operations.len(), seen.flash.erases(), seen.virtual_ns / MS);
    assert_eq!((said(&seen, "echo:Settings Stored"), seen.flash.erases()), (SAVES as usize - 1, 1));
    let erase = operations.iter().position(|operation| matches!(operation, Operation::Erase { .. })).unwrap();
    assert_eq!(cut(erase, Tear::Half, 1..SAVES), 0);
}
