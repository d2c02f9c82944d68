//! The EEPROM of the board: AT24C32, 4 KiB at address 0x50.
//!
//! Datasheet Atmel 0336K: two address bytes, pages of 32 bytes that wrap, and no acknowledge for up to
//! 10 ms while a write is under way.

use rigless::chip::Timeline;
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;

/// A0 to A2 lie on ground.
const ADDRESS: u8 = 0x50;

const SIZE: usize = 4096;
const PAGE: usize = 32;

/// t_WR at most.
const WRITE_NS: u64 = 10_000_000;

/// An AT24C32.
#[derive(Debug)]
pub struct At24c32 {
    bytes: Vec<u8>,
    /// Where the next byte is read or written.
    at: usize,
    /// Address bytes heard since the start.
    heard: u8,
    /// Bytes of a page that wait for the stop.
    page: Vec<(usize, u8)>,
    busy_until: u64,
}

impl Default for At24c32 {
    fn default() -> Self {
        Self { bytes: vec![0xFF; SIZE], at: 0, heard: 0, page: Vec::new(), busy_until: 0 }
    }
}

impl Store for At24c32 {}

impl Peer for At24c32 {
    fn start(&mut self, address: u8, read: bool, context: &mut Timeline<'_, '_>) -> bool {
        if address != ADDRESS || context.now().0 < self.busy_until {
            return false;
        }
        if !read {
            self.heard = 0;
            self.page.clear();
        }
        true
    }

    fn write(&mut self, byte: u8, _context: &mut Timeline<'_, '_>) -> bool {
        match self.heard {
            0 => self.at = usize::from(byte) << 8,
            1 => self.at = (self.at | usize::from(byte)) % SIZE,
            _ => {
                self.page.push((self.at, byte));
                self.at = self.at / PAGE * PAGE + (self.at + 1) % PAGE;
            }
        }
        self.heard = self.heard.saturating_add(1);
        true
    }

    fn read(&mut self, _last: bool, _context: &mut Timeline<'_, '_>) -> u8 {
        let byte = self.bytes.get(self.at).copied().unwrap_or(0xFF);
        self.at = (self.at + 1) % SIZE;
        byte
    }

    fn stop(&mut self, context: &mut Timeline<'_, '_>) {
        if !self.page.is_empty() {
            for (at, byte) in self.page.drain(..) {
                if let Some(cell) = self.bytes.get_mut(at) {
                    *cell = byte;
                }
            }
            self.busy_until = context.now().0 + WRITE_NS;
        }
    }
}
