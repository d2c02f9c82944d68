//! The interface as the manual has it, by the chip's bus.

use super::*;
use crate::chip::Chip;
use crate::flash::SECTORS;
use rigless::emulator::{Access, AccessKind};
use rigless::mcu::Operate;

const KEYR: u64 = 0x4002_3C04;
const SR: u64 = 0x4002_3C0C;
const CR: u64 = 0x4002_3C10;
const KEYS: [u64; 2] = [0x4567_0123, 0xCDEF_89AB];

/// Bits of CR (RM0390 rev 6, section 3.8.5).
const PG: u64 = 1;
const SER: u64 = 2;
const WORDS: u64 = 2 << 8;
const STRT: u64 = 1 << 16;

/// Flags of SR (section 3.8.4).
const WRPERR: u64 = 1 << 4;
const PGAERR: u64 = 1 << 5;
const PGPERR: u64 = 1 << 6;
const PGSERR: u64 = 1 << 7;
const BSY: u64 = 1 << 16;

const AT: VirtualNanos = VirtualNanos(1000);

fn chip() -> Chip {
    let mut chip = Chip::new().unwrap();
    chip.keep_settings(FlashSectors::default()).unwrap();
    // The emulator has its memory map.
    rigless::mcu::Mcu::poll(&mut chip, VirtualNanos(1));
    chip
}

fn unlocked() -> Chip {
    let mut chip = chip();
    for key in KEYS {
        chip.write(AT, KEYR, Width::W32, key).unwrap();
    }
    chip
}

fn store(chip: &mut Chip, address: u64, width: Width) {
    chip.store_to_flash(&Access::new(AccessKind::Write, address, width, 0).at(0, AT));
}

fn status(chip: &mut Chip) -> u64 {
    chip.read(AT, SR, Width::W32).unwrap()
}

#[test]
fn a_store_is_refused_for_the_reason_that_the_manual_has() {
    let first = SECTORS.start;
    for (control, address, width, flag) in [
        (WORDS, first, Width::W32, PGSERR),
        (WORDS | PG | SER, first, Width::W32, PGSERR),
        (WORDS | PG, first, Width::W16, PGPERR),
        (PG, first, Width::W32, PGPERR),
        (WORDS | PG, first + 14, Width::W32, PGAERR),
    ] {
        let mut chip = unlocked();
        chip.write(AT, CR, Width::W32, control).unwrap();
        store(&mut chip, address, width);
        assert_eq!(status(&mut chip), flag, "{control:#x} {address:#x}");
        assert!(chip.flash.as_ref().unwrap().sectors.operations.is_empty());
        // Ones take flags back.
        chip.write(AT, SR, Width::W32, flag).unwrap();
        assert_eq!(status(&mut chip), 0);
    }
}

#[test]
fn without_the_keys_nothing_is_programmed() {
    let mut chip = chip();
    chip.write(AT, CR, Width::W32, WORDS | PG).unwrap();
    store(&mut chip, SECTORS.start, Width::W32);
    assert_eq!(status(&mut chip), PGSERR);
    // A wrong key, and the register is locked until the next reset.
    for key in [KEYS[1], KEYS[0], KEYS[1]] {
        chip.write(AT, KEYR, Width::W32, key).unwrap();
    }
    assert_ne!(chip.read(AT, CR, Width::W32).unwrap() & 1 << 31, 0);
}

#[test]
fn a_protected_sector_is_left_alone() {
    let mut chip = unlocked();
    chip.write(AT, CR, Width::W32, WORDS | PG).unwrap();
    let slot = rigless::mcu::Mcu::bus(&*chip).slot_of("FLASH").unwrap();
    let registers = rigless::mcu::Mcu::bus_mut(&mut *chip).slot_mut(slot).registers_mut();
    registers.set(Register::Optcr, registers.get(Register::Optcr) & !(1 << (16 + 2)));
    store(&mut chip, SECTORS.start + 0x4000, Width::W32);
    assert_eq!(status(&mut chip), WRPERR);
    chip.write(AT, SR, Width::W32, WRPERR).unwrap();
    store(&mut chip, SECTORS.start, Width::W32);
    assert_eq!(status(&mut chip), BSY);
}

#[test]
fn busy_ends_when_the_word_is_there() {
    let mut chip = unlocked();
    chip.write(AT, CR, Width::W32, WORDS | PG).unwrap();
    store(&mut chip, SECTORS.start + 4, Width::W32);
    let flash = chip.flash.as_mut().unwrap();
    assert_eq!((flash.next(), flash.is_holding()), (Some(AT.0 + PROGRAM_NS), false));
    flash.advance(VirtualNanos(AT.0 + PROGRAM_NS - 1));
    assert_eq!(flash.take_changes(), []);
    flash.advance(VirtualNanos(AT.0 + PROGRAM_NS));
    assert_eq!((flash.take_changes(), flash.next()), (vec![(SECTORS.start + 4, 0)], None));
    assert_eq!(status(&mut chip), 0);
    // Another store, or a write to CR, has to wait for that.
    store(&mut chip, SECTORS.start, Width::W32);
    store(&mut chip, SECTORS.start, Width::W32);
    chip.write(AT, CR, Width::W32, 0).unwrap();
    assert_eq!(chip.flash.as_ref().unwrap().sectors.faults.len(), 2);
}

#[test]
fn an_erase_holds_the_processor_for_the_longest_time() {
    let mut chip = unlocked();
    let erase = WORDS | SER | 2 << 3;
    chip.write(AT, CR, Width::W32, erase).unwrap();
    chip.write(AT, CR, Width::W32, erase | STRT).unwrap();
    assert_eq!(status(&mut chip), BSY);
    let flash = chip.flash.as_mut().unwrap();
    assert_eq!((flash.next(), flash.is_holding()), (Some(AT.0 + 500_000_000), true));
    flash.advance(VirtualNanos(AT.0 + 500_000_000));
    assert_eq!((flash.take_changes().len(), flash.is_holding()), (4096, false));
    assert_eq!(flash.sectors.operations, [Operation::Erase { sector: 2 }]);
}

/// A reset in the middle of it leaves neither the old word nor the new one.
#[test]
fn a_reset_while_a_word_is_programmed_leaves_a_mixture() {
    let mut chip = unlocked();
    chip.write(AT, CR, Width::W32, WORDS | PG).unwrap();
    store(&mut chip, SECTORS.start, Width::W32);
    let flash = chip.flash.as_mut().unwrap();
    flash.restarted();
    assert_eq!((flash.take_changes(), flash.next()), (vec![(SECTORS.start, 0x5A5A_5A5A)], None));
}
