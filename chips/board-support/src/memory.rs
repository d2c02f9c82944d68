//! Memory for settings, whichever a board has.

use corehbot::port::StorageError;

/// The port [`corehbot::port::Storage`] without futures: a call takes at most a millisecond or two, unless its
/// documentation says otherwise.
pub trait Memory {
    /// As [`corehbot::port::Storage::capacity`].
    fn capacity(&self) -> u32;

    /// As [`corehbot::port::Storage::read`].
    ///
    /// # Errors
    /// The same.
    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError>;

    /// As [`corehbot::port::Storage::write`].
    ///
    /// # Errors
    /// The same.
    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError>;

    /// As [`corehbot::port::Storage::is_done`].
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
