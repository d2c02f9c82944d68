//! Flash that can lose power in any operation.

use crate::random::Random;
use corehbot::port::StorageError;
use corehbot_board_support::flash_sectors::Sectors;
use std::cell::{Cell, RefCell};
use std::ops::Range;
use std::rc::Rc;

/// Two sectors of 16 KiB, as the STM32F446 has them.
const SECTORS: Range<u32> = 0x4000..0xC000;
const SECTOR: u32 = 0x4000;

/// The power is gone.
#[derive(Debug)]
pub struct Dead;

/// Flash that programs a word or erases a sector in one operation, until its power goes.
#[derive(Clone)]
pub struct Nor {
    pub cells: Vec<u8>,
    /// Bits of the cells that read as anything: their operation was cut.
    unsure: Vec<u8>,
    /// Operations that are still done.
    pub left: usize,
    pub tear: Tear,
    pub operations: usize,
    pub erases: Vec<u32>,
    /// Operations before the last erase.
    pub erased_at: usize,
    /// Bytes read, counted for all its clones.
    pub reads: Rc<Cell<usize>>,
    random: RefCell<Random>,
}

/// The remainder of an operation that a power cut interrupts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Tear {
    /// Nothing has happened yet.
    Not,
    /// Some bits have changed, the same of each cell.
    Bits,
    /// The first half is done.
    FirstHalf,
    /// The second half is done.
    SecondHalf,
    /// The first and the last cells are done, a word of them if it is a sector, and those in between hold anything.
    Ends,
    /// Each cell holds anything: an erase may make all bits zero before it makes them one.
    Anything,
    /// All cells are done, except for one.
    Nearly,
    /// All that changes reads as something else each time, until it is erased.
    Unsure,
}

/// All kinds that can be read twice.
pub const TEARS: [Tear; 7] =
    [Tear::Not, Tear::Bits, Tear::FirstHalf, Tear::SecondHalf, Tear::Ends, Tear::Anything, Tear::Nearly];

/// Cells of a sector that [`Tear::Nearly`] leaves unerased.
const LEFT_OVER: usize = 0x600;

impl Nor {
    pub fn holding(cells: Vec<u8>) -> Self {
        let unsure = vec![0; cells.len()];
        Self {
            cells,
            unsure,
            left: usize::MAX,
            tear: Tear::Not,
            operations: 0,
            erases: Vec::new(),
            erased_at: 0,
            reads: Rc::default(),
            random: RefCell::new(Random(1)),
        }
    }

    pub fn blank() -> Self {
        Self::holding(vec![0xFF; SECTORS.end as usize])
    }

    /// Flash with random content.
    pub fn code() -> Self {
        let mut random = Random(1);
        Self::holding((0..SECTORS.end).map(|_| random.byte()).collect())
    }

    /// With power again.
    pub fn revived(self) -> Self {
        let (unsure, random) = (self.unsure, self.random);
        Self { unsure, random, ..Self::holding(self.cells) }
    }

    /// The same flash, with a power cut in an operation.
    pub fn cut(&self, left: usize, tear: Tear) -> Self {
        Self { left, tear, ..self.clone().revived() }
    }

    /// Changes the cells from `at` on.
    fn operate(&mut self, at: usize, new: &[u8]) -> Result<(), Dead> {
        let is_erase = new.len() == SECTOR as usize;
        let place = at..at + new.len();
        let (cells, unsure) = (&mut self.cells[place.clone()], &mut self.unsure[place]);
        if self.left > 0 {
            self.left -= 1;
            self.operations += 1;
            cells.copy_from_slice(new);
            // A bit that is programmed is zero for good.
            unsure.iter_mut().zip(new).for_each(|(unsure, new)| *unsure &= if is_erase { 0 } else { *new });
            return Ok(());
        }
        let (length, random) = (new.len(), self.random.get_mut());
        for (i, ((cell, unsure), new)) in cells.iter_mut().zip(unsure).zip(new).enumerate() {
            // A program leaves the bits alone that it does not concern.
            let any = if is_erase { random.byte() } else { *new | *cell & random.byte() };
            let is_end = if is_erase { i < 4 || i >= length - 4 } else { i == 0 || i == length - 1 };
            match self.tear {
                Tear::Bits => *cell = *cell & 0x5A | new & 0xA5,
                Tear::FirstHalf if i < length / 2 => *cell = *new,
                Tear::SecondHalf if i >= length / 2 => *cell = *new,
                Tear::Nearly if i != LEFT_OVER % length => *cell = *new,
                Tear::Ends if is_end => *cell = *new,
                Tear::Ends | Tear::Anything => *cell = any,
                Tear::Unsure => *unsure |= if is_erase { 0xFF } else { *cell & !new },
                Tear::Not | Tear::FirstHalf | Tear::SecondHalf | Tear::Nearly => {}
            }
        }
        // Whatever follows is not done either.
        self.tear = Tear::Not;
        Err(Dead)
    }

    pub fn look(&self, at: u32, into: &mut [u8]) {
        self.reads.update(|reads| reads + into.len());
        let place = at as usize..at as usize + into.len();
        assert!(at >= SECTORS.start && place.end <= SECTORS.end as usize);
        let cells = self.cells[place.clone()].iter().zip(&self.unsure[place]);
        let mut random = self.random.borrow_mut();
        // All as before the cut, all inverted, or each at random.
        let all = random.choose(&[Some(0), Some(0xFF), None]);
        for (byte, (cell, unsure)) in into.iter_mut().zip(cells) {
            *byte = if *unsure == 0 { *cell } else { cell ^ (all.unwrap_or_else(|| random.byte()) & unsure) };
        }
    }

    pub fn program_words(&mut self, at: u32, bytes: &[u8]) -> Result<(), Dead> {
        let end = at + bytes.len() as u32;
        assert!(at >= SECTORS.start && end <= SECTORS.end && at.is_multiple_of(4) && end.is_multiple_of(4));
        for (i, word) in bytes.chunks(4).enumerate() {
            let at = at as usize + 4 * i;
            // Programming clears bits and never sets one.
            let new: Vec<u8> = word.iter().zip(&self.cells[at..]).map(|(new, old)| new & old).collect();
            self.operate(at, &new)?;
        }
        Ok(())
    }

    pub fn erase_sector(&mut self, at: u32) -> Result<(), Dead> {
        assert!(SECTORS.contains(&at) && at.is_multiple_of(SECTOR));
        self.erases.push(at);
        self.erased_at = self.operations;
        self.operate(at as usize, &[0xFF; SECTOR as usize])
    }
}

impl Sectors for Nor {
    const SECTORS: [u32; 2] = [SECTORS.start, SECTORS.start + SECTOR];
    const SECTOR: u32 = SECTOR;
    const WORD: u32 = 4;

    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.look(at, into);
        Ok(())
    }

    fn program(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.program_words(at, bytes).map_err(|Dead| StorageError::Failed)
    }

    fn erase(&mut self, at: u32) -> Result<(), StorageError> {
        self.erase_sector(at).map_err(|Dead| StorageError::Failed)
    }
}
