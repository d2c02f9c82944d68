//! Settings in flash whose power can be cut in any operation: the old or the new ones survive.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use corehbot::port::{Storage, StorageError};
use corehbot::settings::Settings;
use corehbot::storage::{self, NEEDED, SaveError};
use corehbot_stm32f446::flash_pages::{FlashPages, SECTOR, SECTORS};
use corehbot_stm32f446::memory::Memory;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use std::cell::Cell;
use std::pin::pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};

/// Flash that programs a word or erases a sector in one operation, until its power goes.
#[derive(Clone)]
struct Nor {
    cells: Vec<u8>,
    /// Operations that are still done.
    left: usize,
    tear: Tear,
    operations: usize,
    erases: usize,
    /// Operations before the last erase.
    erased_at: usize,
    /// Bytes read, counted for all its clones.
    reads: Rc<Cell<usize>>,
}

/// What is left of an operation in which the power goes.
#[derive(Clone, Copy, Debug)]
enum Tear {
    /// Nothing has happened yet.
    Not,
    /// Some bits have changed.
    Bits,
    /// The first half is done.
    Half,
}

const TEARS: [Tear; 3] = [Tear::Not, Tear::Bits, Tear::Half];

#[derive(Debug)]
struct Dead;

impl NorFlashError for Dead {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Nor {
    type Error = Dead;
}

impl Nor {
    fn holding(cells: Vec<u8>) -> Self {
        Self { cells, left: usize::MAX, tear: Tear::Not, operations: 0, erases: 0, erased_at: 0, reads: Rc::default() }
    }

    fn blank() -> Self {
        Self::holding(vec![0xFF; SECTORS.end as usize])
    }

    /// With power again.
    fn revived(self) -> Self {
        Self::holding(self.cells)
    }

    /// Changes the cells from `at` on.
    fn operate(&mut self, at: usize, new: &[u8]) -> Result<(), Dead> {
        let cells = &mut self.cells[at..at + new.len()];
        if self.left > 0 {
            self.left -= 1;
            self.operations += 1;
            cells.copy_from_slice(new);
            return Ok(());
        }
        let half = new.len() / 2;
        for (i, (cell, new)) in cells.iter_mut().zip(new).enumerate() {
            match self.tear {
                Tear::Bits => *cell = *cell & 0x5A | new & 0xA5,
                Tear::Half if i < half => *cell = *new,
                Tear::Half | Tear::Not => {}
            }
        }
        // Whatever follows is not done either.
        self.tear = Tear::Not;
        Err(Dead)
    }
}

impl ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), Dead> {
        self.reads.update(|reads| reads + into.len());
        into.copy_from_slice(&self.cells[at as usize..][..into.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.cells.len()
    }
}

impl NorFlash for Nor {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR as usize;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Dead> {
        assert!(from >= SECTORS.start && to <= SECTORS.end && from.is_multiple_of(SECTOR) && to.is_multiple_of(SECTOR));
        for at in (from..to).step_by(SECTOR as usize) {
            self.erases += 1;
            self.erased_at = self.operations;
            self.operate(at as usize, &[0xFF; SECTOR as usize])?;
        }
        Ok(())
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), Dead> {
        let end = at + bytes.len() as u32;
        assert!(at >= SECTORS.start && end <= SECTORS.end && at.is_multiple_of(4) && end.is_multiple_of(4));
        for (i, word) in bytes.chunks(4).enumerate() {
            let at = at as usize + 4 * i;
            // Programming clears bits and sets none.
            let new: Vec<u8> = word.iter().zip(&self.cells[at..]).map(|(new, old)| new & old).collect();
            self.operate(at, &new)?;
        }
        Ok(())
    }
}

fn now<F: Future>(future: F) -> F::Output {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => result,
        Poll::Pending => panic!("it waits"),
    }
}

fn variant(n: u16) -> Settings {
    let mut s = Settings::prototype();
    s.keepalive_s = (n % 60) as u8;
    s.motor_max_speed += corehbot::units::MmPerSec::from_num(n);
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

/// Cuts a save of `settings` in every operation; what is there then is the old or the new, and can be saved over.
fn cut_everywhere(
    flash: &Nor,
    settings: &Settings,
    operations: usize,
    tears: impl Fn(usize) -> Vec<Tear>,
) -> [usize; 2] {
    let (old, _) = newest(flash.clone());
    let mut found = [0; 2];
    for left in 0..operations {
        for tear in tears(left) {
            let mut cut = flash.clone();
            (cut.left, cut.tear) = (left, tear);
            let (is_saved, cut) = save(cut, settings);
            assert!(!is_saved, "{left} {tear:?}");
            let (kept, cut) = newest(cut.revived());
            assert!(kept == old || kept == Some(*settings), "{left} {tear:?}: neither old nor new");
            found[usize::from(kept != old)] += 1;
            let (is_saved, cut) = save(cut, settings);
            assert!(is_saved && newest(cut).0 == Some(*settings), "{left} {tear:?}: saving again");
        }
    }
    found
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
        now(storage.write(64, &[1, 2, 3])).unwrap();
        now(storage.write(70, &[4])).unwrap();
        now(storage.write(NEEDED - 32, &[9; 32])).unwrap();
    });
    with(flash.revived(), |storage| {
        let mut bytes = [0; 8];
        now(storage.read(64, &mut bytes)).unwrap();
        assert_eq!(bytes, [1, 2, 3, 0xFF, 0xFF, 0xFF, 4, 0xFF]);
        now(storage.read(NEEDED - 8, &mut bytes)).unwrap();
        assert_eq!(bytes, [9; 8]);
        assert_eq!(now(storage.read(NEEDED, &mut bytes)), Err(StorageError::Absent));
        assert_eq!(now(storage.write(30, &bytes)), Err(StorageError::Failed));
    });
}

