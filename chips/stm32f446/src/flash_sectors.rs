//! The flash sectors reserved for settings, and the operations on them.

use core::ops::Range;

use corehbot::port::StorageError;

/// The sectors: 1 and 2 (RM0390, 3.3), by their distance from the begin of flash. The vectors stay in sector 0, where
/// the processor expects them, and the code begins after them (`settings.x` of the board).
pub const SECTORS: Range<u32> = 0x4000..0xC000;

/// Bytes of one of them.
pub const SECTOR: u32 = 0x4000;

/// Bytes that are programmed at a time.
pub const WORD: u32 = 4;

/// Flash with these sectors. A power cut in an operation may leave any content in the word being programmed, or in the
/// sector being erased. Nothing else changes.
pub trait Sectors {
    /// Fills `into` with the bytes from `at` on.
    ///
    /// # Errors
    /// [`StorageError::Failed`] if they are not in the sectors.
    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError>;

    /// Programs whole words from `at` on, one after the other: ones become zeros, and zeros stay.
    ///
    /// # Errors
    /// [`StorageError::Failed`] if they are not whole words of the sectors, or flash refuses.
    fn program(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError>;

    /// Erases the sector that begins at `at`: all its bits become ones.
    ///
    /// # Errors
    /// [`StorageError::Failed`] if no sector begins there, or flash refuses.
    fn erase(&mut self, at: u32) -> Result<(), StorageError>;
}
