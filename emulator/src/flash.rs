//! The sectors of flash in which a board keeps settings: their content, and the remainder after a power cut.
//!
//! Sectors 1 and 2 (RM0390 rev 6, section 3.3). Programming turns ones into zeros, and an erase sets all bits of a
//! sector to one (section 3.5.4). Either takes time, and a cut may come in the middle of it.

use std::ops::Range;

/// Where the sectors are for the processor.
pub const SECTORS: Range<u64> = 0x0800_4000..0x0800_C000;

/// Size of each.
pub const SECTOR: u64 = 0x4000;

/// Number of the first.
const FIRST: u64 = 1;

/// The remainder of an operation that a power cut interrupts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Tear {
    /// Nothing has happened yet.
    Not,
    /// Some bits have changed in every byte.
    Bits,
    /// The first half is done.
    FirstHalf,
    /// The second half is done.
    SecondHalf,
    /// The ends are done: the first and the last word of a sector, or byte of a word. Those in between hold anything.
    Ends,
    /// Every byte holds anything: an erase may make all bits zero before it makes them one.
    Anything,
}

impl Tear {
    /// The new value of the byte at `at` of `length`, which was to become `new`. `any` is the random value that it may
    /// get.
    const fn byte(self, at: usize, length: usize, old: u8, new: u8, any: u8) -> u8 {
        let end = if length == SECTOR as usize { 4 } else { 1 };
        match self {
            Self::Bits => old & 0x5A | new & 0xA5,
            Self::FirstHalf if at < length / 2 => new,
            Self::SecondHalf if at >= length / 2 => new,
            Self::Ends if at < end || at >= length - end => new,
            Self::Ends | Self::Anything => any,
            Self::Not | Self::FirstHalf | Self::SecondHalf => old,
        }
    }
}

/// A pseudo-random byte, the same for each address: the upper bits of a product with 2^32 over the golden ratio (Knuth,
/// The Art of Computer Programming, volume 3, section 6.4).
const fn chance(at: usize) -> u8 {
    ((at as u32).wrapping_mul(0x9E37_79B1) >> 24) as u8
}

/// When the power goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FlashCut {
    /// Operations that are still done.
    pub after: usize,
    /// The remainder of the next operation.
    pub tear: Tear,
}

/// An operation of the interface.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Operation {
    /// Programs bytes of this value at an address.
    Program {
        /// Where.
        address: u64,
        /// How many: 1, 2 or 4.
        size: usize,
        /// The value.
        value: u64,
    },
    /// A sector is erased.
    Erase {
        /// Its number.
        sector: u64,
    },
}

impl Operation {
    /// The addresses that it changes.
    const fn addresses(self) -> Range<u64> {
        match self {
            Self::Program { address, size, .. } => address..address + size as u64,
            Self::Erase { sector } => {
                let begin = SECTORS.start.wrapping_add(sector.wrapping_sub(FIRST).wrapping_mul(SECTOR));
                begin..begin + SECTOR
            }
        }
    }
}

/// The sectors.
#[derive(Clone, Debug)]
pub struct FlashSectors {
    /// The content.
    pub cells: Vec<u8>,
    /// The power goes in an operation.
    pub cut: Option<FlashCut>,
    /// All operations that were begun.
    pub operations: Vec<Operation>,
    /// Misuse of the interface by the image.
    pub faults: Vec<&'static str>,
    is_cut: bool,
}

impl Default for FlashSectors {
    fn default() -> Self {
        Self::holding(vec![0xFF; (SECTORS.end - SECTORS.start) as usize])
    }
}

impl FlashSectors {
    /// Sectors that hold `cells`.
    #[must_use]
    pub const fn holding(cells: Vec<u8>) -> Self {
        Self { cells, cut: None, operations: Vec::new(), faults: Vec::new(), is_cut: false }
    }

    /// Whether the power has gone.
    #[must_use]
    pub const fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// How many sectors were erased.
    #[must_use]
    pub fn erases(&self) -> usize {
        self.operations.iter().filter(|operation| matches!(operation, Operation::Erase { .. })).count()
    }

    /// Begins an operation. It has no effect if it concerns other sectors.
    pub(crate) fn begin(&mut self, operation: Operation) -> Option<Operation> {
        let addresses = operation.addresses();
        if addresses.start < SECTORS.start || addresses.end > SECTORS.end {
            self.faults.push("flash outside of the settings' sectors is changed");
            return None;
        }
        self.is_cut = self.cut.is_some_and(|cut| cut.after == self.operations.len());
        self.operations.push(operation);
        Some(operation)
    }