#[test]
fn a_cut_in_any_operation_leaves_the_old_or_the_new() {
    let mut flash = Nor::blank();
    for n in 0..3 {
        let (_, whole) = save(flash.clone(), &variant(n));
        let found = cut_everywhere(&flash, &variant(n), whole.operations, |_| TEARS.to_vec());
        println!("save {n}: {} operations, old and new after the cut {found:?}", whole.operations);
        flash = whole.revived();
    }
}

/// The log goes round: the other sector takes what still counts, and the first one is erased. Each operation is torn
/// another way in each of three rounds, and those about the erase in all ways.
#[test]
fn a_cut_while_a_sector_is_erased_leaves_the_old_or_the_new() {
    let mut flash = Nor::blank();
    let (mut turns, mut saves) = (0, 0);
    while turns < 3 {
        let (is_saved, whole) = save(flash.clone(), &variant(saves));
        assert!(is_saved);
        if whole.erases > 0 {
            let found = cut_everywhere(&flash, &variant(saves), whole.operations, |left| {
                match left.abs_diff(whole.erased_at) {
                    0..=3 => TEARS.to_vec(),
                    _ => vec![TEARS[(left + turns) % 3]],
                }
            });
            println!("save {saves}: {} operations, {} of them erasing, {found:?}", whole.operations, whole.erases);
            turns += 1;
        }
        flash = whole.revived();
        saves += 1;
        assert!(saves < 400);
    }
    assert!(saves > 60, "{saves} saves wear three sectors");
}

/// Reproducer: when the log went round, each of its 300 items was looked for among all others within one write of a page, 6 MB
/// were read, and the board ended in a fault because its Console was silent. A byte costs 0.4 us there (in the emulator), and the Console has 0.2 s.
#[test]
fn a_log_that_goes_round_is_not_looked_through_for_each_of_its_items() {
    const MOST: usize = 100_000;
    let flash = Nor::blank();
    let reads = Rc::clone(&flash.reads);
    let mut pages = FlashPages::new(flash);
    let mut most = 0;
    for n in 0..1500_u32 {
        let at = n * 7 % 40 * 32;
        reads.set(0);
        pages.write(at, &n.to_le_bytes()).unwrap();
        most = most.max(reads.get());
    }
    let flash = pages.into_flash();
    println!("{most} bytes at most, {} erases", flash.erases);
    assert!(most < MOST && flash.erases >= 3, "{most} bytes, {} erases", flash.erases);
    // All pages are found once, and are what was written last.
    reads.set(0);
    let mut pages = FlashPages::new(flash);
    println!("{} bytes to find all pages", reads.get());
    for n in 1460..1500_u32 {
        let mut read = [0; 4];
        pages.read(n * 7 % 40 * 32, &mut read).unwrap();
        assert_eq!(read, n.to_le_bytes());
    }
}

/// The board comes back, is cut again in the repair or the save, and so on.
#[test]
fn cuts_may_follow_each_other() {
    let mut flash = Nor::blank();
    let mut kept = None;
    for n in 0..240_u16 {
        let wanted = variant(n);
        (flash.left, flash.tear) = (usize::from(n) * 37 % 90, TEARS[usize::from(n) % 3]);
        let (is_saved, cut) = save(flash, &wanted);
        let (found, revived) = newest(cut.revived());
        assert!(found == Some(wanted) || !is_saved && found == kept, "save {n}");
        kept = found;
        flash = revived.revived();
    }
}

#[test]
fn sectors_that_held_code_are_taken_over() {
    let mut state = 1_u32;
    let code = (0..SECTORS.end).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    let (found, flash) = newest(Nor::holding(code.collect()));
    assert_eq!(found, None);
    let (is_saved, flash) = save(flash, &variant(4));
    assert!(is_saved && newest(flash.revived()).0 == Some(variant(4)));
}

#[test]
fn flash_that_does_not_work_is_reported() {
    let mut dead = Nor::blank();
    dead.left = 0;
    let (result, _) = with(dead, |storage| now(storage::save(storage, &variant(1))));
    assert_eq!(result, Err(SaveError::Storage(StorageError::Failed)));
    let mut pages = FlashPages::new(Nor::blank());
    assert_eq!(pages.is_done(), Ok(true));
}
