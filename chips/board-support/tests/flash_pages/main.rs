//! Settings in flash with power cuts in any operation: the old or the new settings survive.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod cuts;
mod histories;
mod nor;
mod notes;
mod random;

use corehbot::port::{Storage, StorageError};
use corehbot::settings::Settings;
use corehbot::storage::{self, NEEDED, STRIDE, SaveError};
use corehbot_board_support::flash_pages::FlashPages;
use corehbot_board_support::flash_sectors::Sectors;
use corehbot_board_support::memory::Memory;
use embassy_futures::block_on as now;
use nor::Nor;
use std::rc::Rc;

fn variant(n: u16) -> Settings {
    let mut s = Settings::prototype();
    s.keepalive_s = (n % 60) as u8;
    s.motor_max_speed += corehbot::units::MmPerSec::from_num(n % 600);
    // Their records are not all of the same length.
    s.belt.is_closed = n.is_multiple_of(3);
    s.check().unwrap();
    s
}

/// The memory as the core sees it.
struct Port(FlashPages<Nor>);

impl Storage for Port {
    fn capacity(&self) -> u32 {
        self.0.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.0.read(at, into)
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.0.write(at, bytes)
    }
}

/// Lets `act` use a memory in `flash`, and gives the flash back.
fn with<R>(flash: Nor, act: impl FnOnce(&mut Port) -> R) -> (R, Nor) {
    let mut port = Port(FlashPages::new(flash));
    let result = act(&mut port);
    (result, port.0.into_flash())
}

fn newest(flash: Nor) -> (Option<Settings>, Nor) {
    with(flash, |storage| now(storage::survey(storage)).unwrap().newest.map(|stored| stored.settings))
}

fn save(flash: Nor, settings: &Settings) -> (bool, Nor) {
    let (result, flash) = with(flash, |storage| now(storage::save(storage, settings)));
    (result.is_ok(), flash)
}

