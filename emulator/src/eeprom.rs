//! The EEPROM of the board: AT24C32, 4 KiB at address 0x50, with power cuts.
//!
//! Datasheet AT24C32E 8905F: two address bytes, pages of 32 bytes in which a write wraps around. The stop starts the
//! write of a page, and for up to 5 ms the chip then gives no acknowledge.

use rigless::chip::Timeline;
use rigless::chip::i2c::Peer;
use rigless::snapshot::Store;

/// A0 to A2 lie on ground.
const ADDRESS: u8 = 0x50;

const SIZE: usize = 4096;
const PAGE: usize = 32;

/// t_WR at most.
const WRITE_NS: u64 = 5_000_000;

/// The time of a power cut, and its effect on the cells.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cut {
    /// Bytes that are still written.
    pub after: usize,
    /// The next byte holds a mixture then, and with `whole_page` so do all bytes of its page after it.
    pub whole_page: bool,
}

/// An AT24C32.
#[derive(Clone, Debug)]
pub struct At24c32 {
    /// The content.
    pub cells: Vec<u8>,
    /// The power goes in the middle of a write.
    pub cut: Option<Cut>,
    /// It answers. A chip without power, or one that is not there, does not.
    pub answers: bool,
    /// Addresses and bytes of all pages written.
    pub writes: Vec<(usize, usize)>,
    /// How often a host addressed it during a write.
    pub refusals: u32,
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
        Self::holding(vec![0xFF; SIZE])
    }
}

impl At24c32 {
    /// One that holds `cells`.
    #[must_use]
    pub const fn holding(cells: Vec<u8>) -> Self {
        Self {
            cells,
            cut: None,
            answers: true,
            writes: Vec::new(),
            refusals: 0,
            at: 0,
            heard: 0,
            page: Vec::new(),
            busy_until: 0,
        }
    }

    /// Whether the power has gone.
    #[must_use]
    pub const fn is_cut(&self) -> bool {
        self.cut.is_some() && !self.answers
    }

    /// Takes a byte of the address, or one of a page, within which the address goes round.
    fn take(&mut self, byte: u8) {
        match self.heard {
            0 => self.at = usize::from(byte) << 8,
            1 => self.at = (self.at | usize::from(byte)) % SIZE,
            _ => {
                self.page.push((self.at, byte));
                self.at = self.at / PAGE * PAGE + (self.at + 1) % PAGE;
            }
        }
        self.heard = self.heard.saturating_add(1);
    }

    /// Writes the page that waits, as far as there is power.
    fn program(&mut self) {
        let page = std::mem::take(&mut self.page);
        self.writes.push((page[0].0, page.len()));
        for (at, byte) in page {
            let cell = &mut self.cells[at % SIZE];
            match &mut self.cut {
                Some(cut) if cut.after == 0 => {
                    if self.answers || cut.whole_page {
                        *cell ^= byte;
                    }
                    self.answers = false;
                }
                Some(cut) => {
                    cut.after -= 1;
                    *cell = byte;
                }
                None => *cell = byte,
            }
        }
    }
}

impl Store for At24c32 {}

impl Peer for At24c32 {
    fn start(&mut self, address: u8, read: bool, context: &mut Timeline<'_, '_>) -> bool {
        if address != ADDRESS || !self.answers {
            return false;
        }
        if context.now().0 < self.busy_until {
            self.refusals += 1;
            return false;
        }
        // A page that no stop has followed is not written.
        self.page.clear();
        if !read {
            self.heard = 0;
        }
        true
    }

    fn write(&mut self, byte: u8, _context: &mut Timeline<'_, '_>) -> bool {
        self.take(byte);
        true
    }

    fn read(&mut self, _last: bool, _context: &mut Timeline<'_, '_>) -> u8 {
        let byte = self.cells.get(self.at).copied().unwrap_or(0xFF);
        self.at = (self.at + 1) % SIZE;
        byte
    }

    fn stop(&mut self, context: &mut Timeline<'_, '_>) {
        if !self.page.is_empty() {
            self.program();
            self.busy_until = context.now().0 + WRITE_NS;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waiting(at: usize, bytes: &[u8]) -> At24c32 {
        let page = bytes.iter().enumerate().map(|(i, byte)| (at + i, *byte)).collect();
        At24c32 { page, ..At24c32::default() }
    }

    #[test]
    fn a_write_goes_round_within_its_page() {
        let mut chip = At24c32::default();
        // The upper four bits of address 0x1234 mean nothing, so it is byte 20 of its page.
        for byte in [0x12, 0x34].into_iter().chain(0..40) {
            chip.take(byte);
        }
        chip.program();
        let page: Vec<u8> = (12..32).chain(32..40).chain(8..12).collect();
        assert_eq!(chip.cells[0x220..0x240], page);
        assert_eq!((chip.cells[0x21F], chip.cells[0x240]), (0xFF, 0xFF));
    }

    #[test]
    fn a_cut_leaves_the_first_bytes_new_and_the_last_ones_old() {
        for (whole_page, last) in [(false, [0xFF, 0xFF]), (true, [0xFF ^ 4, 0xFF ^ 5])] {
            let mut chip = waiting(64, &[1, 2, 3, 4, 5]);
            chip.cut = Some(Cut { after: 2, whole_page });
            chip.program();
            assert_eq!(chip.cells[64..67], [1, 2, 0xFF ^ 3]);
            assert_eq!(chip.cells[67..69], last);
            assert!(chip.is_cut());
        }
    }

    #[test]
    fn the_cut_may_come_in_a_later_page() {
        let mut chip = waiting(0, &[1, 2]);
        chip.cut = Some(Cut { after: 3, whole_page: false });
        chip.program();
        assert!(!chip.is_cut());
        chip.page = vec![(32, 7), (33, 8)];
        chip.program();
        assert_eq!((chip.cells[32], chip.is_cut()), (7, true));
    }
}
