//! A slot of settings in a sector of flash.
//!
//! | bytes | content | programmed when |
//! |---|---|---|
//! | 0..16 | [`ERASED`] | the erase is done, and the note is back |
//! | 16..32 | [`WHOLE`] | page 0 is there, which a save writes last |
//! | 32.. | the pages | |
//! | 4096.. | notes, one behind the other; the last counts | |
//!
//! Both marks are made zero before the next erase. Cells may read as ones now and as zeros later if their erase or
//! programming was cut. So the code trusts no operation that may have been cut:
//!
//! - A cut erase leaves no `ERASED`, except by a chance of one in 2^128. The sector counts as empty and is erased again
//!   before it is written.
//! - A cut page leaves no `WHOLE`: the pages count as blank, whatever they read as.
//! - A cut write of `WHOLE` leaves the whole record and a mark that may read as set or not. The mark is programmed
//!   again before the other slot's sector is erased.
//! - A cut zeroing of the marks leaves the previous record, seen or not; the other slot holds a newer one.

use corehbot::port::StorageError;
use corehbot::storage::{PAGE, STRIDE};

use crate::flash_sectors::Sectors;

/// Its erase is done. No vector table begins so.
const ERASED: [u8; 16] = *b"corehbot slot V1";

/// Its record is whole.
const WHOLE: [u8; 16] = *b"is all written. ";
const WHOLE_AT: u32 = 16;

/// Where the pages lie, and how many there are.
const PAGES_AT: u32 = 32;
const PAGES: usize = STRIDE as usize / PAGE;

/// Where the notes lie, and how many there is room for. A slot that has been full of them since its last save takes no
/// more of them, which costs a self-test at each start.
const NOTES_AT: u32 = 0x1000;
const NOTES: u32 = 64;

/// A page that was never written.
const BLANK: [u8; PAGE] = [0xFF; PAGE];

const _: () = assert!(WHOLE_AT as usize + WHOLE.len() <= PAGES_AT as usize && PAGES_AT + STRIDE <= NOTES_AT);

/// Whether a slot fits into a sector of this flash, in whole words.
const fn fits<F: Sectors>() -> bool {
    let is_whole = (PAGE as u32).is_multiple_of(F::WORD) && WHOLE_AT.is_multiple_of(F::WORD);
    is_whole && NOTES_AT + NOTES * PAGE as u32 <= F::SECTOR
}

/// A slot.
pub struct FlashSlot {
    /// Where its sector begins.
    sector: u32,
    holds: Holds,
    /// Pages below this number were erased by this run of the firmware and not programmed since.
    erased: usize,
}

/// Content of a sector.
enum Holds {
    /// It could not be read, so it must not be erased.
    Unread,
    /// Nothing valid: blank, the remainder of a cut erase, or code of another image.
    Nothing,
    /// A slot that was begun. Pages that this run of the firmware has not written in it read as blank.
    Begun,
    /// A slot with all its pages.
    Whole,
}

impl FlashSlot {
    /// The slot in a sector, as it is found at the start.
    pub fn found<F: Sectors>(flash: &mut F, sector: u32) -> Self {
        const { assert!(fits::<F>()) };
        Self { sector, holds: look(flash, sector).unwrap_or(Holds::Unread), erased: 0 }
    }

    /// A page; blank if it was not written since the slot was begun.
    ///
    /// # Errors
    /// The errors of the flash.
    pub fn page(&self, flash: &mut impl Sectors, number: usize) -> Result<[u8; PAGE], StorageError> {
        let mut page = BLANK;
        match &self.holds {
            Holds::Unread => return Err(StorageError::Failed),
            Holds::Begun if self.erased > 0 => flash.read(self.page_at(number), &mut page)?,
            Holds::Nothing | Holds::Begun => {}
            Holds::Whole => flash.read(self.page_at(number), &mut page)?,
        }
        Ok(page)
    }

