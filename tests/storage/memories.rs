//! Memories: one without faults, and others with power cuts, with worn cells, or without an answer.

use corehbot::port::{Storage, StorageError};
use corehbot::settings::Settings;
use corehbot::storage::{self, PAGE};
use std::pin::pin;
use std::task::{Context, Poll, Waker};

pub const SIZE: usize = 4096;

/// The result of a future that never waits.
pub fn now<F: Future>(future: F) -> F::Output {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => result,
        Poll::Pending => panic!("it waits"),
    }
}

/// An EEPROM without faults that keeps books.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Eeprom {
    pub cells: Vec<u8>,
    /// Address and size of every write.
    pub writes: Vec<(u32, usize)>,
}

impl Eeprom {
    pub fn blank() -> Self {
        Self::holding(vec![0xFF; SIZE])
    }

    pub fn holding(cells: Vec<u8>) -> Self {
        Self { cells, writes: Vec::new() }
    }

    pub fn with(settings: &[Settings]) -> Self {
        let mut eeprom = Self::blank();
        for s in settings {
            now(storage::save(&mut eeprom, s)).unwrap();
        }
        eeprom.writes.clear();
        eeprom
    }

    pub fn bytes_written(&self) -> usize {
        self.writes.iter().map(|(_, size)| size).sum()
    }
}

impl Storage for Eeprom {
    fn capacity(&self) -> u32 {
        self.cells.len() as u32
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        into.copy_from_slice(&self.cells[at as usize..][..into.len()]);
        Ok(())
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let at = at as usize;
        assert_eq!(at / PAGE, (at + bytes.len() - 1) / PAGE, "a write across a page");
        self.writes.push((at as u32, bytes.len()));
        self.cells[at..][..bytes.len()].copy_from_slice(bytes);
        Ok(())
    }
}

/// The content of a cell after a cut during its programming.
pub type Torn = fn(old: u8, new: u8) -> u8;

pub const TORN: [Torn; 6] =
    [|old, _| old, |_, new| new, |_, _| 0xFF, |_, _| 0, |old, new| old ^ new, |old, new| old & new];

/// Cuts the power after a number of bytes; the next one is torn. With `whole_page`, the page is programmed at once, so
/// the cut tears all of its bytes from there on.
pub struct Cut<'e> {
    pub eeprom: &'e mut Eeprom,
    pub left: usize,
    pub torn: Torn,
    pub whole_page: bool,
    pub is_dead: bool,
}

impl Storage for Cut<'_> {
    fn capacity(&self) -> u32 {
        self.eeprom.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        if self.is_dead { Err(StorageError::Failed) } else { self.eeprom.read(at, into).await }
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        if self.is_dead {
            return Err(StorageError::Failed);
        }
        if bytes.len() <= self.left {
            self.left -= bytes.len();
            return self.eeprom.write(at, bytes).await;
        }
        self.is_dead = true;
        for (i, (cell, new)) in self.eeprom.cells[at as usize..].iter_mut().zip(bytes).enumerate() {
            if i < self.left {
                *cell = *new;
            } else if i == self.left || self.whole_page {
                *cell = (self.torn)(*cell, *new);
            }
        }
        Err(StorageError::Failed)
    }
}

/// A memory with a cell that cannot be changed.
pub struct Stuck(pub Eeprom, pub usize);

impl Storage for Stuck {
    fn capacity(&self) -> u32 {
        self.0.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.0.read(at, into).await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let was = self.0.cells[self.1];
        self.0.write(at, bytes).await?;
        self.0.cells[self.1] = was;
        Ok(())
    }
}

/// A memory that stops answering after a number of reads.
pub struct Silent(pub Eeprom, pub usize);

impl Storage for Silent {
    fn capacity(&self) -> u32 {
        self.0.capacity()
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        self.1 = self.1.checked_sub(1).ok_or(StorageError::Failed)?;
        self.0.read(at, into).await
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.0.write(at, bytes).await
    }
}
