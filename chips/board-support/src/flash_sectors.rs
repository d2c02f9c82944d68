//! The flash sectors reserved for settings, and the operations on them.

use corehbot::port::StorageError;

/// Flash with two sectors for settings. A power cut in an operation may leave any content in the word being programmed,
/// or in the sector being erased. Nothing else changes.
pub trait Sectors {
    /// Where each of the sectors begins, by its distance from the begin of flash.
    const SECTORS: [u32; 2];

    /// Bytes of one of them.
    const SECTOR: u32;

    /// Bytes that are programmed at a time.
    const WORD: u32;

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