    /// Writes a page. Restarts the slot first, unless the page lies below all pages written since the last restart.
    /// `other` is the slot with the current settings.
    ///
    /// # Errors
    /// The errors of the flash.
    pub fn put_page(
        &mut self,
        flash: &mut impl Sectors,
        other: &Self,
        number: usize,
        page: &[u8; PAGE],
    ) -> Result<(), StorageError> {
        if number >= self.erased {
            self.begin(flash, other)?;
        }
        self.erased = number;
        flash.program(self.page_at(number), page)?;
        // A save writes page 0 last, so all pages are there.
        if number == 0 {
            flash.program(self.sector + WHOLE_AT, &WHOLE)?;
            self.holds = Holds::Whole;
        }
        Ok(())
    }

    /// The last note; a blank page if there is none.
    ///
    /// # Errors
    /// The errors of the flash.
    pub fn note(&self, flash: &mut impl Sectors) -> Result<[u8; PAGE], StorageError> {
        Ok(self.last_note(flash)?.1)
    }

    /// Writes a note. A sector that holds nothing is erased first.
    ///
    /// # Errors
    /// The errors of the flash, and [`StorageError::Failed`] if there is no room.
    pub fn put_note(&mut self, flash: &mut impl Sectors, other: &Self, note: &[u8; PAGE]) -> Result<(), StorageError> {
        match self.holds {
            Holds::Unread => return Err(StorageError::Failed),
            Holds::Nothing => self.begin(flash, other)?,
            Holds::Begun | Holds::Whole => {}
        }
        match self.last_note(flash)? {
            (_, last) if last == *note => Ok(()),
            (count, _) if count < NOTES => flash.program(self.note_at(count), note),
            _ => Err(StorageError::Failed),
        }
    }

    /// How many notes there are, and the last.
    fn last_note(&self, flash: &mut impl Sectors) -> Result<(u32, [u8; PAGE]), StorageError> {
        let mut last = BLANK;
        if !matches!(self.holds, Holds::Begun | Holds::Whole) {
            return Ok((0, last));
        }
        for count in 0..NOTES {
            let mut note = BLANK;
            flash.read(self.note_at(count), &mut note)?;
            if note == BLANK {
                return Ok((count, last));
            }
            last = note;
        }
        Ok((NOTES, last))
    }

    /// Erases the sector, whatever it looks like, and makes it a slot with blank pages. The note is carried over.
    fn begin(&mut self, flash: &mut impl Sectors, other: &Self) -> Result<(), StorageError> {
        if matches!(self.holds, Holds::Unread) {
            return Err(StorageError::Failed);
        }
        // That mark may be of a cut write, and may read otherwise tomorrow. From the erase on it has the only settings.
        if matches!(other.holds, Holds::Whole) {
            flash.program(other.sector + WHOLE_AT, &WHOLE)?;
        }
        let note = self.note(flash)?;
        (self.holds, self.erased) = (Holds::Nothing, 0);
        // Zeros first: after a cut erase the cells may read as anything, and then as ERASED only by chance (see the
        // head).
        flash.program(self.sector, &[0; PAGES_AT as usize])?;
        flash.erase(self.sector)?;
        if note != BLANK {
            flash.program(self.note_at(0), &note)?;
        }
        // Last, when the note is back: without it the sector is erased again before anything is written.
        flash.program(self.sector, &ERASED)?;
        (self.holds, self.erased) = (Holds::Begun, PAGES);
        Ok(())
    }

    const fn page_at(&self, number: usize) -> u32 {
        self.sector + PAGES_AT + (number * PAGE) as u32
    }

    const fn note_at(&self, number: u32) -> u32 {
        self.sector + NOTES_AT + number * PAGE as u32
    }
}

/// Determines the content of a sector.
fn look(flash: &mut impl Sectors, sector: u32) -> Result<Holds, StorageError> {
    let mut marks = [0; PAGES_AT as usize];
    flash.read(sector, &mut marks)?;
    let (erased, whole) = marks.split_at(WHOLE_AT as usize);
    Ok(if erased != ERASED {
        Holds::Nothing
    } else if whole.starts_with(&WHOLE) {
        Holds::Whole
    } else {
        Holds::Begun
    })
}
