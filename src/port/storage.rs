//! Memory that keeps its content without power.

/// Why the storage did not do it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StorageError {
    /// There is no storage, or no such address.
    Absent,
    /// It does not answer: wiring, or a broken chip.
    Failed,
}

impl core::fmt::Display for StorageError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Absent => put!(f, "no storage on this machine"),
            Self::Failed => put!(f, "storage does not answer"),
        }
    }
}

impl core::error::Error for StorageError {}

/// Byte-addressed memory that keeps its content without power.
///
/// Every call ends in bounded time, with [`StorageError::Failed`] if necessary. A future that is dropped half-way is
/// like a power cut: the page that was being written may hold anything.
#[expect(async_fn_in_trait, reason = "the Console polls them in its own context; nobody needs Send")]
pub trait Storage {
    /// Size in bytes; 0 if there is none.
    fn capacity(&self) -> u32;

    /// Fills `into` with the bytes from address `at` on.
    ///
    /// # Errors
    /// [`StorageError`]; then `into` may hold anything.
    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError>;

    /// Takes `bytes` for address `at`; they are stored permanently as soon as the storage [is done](Self::is_done). The
    /// core never writes across a page of [`crate::storage::PAGE`] bytes.
    ///
    /// # Errors
    /// [`StorageError`]; then some of the bytes may have been written.
    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError>;

    /// Whether all written bytes are stored permanently. Ask until it is true before the next transfer: a transfer that
    /// comes too early blocks until then, and no other context runs.
    ///
    /// # Errors
    /// [`StorageError::Failed`] if it takes too long.
    fn is_done(&mut self) -> Result<bool, StorageError> {
        Ok(true)
    }

    /// Whether each page can be written by itself, without a save of all settings. Memory that is erased first cannot.
    fn keeps_pages(&self) -> bool {
        true
    }

    /// The content of the program memory, as a number that differs after an update; `None` for a program that is not
    /// flashed, such as a simulator's.
    fn image(&self) -> Option<u32> {
        None
    }
}

/// For machines without storage.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoStorage;

impl Storage for NoStorage {
    fn capacity(&self) -> u32 {
        0
    }

    async fn read(&mut self, _at: u32, _into: &mut [u8]) -> Result<(), StorageError> {
        Err(StorageError::Absent)
    }

    async fn write(&mut self, _at: u32, _bytes: &[u8]) -> Result<(), StorageError> {
        Err(StorageError::Absent)
    }
}