    /// Carries an operation out, as far as `tear` says, and returns the changes: addresses and words.
    pub(crate) fn end(&mut self, operation: Operation, tear: Option<Tear>) -> Vec<(u64, u32)> {
        let Range { start, end } = operation.addresses();
        let place = (start - SECTORS.start) as usize..(end - SECTORS.start) as usize;
        for (i, at) in place.clone().enumerate() {
            let old = self.cells[at];
            let (new, any) = match operation {
                Operation::Program { value, .. } => {
                    let new = old & (value >> (8 * i)) as u8;
                    (new, new | old & chance(at))
                }
                Operation::Erase { .. } => (0xFF, chance(at)),
            };
            self.cells[at] = tear.map_or(new, |tear| tear.byte(i, place.len(), old, new, any));
        }
        let words = (place.start & !3..place.end).step_by(4);
        words.map(|at| (SECTORS.start + at as u64, self.word(at))).collect()
    }

    fn word(&self, at: usize) -> u32 {
        self.cells[at..at + 4].iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORD: Operation = Operation::Program { address: SECTORS.start + 8, size: 4, value: 0x1234_F0F0 };

    #[test]
    fn programming_clears_bits_and_sets_none() {
        let mut flash = FlashSectors::default();
        assert_eq!(flash.end(WORD, None), [(0x0800_4008, 0x1234_F0F0)]);
        let more = Operation::Program { address: SECTORS.start + 9, size: 1, value: 0x3F };
        assert_eq!(flash.end(more, None), [(0x0800_4008, 0x1234_30F0)]);
        let changes = flash.end(Operation::Erase { sector: 1 }, None);
        assert_eq!((changes.len(), changes[2]), (4096, (0x0800_4008, u32::MAX)));
        assert!(flash.cells.iter().all(|cell| *cell == 0xFF));
    }

    #[test]
    fn a_cut_leaves_a_mixture() {
        for (tear, left) in [
            (Tear::Not, u32::MAX),
            (Tear::FirstHalf, 0xFFFF_F0F0),
            (Tear::SecondHalf, 0x1234_FFFF),
            (Tear::Bits, 0x5A7E_FAFA),
        ] {
            let mut flash = FlashSectors::default();
            assert_eq!(flash.end(WORD, Some(tear)), [(0x0800_4008, left)], "{tear:?}");
        }
        let mut flash = FlashSectors::holding(vec![0; 0x8000]);
        flash.end(Operation::Erase { sector: 2 }, Some(Tear::FirstHalf));
        assert_eq!(flash.cells.iter().position(|cell| *cell != 0), Some(0x4000));
        assert_eq!(flash.cells.iter().rposition(|cell| *cell != 0), Some(0x5FFF));
        flash.end(Operation::Erase { sector: 2 }, Some(Tear::SecondHalf));
        assert!(flash.cells[0x4000..].iter().all(|cell| *cell == 0xFF));
    }

    /// One erase looks complete if only both ends are read, and one looks like no erase.
    #[test]
    fn what_is_between_the_ends_may_hold_anything() {
        for (tear, blank) in [(Tear::Ends, 8), (Tear::Anything, 0)] {
            let mut flash = FlashSectors::holding(vec![0; 0x8000]);
            flash.end(Operation::Erase { sector: 1 }, Some(tear));
            let sector = &flash.cells[..0x4000];
            let blanks = sector.iter().filter(|cell| **cell == 0xFF).count();
            let zeros = sector.iter().filter(|cell| **cell == 0).count();
            assert!(blanks.abs_diff(64 + blank) < 24 && zeros.abs_diff(64) < 24, "{tear:?} {blanks} {zeros}");
            assert_eq!((sector.starts_with(&[0xFF; 4]), sector.ends_with(&[0xFF; 4])), (blank > 0, blank > 0));
            // Programming takes no bit back that it does not concern.
            let mut flash = FlashSectors::default();
            let left = flash.end(WORD, Some(tear))[0].1;
            assert_eq!(left & 0x1234_F0F0, 0x1234_F0F0, "{tear:?} {left:#x}");
        }
    }

    #[test]
    fn the_cut_comes_in_the_operation_that_is_counted() {
        let mut flash = FlashSectors { cut: Some(FlashCut { after: 1, tear: Tear::Not }), ..FlashSectors::default() };
        assert_eq!((flash.begin(WORD), flash.is_cut()), (Some(WORD), false));
        assert_eq!((flash.begin(Operation::Erase { sector: 2 }).is_some(), flash.is_cut()), (true, true));
    }

    #[test]
    fn other_sectors_are_none_of_it() {
        let mut flash = FlashSectors::default();
        let last = Operation::Program { address: SECTORS.end - 2, size: 4, value: 0 };
        for operation in [0, 3, 7, u64::MAX].map(|sector| Operation::Erase { sector }).into_iter().chain([last]) {
            assert_eq!(flash.begin(operation), None, "{operation:?}");
        }
        assert_eq!((flash.operations.len(), flash.faults.len()), (0, 5));
    }
}
