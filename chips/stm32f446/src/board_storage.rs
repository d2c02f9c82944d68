//! The board's memory and its image, as the core sees them.

use corehbot::port::{Storage, StorageError};

use crate::image;
use corehbot_board_support::memory::Memory;

/// The board's memory as the core sees it.
pub struct BoardStorage(pub &'static mut dyn Memory);

impl Storage for BoardStorage {
    fn capacity(&self) -> u32 {
        self.0.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.0.read(at, into)
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.0.write(at, bytes)
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        self.0.is_done()
    }

    fn image(&self) -> Option<u32> {
        Some(image::sum())
    }
}
