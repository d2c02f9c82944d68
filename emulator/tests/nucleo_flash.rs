//! Settings in the Nucleo's flash, by the driver of the image: its messages, and the state after a power cut.

use crate::common::{Bench, MS, nucleo_bench, nucleo_firmware, nucleo_machine, print_on};
use corehbot_emulator::flash::{FlashCut, FlashSectors, Operation, Tear};
use corehbot_emulator::line::Manner;
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;

/// A start takes 25 ms with slots.
const START_NS: u64 = 100 * MS;

/// To erase a sector at the most (STM32F446 datasheet, t_ERASE16KB at 32 bits).
const ERASE_NS: u64 = 500 * MS;

fn talk(flash: &FlashSectors, gcode: &str) -> Seen {
    talk_as(Manner::default(), flash, gcode)
}

fn talk_as(manner: Manner, flash: &FlashSectors, gcode: &str) -> Seen {
    let mut firmware = nucleo_firmware();
    firmware.put_machine(&mut nucleo_machine()).unwrap();
    let seen = print_on(&firmware, gcode, &Bench { manner, flash: flash.clone(), ..nucleo_bench() });
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

/// Code of another image in the sectors: each is erased when a save reaches it, half a second in which the processor
/// stands still. The watchdog waits for it, and the board continues.
#[test]
fn sectors_that_held_code_are_taken_over() {
    let mut state = 1_u32;
    let code = (0..0x8000).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    let before = FlashSectors::holding(code.collect());
    let seen = talk(&before, "M113 S6\nM500\nM113 S7\nM500\nM113 S8\nM501\nM113\nG28 X\n");
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{:?}", seen.line.said);
    assert!(says(&seen, "echo:Settings Stored") && !seen.recorder.events.is_empty());
    let erased = [1, 2].map(|sector| seen.flash.operations.contains(&Operation::Erase { sector }));
    assert_eq!((erased, seen.laps.out_of_step, keepalive(&seen)), ([true, true], 0, 7), "{:?}", seen.line.said);
    println!("start {} us after reset, over code", seen.started.unwrap() / 1000);
    assert!(seen.started.unwrap() < START_NS);
}

/// Words that a save programs about an erase: the marks that are made zero before it, the erase itself and the mark
/// after it (`chips/board-support/src/flash_slot.rs`).
const BEFORE_ERASE: usize = 8;

/// Each save erases the sector of its slot, and delays no host.
#[test]
fn each_save_erases_a_sector_and_keeps_nobody_waiting() {
    const SAVES: usize = 5;
    let seen = talk(&FlashSectors::default(), &format!("{}M122\nG28 X\n", saves(1..SAVES as u32 + 1)));
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{:?}", seen.line.said);
    assert_eq!((said(&seen, "echo:Settings Stored"), seen.flash.erases()), (SAVES, SAVES));
    assert_eq!((said(&seen, "Error:"), seen.laps.out_of_step), (0, 0), "{:?}", seen.line.said);
    let sectors = seen.flash.operations.iter().filter_map(|operation| match operation {
        Operation::Erase { sector } => Some(*sector),
        Operation::Program { .. } => None,
    });
    assert_eq!(sectors.collect::<Vec<_>>(), [1, 2, 1, 2, 1]);
    println!("{} operations, {} ms", seen.flash.operations.len(), seen.virtual_ns / MS);
}

/// A line holds 25,000 bytes a second. During the half second of an erase, a host that waits for its answers sends one
/// line. A host that counts them sends as much as the board reads ahead, 1,023 bytes. DMA keeps them until then.
#[test]
fn what_a_host_sends_while_a_sector_is_erased_is_heard() {
    const LINES: usize = 85;
    let ahead = "M114 ;23456\n".repeat(LINES);
    assert!((1000..1024).contains(&ahead.len()));
    let manner = Manner { is_impatient: true, ..Manner::default() };
    let seen = talk_as(manner, &FlashSectors::default(), &format!("M113 S7\nM500\n{ahead}"));
    assert_eq!((seen.end, seen.flash.erases()), (End::Done, 1), "{:?}", seen.line.said);
    assert_eq!((said(&seen, "Count"), said(&seen, "Error:")), (LINES, 0), "{:?}", seen.line.said);
}

/// The stored number after a power cut in an operation of the saves of `numbers`, counted from the last reported save:
/// 0 or 1. The board is switched on again, and saves once more. Host tests cut a save in every operation
/// (`chips/board-support/tests/flash_pages`).
fn cut(flash: &FlashSectors, after: usize, tear: Tear, numbers: std::ops::Range<u32>) -> u32 {
    let before = numbers.start - 1;
    let mut flash = flash.clone();
    flash.cut = Some(FlashCut { after, tear });
    let seen = talk(&flash, &saves(numbers));
    assert_eq!((seen.end, seen.flash.operations.len()), (End::PowerCut, after + 1), "{:?}", seen.line.said);
    let stored = before + said(&seen, "echo:Settings Stored") as u32;
    let again = talk(&left(&seen), "M113\nM113 S59\nM500\nM501\nM113\n");
    println!("start {} us after reset, with what a cut has left", again.started.unwrap() / 1000);
    assert!(again.started.unwrap() < START_NS, "no erase before the first save");
    assert_eq!((again.end, again.flash.erases(), keepalive(&again)), (End::Done, 1, 59), "{:?}", again.line.said);
    assert!(again.virtual_ns > ERASE_NS);
    let first = again.line.said.iter().find_map(|line| line.strip_prefix("echo:M113 S"));
    let kept: u32 = first.unwrap().parse().unwrap();
    assert!(kept == stored || kept == stored + 1, "{after} {tear:?}: {kept} after {stored}");
    kept - stored
}

/// The operations of a first save, in empty sectors, and of the next save.
fn operations_of_a_save() -> [usize; 2] {
    let count = |numbers| talk(&FlashSectors::default(), &saves(numbers)).flash.operations.len();
    let [one, two] = [count(1..2), count(1..3)];
    println!("{one} operations of the first save, {} of the second", two - one);
    [one, two - one]
}

/// Reproducer: erases that were cut so that both ends were erased, or the last alone, were not noticed by the log that
/// settings were kept in. All ways to tear a sector are tried on the host (`flash_pages` of the chip); here each costs
/// three seconds.
#[test]
fn a_power_cut_while_a_word_is_programmed_or_a_sector_erased_leaves_the_old_settings() {
    let [first, second] = operations_of_a_save();
    let blank = FlashSectors::default();
    assert_eq!(cut(&blank, first + second / 2, Tear::Bits, 1..3), 0);
    assert_eq!(cut(&blank, first + second - 1, Tear::Ends, 1..3), 0, "the last word of all");
    // The second save has made the mark of the first one firm before. The third erases a sector that holds a slot.
    let erase = first + second + (second - first) + BEFORE_ERASE;
    for tear in [Tear::Ends, Tear::SecondHalf, Tear::Anything] {
        assert_eq!(cut(&blank, erase, tear, 1..4), 0);
    }
}
