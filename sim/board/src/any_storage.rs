//! Storage of any kind as one type. So the firmware is compiled once, in this crate, and not again in every program and
//! test that brings a storage of its own.

use corehbot::port::{Storage, StorageError};
use std::pin::Pin;

/// What a transfer becomes.
type Transfer<'a> = Pin<Box<dyn Future<Output = Result<(), StorageError>> + 'a>>;

/// [`Storage`] without its type: futures in boxes.
trait Erased {
    fn capacity(&self) -> u32;
    fn read<'a>(&'a mut self, at: u32, into: &'a mut [u8]) -> Transfer<'a>;
    fn write<'a>(&'a mut self, at: u32, bytes: &'a [u8]) -> Transfer<'a>;
    fn is_done(&mut self) -> Result<bool, StorageError>;
    fn keeps_pages(&self) -> bool;
    fn image(&self) -> Option<u32>;
}

impl<S: Storage> Erased for S {
    fn capacity(&self) -> u32 {
        Storage::capacity(self)
    }

    fn read<'a>(&'a mut self, at: u32, into: &'a mut [u8]) -> Transfer<'a> {
        Box::pin(Storage::read(self, at, into))
    }

    fn write<'a>(&'a mut self, at: u32, bytes: &'a [u8]) -> Transfer<'a> {
        Box::pin(Storage::write(self, at, bytes))
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        Storage::is_done(self)
    }

    fn keeps_pages(&self) -> bool {
        Storage::keeps_pages(self)
    }

    fn image(&self) -> Option<u32> {
        Storage::image(self)
    }
}

/// Any storage.
pub struct AnyStorage<'s>(Box<dyn Erased + 's>);

impl<'s> AnyStorage<'s> {
    /// This storage.
    pub fn of(storage: impl Storage + 's) -> Self {
        Self(Box::new(storage))
    }
}

impl Storage for AnyStorage<'_> {
    fn capacity(&self) -> u32 {
        self.0.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.0.read(at, into).await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.0.write(at, bytes).await
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        self.0.is_done()
    }

    fn keeps_pages(&self) -> bool {
        self.0.keeps_pages()
    }

    fn image(&self) -> Option<u32> {
        self.0.image()
    }
}
