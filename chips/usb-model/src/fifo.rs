//! The receive FIFO, which all OUT endpoints share: entries with a status, some with words of data.

use std::collections::VecDeque;

/// The kinds of entries, by their PKTSTS (RM0390 rev 6, GRXSTSP in device mode).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// The global OUT NAK takes effect.
    GlobalNak = 1,
    /// A packet came.
    Data = 2,
    /// An OUT transfer is complete.
    OutDone = 3,
    /// The SETUP stage is over.
    SetupDone = 4,
    /// A SETUP packet came.
    Setup = 6,
}

/// An entry.
#[derive(Clone, Debug)]
struct Entry {
    /// Its PKTSTS, which is a [`Status`] unless something is broken.
    status: u32,
    endpoint: usize,
    toggle: bool,
    bytes: Vec<u8>,
}

impl Entry {
    fn word(&self) -> u32 {
        let toggle = if self.toggle { 0b10 } else { 0b00 };
        self.endpoint as u32 | (self.bytes.len() as u32) << 4 | toggle << 15 | self.status << 17
    }

    /// Words of memory: its status, and its data.
    fn words(&self) -> usize {
        1 + self.bytes.len().div_ceil(4)
    }
}

/// The receive FIFO.
#[derive(Clone, Debug, Default)]
pub struct ReceiveFifo {
    entries: VecDeque<Entry>,
    /// Words of the popped packet that were not read yet.
    unread: VecDeque<u32>,
}

impl ReceiveFifo {
    /// Adds an entry.
    pub fn push(&mut self, status: Status, endpoint: usize, toggle: bool, bytes: &[u8]) {
        self.push_any(status as u32, endpoint, toggle, bytes);
    }

    /// Adds an entry of any kind.
    pub fn push_any(&mut self, status: u32, endpoint: usize, toggle: bool, bytes: &[u8]) {
        self.entries.push_back(Entry { status, endpoint, toggle, bytes: bytes.to_vec() });
    }

    /// Whether there is something to read.
    pub fn has_entry(&self) -> bool {
        !self.entries.is_empty()
    }

    /// Words in use.
    pub fn words(&self) -> usize {
        self.unread.len() + self.entries.iter().map(Entry::words).sum::<usize>()
    }

    /// Words of the last packet that are left.
    pub fn unread(&self) -> usize {
        self.unread.len()
    }

    /// The status of the next entry.
    pub fn front(&self) -> u32 {
        self.entries.front().map_or(0, Entry::word)
    }

    /// Pops an entry: its word, its PKTSTS and its endpoint.
    pub fn pop(&mut self) -> Option<(u32, u32, usize)> {
        let entry = self.entries.pop_front()?;
        self.unread = entry.bytes.chunks(4).map(word_of).collect();
        Some((entry.word(), entry.status, entry.endpoint))
    }

    /// The next word of data.
    pub fn read(&mut self) -> Option<u32> {
        self.unread.pop_front()
    }

    /// Forgets everything.
    pub fn flush(&mut self) {
        *self = Self::default();
    }
}

/// Up to four bytes as a word.
fn word_of(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte))
}
