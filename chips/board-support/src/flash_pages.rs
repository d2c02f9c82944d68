//! Pages of settings in the processor's flash: a sector for each of the core's two slots.
//!
//! The core writes its slots in turns, and never the slot that holds the newest settings (`corehbot::storage`). So a
//! save may erase the sector of its slot first, wherever a power cut hits it. The code need not judge whether an
//! earlier erase was complete: it erases every sector once in this run before it writes there (`flash_slot`).
//!
//! It costs an erase for each save, and wear. On the STM32F446 that is up to 0.5 s (datasheet, t_ERASE16KB at 32 bits)
//! and 10,000 erases a sector (N_END), so 20,000 saves. Several places in a sector would save erases; but a place that
//! a cut has left half programmed may read as blank, so they need judging again.
//!
//! The contract is narrower than the contract of an EEPROM. A slot is written from its last page to its first, as a
//! save does. A write that does not go down starts the slot again, and all its other pages are blank then. The very
//! last page, which the core writes at any time, lies elsewhere in the sector of slot B: its slot need not be erased
//! for it. When that sector is erased, the page is carried over; a power cut at that moment loses it.

use corehbot::port::StorageError;
use corehbot::storage::{NEEDED, PAGE, STRIDE};

use crate::flash_sectors::Sectors;
use crate::flash_slot::FlashSlot;
use crate::memory::Memory;

const _: () = assert!(NEEDED == 2 * STRIDE);

/// The page at the end, in which the core notes the last self-test.
const NOTE: u32 = NEEDED - PAGE as u32;

/// Memory of the size that the settings need, in flash.
pub struct FlashPages<F: Sectors> {
    flash: F,
    slots: [FlashSlot; 2],
}

/// A part of a page.
struct Place {
    /// Slot A or B: 0 or 1.
    slot: usize,
    /// Number of the page in its slot; `None` for the note.
    page: Option<usize>,
    /// Where in the page it begins.
    begin: usize,
}

impl Place {
    /// Where `size` bytes at `at` are.
    fn of(at: u32, size: usize) -> Result<Self, StorageError> {
        if at >= NEEDED {
            return Err(StorageError::Absent);
        }
        let begin = at as usize % PAGE;
        if begin + size > PAGE {
            return Err(StorageError::Failed);
        }
        let page = (at < NOTE).then_some((at % STRIDE) as usize / PAGE);
        Ok(Self { slot: (at / STRIDE) as usize, page, begin })
    }
}

impl<F: Sectors> FlashPages<F> {
    /// The pages in the sectors of `flash`. Reads 32 bytes of each sector, and its notes when one is asked for.
    pub fn new(mut flash: F) -> Self {
        let slots = F::SECTORS.map(|sector| FlashSlot::found(&mut flash, sector));
        Self { flash, slots }
    }

    /// The flash, as it is.
    pub fn into_flash(self) -> F {
        self.flash
    }
}

impl<F: Sectors> Memory for FlashPages<F> {
    fn capacity(&self) -> u32 {
        NEEDED
    }

    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        let Place { slot, page, begin } = Place::of(at, into.len())?;
        let slot = self.slots.get(slot).ok_or(StorageError::Absent)?;
        let page = match page {
            Some(number) => slot.page(&mut self.flash, number)?,
            None => slot.note(&mut self.flash)?,
        };
        into.iter_mut().zip(page.iter().skip(begin)).for_each(|(to, byte)| *to = *byte);
        Ok(())
    }

    /// Takes a millisecond, and up to 0.5 s more when it begins a slot. A partial write to a page of settings leaves
    /// the rest of that page blank; a partial write to the note keeps its rest.
    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let Place { slot, page, begin } = Place::of(at, bytes.len())?;
        let [a, b] = &mut self.slots;
        let (slot, other) = if slot == 0 { (a, b) } else { (b, a) };
        let mut new = if page.is_some() { [0xFF; PAGE] } else { slot.note(&mut self.flash)? };
        new.iter_mut().skip(begin).zip(bytes).for_each(|(to, byte)| *to = *byte);
        match page {
            Some(number) => slot.put_page(&mut self.flash, other, number, &new),
            None => slot.put_note(&mut self.flash, other, &new),
        }
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        Ok(true)
    }
}