#[test]
fn what_was_written_is_read() {
    let (_, flash) = with(Nor::blank(), |storage| {
        assert_eq!(storage.capacity(), NEEDED);
        let mut bytes = [0; 32];
        for at in (0..NEEDED).step_by(32) {
            now(storage.read(at, &mut bytes)).unwrap();
            assert_eq!(bytes, [0xFF; 32]);
        }
        now(storage.write(STRIDE + 64, &[1, 2, 3])).unwrap();
        now(storage.write(STRIDE + 38, &[4])).unwrap();
        now(storage.write(STRIDE, &[5; 32])).unwrap();
        now(storage.write(NEEDED - 32, &[9; 32])).unwrap();
        now(storage.write(NEEDED - 32, &[8])).unwrap();
    });
    assert_eq!(flash.erases, [0x8000], "a slot is in its own sector");
    with(flash.revived(), |storage| {
        let mut bytes = [0; 8];
        for (at, holds) in [
            (64, [1, 2, 3, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),
            (32, [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 4, 0xFF]),
            (24, [5; 8]),
            (STRIDE - 32, [8, 9, 9, 9, 9, 9, 9, 9]),
        ] {
            now(storage.read(STRIDE + at, &mut bytes)).unwrap();
            assert_eq!(bytes, holds, "{at}");
        }
        assert_eq!(now(storage.read(NEEDED, &mut bytes)), Err(StorageError::Absent));
        assert_eq!(now(storage.write(NEEDED, &bytes)), Err(StorageError::Absent));
        assert_eq!(now(storage.write(30, &bytes)), Err(StorageError::Failed));
    });
}

/// A save writes downwards, so another one begins with a page that does not lie below the last.
#[test]
fn a_page_that_does_not_lie_below_the_last_begins_its_slot_anew() {
    let read = |storage: &mut Port, at| {
        let mut bytes = [0; 32];
        now(storage.read(at, &mut bytes)).unwrap();
        bytes
    };
    let (_, flash) = with(Nor::blank(), |storage| {
        now(storage.write(STRIDE, &[1; 32])).unwrap();
        for (second, first) in [(64, 96), (64, 64), (96, 64)] {
            now(storage.write(first, &[2; 32])).unwrap();
            now(storage.write(second, &[3; 32])).unwrap();
            let is_below = second < first;
            assert_eq!(read(storage, second), [3; 32]);
            assert!(first == second || read(storage, first) == [if is_below { 2 } else { 0xFF }; 32]);
            now(storage.write(0, &[4; 32])).unwrap();
        }
        assert_eq!(read(storage, STRIDE), [1; 32], "the other slot");
    });
    assert_eq!(flash.erases, [0x8000, 0x4000, 0x4000, 0x4000, 0x4000, 0x4000]);
}

/// One erase for each save, and so 20,000 saves by the datasheet; no erase for a save of unchanged settings.
#[test]
fn a_save_erases_the_sector_of_its_slot_once() {
    let mut flash = Nor::blank();
    for n in 0..6 {
        let (is_saved, whole) = save(flash, &variant(n));
        assert!(is_saved);
        assert_eq!(whole.erases, [[0x4000, 0x8000][usize::from(n % 2)]], "save {n}");
        let (is_saved, again) = save(whole.revived(), &variant(n));
        assert!(is_saved && again.operations == 0);
        flash = again.revived();
    }
    // Without a start in between.
    let (_, flash) = with(flash, |storage| (6..9).for_each(|n| _ = now(storage::save(storage, &variant(n))).unwrap()));
    assert_eq!(flash.erases, [0x4000, 0x8000, 0x4000]);
}

/// A byte costs 0.4 us on the board (in the emulator), and the Console has 0.2 s for a page.
#[test]
fn little_is_read_for_a_page() {
    const MOST: usize = 100_000;
    let flash = Nor::code();
    let reads = Rc::clone(&flash.reads);
    let mut pages = FlashPages::new(flash);
    assert!(reads.get() < MOST, "{} bytes at the start", reads.get());
    let mut most = 0;
    for n in 0..3000_u32 {
        let at = (NEEDED - 32) - n * 32 % NEEDED;
        reads.set(0);
        pages.write(at, &n.to_le_bytes()).unwrap();
        pages.read(at, &mut [0; 4]).unwrap();
        most = most.max(reads.get());
    }
    println!("{most} bytes at most");
    assert!(most < MOST / 10);
}

#[test]
fn sectors_that_held_code_are_taken_over() {
    let (found, mut flash) = newest(Nor::code());
    assert_eq!(found, None);
    for n in 4..6 {
        let (is_saved, whole) = save(flash.revived(), &variant(n));
        assert!(is_saved && whole.erases.len() == 1);
        let (found, whole) = newest(whole.revived());
        assert_eq!(found, Some(variant(n)));
        flash = whole;
    }
}

#[test]
fn flash_that_does_not_work_is_reported() {
    let dead = Nor::blank().cut(0, nor::Tear::Not);
    let (result, _) = with(dead, |storage| now(storage::save(storage, &variant(1))));
    assert_eq!(result, Err(SaveError::Storage(StorageError::Failed)));
    let mut pages = FlashPages::new(Nor::blank());
    assert_eq!(pages.is_done(), Ok(true));
}

/// Flash that can be changed and not be read.
struct Unreadable(usize);

impl Sectors for Unreadable {
    const SECTORS: [u32; 2] = Nor::SECTORS;
    const SECTOR: u32 = Nor::SECTOR;
    const WORD: u32 = Nor::WORD;

    fn read(&mut self, _at: u32, _into: &mut [u8]) -> Result<(), StorageError> {
        Err(StorageError::Failed)
    }

    fn program(&mut self, _at: u32, _bytes: &[u8]) -> Result<(), StorageError> {
        self.0 += 1;
        Ok(())
    }

    fn erase(&mut self, _at: u32) -> Result<(), StorageError> {
        self.0 += 1;
        Ok(())
    }
}

/// An unreadable sector may hold data that an erase would lose.
#[test]
fn what_cannot_be_read_is_not_erased() {
    let mut pages = FlashPages::new(Unreadable(0));
    for at in [0, STRIDE, NEEDED - 32] {
        assert_eq!(pages.write(at, &[1; 8]), Err(StorageError::Failed), "{at}");
    }
    assert_eq!(pages.read(0, &mut [0; 8]), Err(StorageError::Failed));
    assert_eq!(pages.into_flash().0, 0);
}
