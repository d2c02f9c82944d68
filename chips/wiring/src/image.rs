//! An image: boards that differ in pins alone share one.

use core::hint::black_box;

use corehbot::storage::{BLOCK, board_of};

use crate::Board;

/// The boards that an image may be on, and its machine block, which says on which it is.
pub struct Image {
    /// Their tables.
    pub boards: &'static [&'static Board],
    /// The block.
    pub block: &'static [u8; BLOCK],
}

impl Image {
    /// The machine block. The compiler must read it at run time: the block in the flashed image may differ from the
    /// compiled one.
    #[must_use]
    pub fn block(&self) -> &'static [u8; BLOCK] {
        black_box(self.block)
    }

    /// The board that runs the image; `None` if its block names another.
    #[must_use]
    pub fn board(&self) -> Option<&'static Board> {
        let key = board_of(self.block())?;
        self.boards.iter().copied().find(|board| board.connectors.key == key)
    }
}
