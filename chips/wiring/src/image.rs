//! An image: boards that differ in pins alone share one.

use core::hint::black_box;

use corehbot::storage::{BLOCK, TEXT_BLOCK, board_of, texts_of};

use crate::Board;

/// The boards that an image may be on, its machine block, which says on which it is, and its owner's texts.
pub struct Image {
    /// Their tables.
    pub boards: &'static [&'static Board],
    /// The block.
    pub block: &'static [u8; BLOCK],
    /// The block of its owner's texts.
    pub texts: &'static [u8; TEXT_BLOCK],
}

impl Image {
    /// The machine block. The compiler must read it at run time: the block in the flashed image may differ from the
    /// compiled one.
    #[must_use]
    pub fn block(&self) -> &'static [u8; BLOCK] {
        black_box(self.block)
    }

    /// The owner's texts; none if they are not whole. They are read at run time, as the machine block is.
    #[must_use]
    pub fn texts(&self) -> &'static [u8] {
        texts_of(black_box(self.texts))
    }

    /// The board that runs the image; `None` if its block names another.
    #[must_use]
    pub fn board(&self) -> Option<&'static Board> {
        let key = board_of(self.block())?;
        self.boards.iter().copied().find(|board| board.connectors.key == key)
    }
}
