//! The ring that a USART's DMA writes and the Console reads: bytes, and a bit for each that says it was damaged.
//!
//! | context | writes | reads |
//! |---|---|---|
//! | DMA | `bytes`, and counts down the rest of a lap | |
//! | the DMA's interrupt | `laps`, at the end of each | |
//! | the USART's interrupt | `damaged`: sets bits | `laps` |
//! | Console | `damaged`: clears bits | everything |
//!
//! Nothing here needs the processor, so it is tested on the host.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use corehbot::port::Received;

/// Bytes in the ring: 80 ms at 250,000 bits a second, 20 ms at a million.
pub const SIZE: u32 = 2048;

/// Bytes that the DMA has written. Empty it is all zeros, so it costs no flash.
pub struct Ring {
    /// Where the DMA writes.
    pub bytes: [AtomicU8; SIZE as usize],
    /// A bit for every byte: damaged.
    damaged: [AtomicU32; SIZE as usize / 32],
    /// How often the DMA has come to the end.
    laps: AtomicU32,
}

impl Ring {
    /// An empty ring.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "boards make it in a `static`")]
    pub const fn new() -> Self {
        Self {
            bytes: [const { AtomicU8::new(0) }; SIZE as usize],
            damaged: [const { AtomicU32::new(0) }; SIZE as usize / 32],
            laps: AtomicU32::new(0),
        }
    }

    /// The DMA has come to the end.
    pub fn end_lap(&self) {
        self.laps.store(self.laps.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
    }

    /// Bytes ever written, wrapping; `left` is the DMA's counter. Within a few cycles after the end of a lap it may be
    /// a lap too few.
    pub fn written(&self, left: impl Fn() -> u32) -> u32 {
        loop {
            let laps = self.laps.load(Ordering::Acquire);
            let left = left();
            if self.laps.load(Ordering::Acquire) == laps {
                return laps.wrapping_mul(SIZE).wrapping_add(SIZE - left);
            }
        }
    }

    /// Marks as damaged the last of the `written` bytes and the byte that comes next. The last one came with an error,
    /// or a lost byte followed it. The next one is marked because clearing the error may have swallowed a byte just
    /// now. If that byte ended a line, the bytes after it belong to no line.
    pub fn mark_damage(&self, written: u32) {
        for position in [written.wrapping_sub(1), written] {
            let position = (position % SIZE) as usize;
            self.damaged[position / 32].fetch_or(1 << (position % 32), Ordering::Release);
        }
    }

    /// The next byte after the first `heard` ones, if it is among the `written` ones; it stays as it is.
    pub fn overhear(&self, heard: &mut u32, written: u32) -> Option<Received> {
        let waiting = written.wrapping_sub(*heard);
        if waiting == 0 || waiting.cast_signed() < 0 {
            return None;
        }
        let position = (*heard % SIZE) as usize;
        // Only looked at: `take` comes to the same byte, and clears the bit.
        let is_damaged = self.damaged[position / 32].load(Ordering::Acquire) & 1 << (position % 32) != 0;
        let is_lost = waiting > SIZE;
        *heard = if is_lost { written } else { heard.wrapping_add(1) };
        let byte = self.bytes[position].load(Ordering::Acquire);
        Some(if is_damaged || is_lost { Received::Lost } else { Received::Byte(byte) })
    }

    /// The next byte after the first `read` ones, if it is among the `written` ones.
    pub fn take(&self, read: &mut u32, written: u32) -> Option<Received> {
        let waiting = written.wrapping_sub(*read);
        // A lap too few is a negative number.
        if waiting == 0 || waiting.cast_signed() < 0 {
            return None;
        }
        if waiting > SIZE {
            // The DMA has overtaken us: the ring holds parts of many lines.
            *read = read.wrapping_add(waiting);
            self.damaged.iter().for_each(|bits| bits.store(0, Ordering::Release));
            return Some(Received::Lost);
        }
        let position = (*read % SIZE) as usize;
        let byte = self.bytes[position].load(Ordering::Acquire);
        let bit = 1 << (position % 32);
        let is_damaged = self.damaged[position / 32].fetch_and(!bit, Ordering::AcqRel) & bit != 0;
        *read = read.wrapping_add(1);
        Some(if is_damaged { Received::Lost } else { Received::Byte(byte) })
    }
}
