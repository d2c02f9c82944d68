//! Memory for settings, whichever a board has.
//!
//! A board's `main` passes the function that opens its memory, so the linker leaves the other driver out.

use corehbot::port::{Storage, StorageError};

use crate::wiring::Board;

/// A function that finds the memory of a board, when its clocks run.
pub type Find = fn(&'static Board) -> &'static mut dyn Memory;

/// The port [`Storage`] without futures: no call takes longer than a millisecond or two, unless it says so.
pub trait Memory {
    /// As [`Storage::capacity`].
    fn capacity(&self) -> u32;

    /// As [`Storage::read`].
    ///
    /// # Errors
    /// The same.
    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError>;

    /// As [`Storage::write`].
    ///
    /// # Errors
    /// The same.
    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError>;

    /// As [`Storage::is_done`].
    ///
    /// # Errors
    /// The same.
    fn is_done(&mut self) -> Result<bool, StorageError>;
}

/// No memory.
impl<M: Memory> Memory for Option<M> {
    fn capacity(&self) -> u32 {
        self.as_ref().map_or(0, Memory::capacity)
    }

    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.as_mut().ok_or(StorageError::Absent)?.read(at, into)
    }

    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.as_mut().ok_or(StorageError::Absent)?.write(at, bytes)
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        self.as_mut().ok_or(StorageError::Absent)?.is_done()
    }
}

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
}
