//! The EEPROM: AT24C32, 4 KiB in pages of 32 bytes.

use corehbot::port::StorageError;
use corehbot::units::Instant;
use static_cell::StaticCell;

use crate::bus::{Answer, Bus};
use crate::time;
use crate::wiring::Board;
use corehbot_board_support::memory::Memory;

/// A0 to A2 lie on ground (BTT's schematic), and the type's address is 1010 (AT24C32E datasheet 8905F, 7).
const ADDRESS: u8 = 0x50;

/// 4,096 bytes (AT24C32E datasheet 8905F).
const SIZE: u32 = 4096;

/// Pages of 32 bytes, within which a write goes round (AT24C32E datasheet 8905F, 8.2).
const PAGE: u32 = 32;
const _: () = assert!(PAGE as usize == corehbot::storage::PAGE);

/// A page write ends within 5 ms (AT24C32E datasheet 8905F, t_WR), and within 10 ms on older members of the family
/// (0336K). The longer limit is harmless: no caller is in a hurry.
const WRITING_MS: u32 = 20;

/// The EEPROM.
pub struct Eeprom {
    bus: Bus,
    /// When a page was handed over that may not be written yet.
    handed_over: Option<Instant>,
}

/// The EEPROM of `board`, for the `main` function of that board.
pub fn eeprom(board: &'static Board) -> &'static mut dyn Memory {
    static EEPROM: StaticCell<Option<Eeprom>> = StaticCell::new();
    let bus = board.eeprom.map(|[scl, sda]| Bus::new(scl, sda));
    EEPROM.init(bus.map(|bus| Eeprom { bus, handed_over: None }))
}

/// Address `at`, if `size` bytes are there.
fn head(at: u32, size: usize) -> Result<[u8; 2], StorageError> {
    let fits = u32::try_from(size).is_ok_and(|size| at < SIZE && size <= SIZE - at);
    if fits { Ok((at as u16).to_be_bytes()) } else { Err(StorageError::Absent) }
}

const fn here(answer: Answer) -> Result<(), StorageError> {
    match answer {
        Answer::Here => Ok(()),
        Answer::Nothing => Err(StorageError::Failed),
    }
}

impl Eeprom {
    /// Waits for the last page write, unless a caller has waited for it already.
    fn finish(&mut self) -> Result<(), StorageError> {
        while !self.is_done()? {}
        Ok(())
    }
}

impl Memory for Eeprom {
    fn capacity(&self) -> u32 {
        SIZE
    }

    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        let head = head(at, into.len())?;
        self.finish()?;
        here(self.bus.read(ADDRESS, head, into)?)
    }

    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let head = head(at, bytes.len())?;
        if at % PAGE + bytes.len() as u32 > PAGE {
            return Err(StorageError::Failed);
        }
        self.finish()?;
        here(self.bus.write(ADDRESS, head.iter().chain(bytes))?)?;
        self.handed_over = Some(time::now());
        Ok(())
    }

    /// The chip does not answer to its address while it writes (AT24C32E datasheet 8905F, 8.3).
    fn is_done(&mut self) -> Result<bool, StorageError> {
        let Some(since) = self.handed_over else { return Ok(true) };
        let is_late = time::now() > since.after_ms(WRITING_MS);
        if self.bus.write(ADDRESS, [].iter())? == Answer::Here {
            self.handed_over = None;
            return Ok(true);
        }
        if is_late {
            self.handed_over = None;
            return Err(StorageError::Failed);
        }
        Ok(false)
    }
}
