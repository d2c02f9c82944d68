//! The processor's flash as memory for settings: sectors 1 and 2.
//!
//! This uses registers and not embassy-stm32's driver, which erases without regard to the watchdog. While a sector is
//! erased the processor cannot fetch instructions and stands still. That takes up to 0.5 s (STM32F446 datasheet,
//! t_ERASE16KB at 32 bits), and the watchdog resets after 0.34 s. So the watchdog gets a longer period for that time,
//! and the Console's clock stands still.
//!
//! Motors rest when settings are saved, and drivers hold on their own. Heaters go off by themselves: their timer ends
//! the current pulse (`heater_timer`), and no control period starts another while the processor stands still. Besides,
//! no board that keeps its settings in flash has heaters. Commands are heard again afterwards: DMA keeps the last 2,048
//! bytes.

use core::ops::Range;

use corehbot::port::StorageError;
use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::regs::Sr;
use embassy_stm32::pac::flash::vals::Psize;
use static_cell::StaticCell;

use crate::time;
use crate::watchdog;
use crate::wiring::Board;
use corehbot_board_support::flash_pages::FlashPages;
use corehbot_board_support::flash_sectors::Sectors;
use corehbot_board_support::memory::Memory;

/// The sectors for settings: 1 and 2 (RM0390, 3.3), by their distance from the begin of flash. The vectors stay in
/// sector 0, where the processor expects them, and the code begins after them (`settings.x` of the board).
const SECTORS: Range<u32> = 0x4000..0xC000;

/// Bytes of one of them.
const SECTOR: u32 = 0x4000;

/// Bytes that are programmed at a time.
const WORD: u32 = 4;

/// Where flash begins for the processor (RM0390, 2.2.2).
const BASE: u32 = 0x0800_0000;

/// The keys that open the control register, in this order (RM0390, 3.5.1).
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// Polls of the status before an operation is given up. A word takes at most 100 us (STM32F446 datasheet, t_prog) and a
/// sector 0.5 s. A poll takes 7 to 20 cycles of 180 MHz if the loop is in the instruction cache, so the limit is 0.8 to
/// 2.2 s. Otherwise the processor stands still until the operation is done.
const LOOKS: u32 = 20_000_000;

// SAFETY: the linker script of cortex-m-rt defines the symbol; only its address is taken.
unsafe extern "C" {
    /// Where the code begins (cortex-m-rt).
    safe static _stext: u8;
}

/// The memory in flash, for the `main` function of a board with an image that leaves it free.
pub fn flash(_board: &'static Board) -> &'static mut dyn Memory {
    static PAGES: StaticCell<Option<FlashPages<Flash>>> = StaticCell::new();
    // An image that lies elsewhere has something else in these sectors: itself, or a bootloader.
    let is_free = (&raw const _stext) as u32 == BASE + SECTORS.end;
    PAGES.init(is_free.then(|| FlashPages::new(Flash)))
}

/// The sectors put aside, by their distance from the begin of flash.
pub struct Flash;

/// Whether `size` bytes at `at` are ours.
fn check(at: u32, size: usize) -> Result<(), StorageError> {
    let end = u32::try_from(size).ok().and_then(|size| at.checked_add(size));
    let is_ours = at >= SECTORS.start && end.is_some_and(|end| end <= SECTORS.end);
    if is_ours { Ok(()) } else { Err(StorageError::Failed) }
}

impl Sectors for Flash {
    const SECTORS: [u32; 2] = [SECTORS.start, SECTORS.start + SECTOR];
    const SECTOR: u32 = SECTOR;
    const WORD: u32 = WORD;

    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        check(at, into.len())?;
        for (byte, address) in into.iter_mut().zip(BASE + at..) {
            // SAFETY: the address was checked to lie in the sectors, which are readable; any byte is a legal u8. No
            // reference to them exists, so no code relies on their content.
            *byte = unsafe { core::ptr::read_volatile(address as *const u8) };
        }
        Ok(())
    }

    fn program(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        check(at, bytes.len())?;
        let (words, rest) = bytes.as_chunks();
        if !at.is_multiple_of(WORD) || !rest.is_empty() {
            return Err(StorageError::Failed);
        }
        operate(|| {
            FLASH.cr().write(|w| {
                w.set_psize(Psize::PSIZE32);
                w.set_pg(true);
            });
            for (word, address) in words.iter().zip((BASE + at..).step_by(WORD as usize)) {
                // SAFETY: the address was checked to be aligned and to lie in the sectors, where no code and no
                // variable is (`flash` and check test it). Volatile, because the write itself programs the word.
                unsafe { core::ptr::write_volatile(address as *mut u32, u32::from_le_bytes(*word)) };
                finish()?;
            }
            Ok(())
        })
    }

    fn erase(&mut self, at: u32) -> Result<(), StorageError> {
        check(at, SECTOR as usize)?;
        if !at.is_multiple_of(SECTOR) {
            return Err(StorageError::Failed);
        }
        watchdog::stretch();
        let erase = || {
            FLASH.cr().write(|w| {
                w.set_psize(Psize::PSIZE32);
                w.set_ser(true);
                // The sectors before it are of the same size (RM0390, 3.3).
                w.set_snb((at / SECTOR) as u8);
            });
            FLASH.cr().modify(|w| w.set_strt(true));
            finish()
        };
        let result = time::without_time(|| operate(erase));
        watchdog::restore();
        result
    }
}

/// Opens the control register for one operation and discards cached reads: the data cache does not see that flash has
/// changed (RM0390, 3.4.2).
fn operate(operation: impl FnOnce() -> Result<(), StorageError>) -> Result<(), StorageError> {
    // The keys, written to a register that is unlocked already, lock it until the next reset; a debugger may have left
    // it unlocked.
    if FLASH.cr().read().lock() {
        KEYS.iter().for_each(|key| FLASH.keyr().write_value(*key));
    }
    FLASH.sr().write_value(flags());
    FLASH.acr().modify(|w| w.set_dcen(false));
    let result = operation();
    FLASH.cr().write(|w| w.set_lock(true));
    FLASH.acr().modify(|w| w.set_dcrst(true));
    FLASH.acr().modify(|w| w.set_dcrst(false));
    FLASH.acr().modify(|w| w.set_dcen(true));
    result
}

/// Waits for the end of the current operation.
fn finish() -> Result<(), StorageError> {
    cortex_m::asm::dsb();
    if (0..LOOKS).any(|_| !FLASH.sr().read().bsy()) && FLASH.sr().read().0 & flags().0 == 0 {
        Ok(())
    } else {
        Err(StorageError::Failed)
    }
}

/// Error flags; writing 1 clears them (RM0390, 3.8.4).
fn flags() -> Sr {
    let mut flags = Sr(0);
    flags.set_operr(true);
    flags.set_wrperr(true);
    flags.set_pgaerr(true);
    flags.set_pgperr(true);
    flags.set_pgserr(true);
    flags
}
