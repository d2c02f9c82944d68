//! The log of pages that earlier firmware kept in the two sectors, with `sequential-storage` 8.0.2. It is read, and
//! never written.
//!
//! A sector of it begins with a word whose first byte is zero. Then come items of 44 bytes:
//!
//! | bytes | what |
//! |---|---|
//! | 0..4 | checksum of 8..41 |
//! | 4..6 | how many bytes that are: 33 |
//! | 6..8 | checksum of these two |
//! | 8 | number of the page |
//! | 9..41 | the page |
//!
//! Of several items of a page the last one counts. A power cut may have put a damaged word between two items.
//!
//! One sector holds all that counts, in any state that a power cut may leave: when it is full, the newest item of each
//! page is copied to the other sector, and it is erased when that is done. So each sector is looked at by itself, and
//! the newest record in its log is shown as that of its slot. Which of two is the newer one the core sees by their
//! numbers, and it saves to the other. The note of the last self-test is left behind, which costs a self-test.
//!
//! Reading it with the crate itself would cost 18 KiB of flash; and the crate repairs what it takes for damaged, by
//! erasing.

use corehbot::port::{Storage, StorageError};
use corehbot::storage::{LONGEST, NEEDED, PAGE, survey};
use embassy_futures::block_on;

use crate::flash_sectors::{SECTOR, Sectors, WORD};

/// Bytes of an item, and what lies where in it.
const ITEM: usize = 44;
const LENGTHS: core::ops::Range<usize> = 4..8;
const DATA: core::ops::Range<usize> = 8..41;
const PAGE_IN_ITEM: u32 = 9;

/// How many pages a log may have.
const PAGES: usize = NEEDED as usize / PAGE;

/// How many a record may have.
const RECORD_PAGES: usize = LONGEST.div_ceil(PAGE);

const _: () = assert!(DATA.end - DATA.start == 1 + PAGE && PAGES <= 256 && SECTOR <= 1 << 16);

/// A record in the log of a sector.
pub struct LogRecord {
    /// Where its pages lie in the sector; 0 for those that are not there.
    places: [u16; RECORD_PAGES],
}

impl LogRecord {
    /// The newest record in a sector that is whole and legal, by the core's rules. Reads all of the sector.
    ///
    /// # Errors
    /// Those of the flash.
    pub fn newest(flash: &mut impl Sectors, sector: u32) -> Result<Option<Self>, StorageError> {
        let Some(places) = find(flash, sector)? else { return Ok(None) };
        let mut log = Log { flash, sector, places: &places };
        let Some(newest) = block_on(survey(&mut log))?.newest else { return Ok(None) };
        let mut record = [0; RECORD_PAGES];
        let pages = places.iter().skip(newest.address() as usize / PAGE).take(newest.receipt.bytes.div_ceil(PAGE));
        record.iter_mut().zip(pages).for_each(|(to, place)| *to = *place);
        Ok(Some(Self { places: record }))
    }

    /// Where in the sector a page of the record lies, if it is one.
    pub fn page_at(&self, number: usize) -> Option<u32> {
        self.places.get(number).filter(|place| **place != 0).map(|place| u32::from(*place))
    }
}

/// Where each page lies in the log of a sector, 0 for those that it does not have; `None` if it has none.
#[inline(never)]
fn find(flash: &mut impl Sectors, sector: u32) -> Result<Option<[u16; PAGES]>, StorageError> {
    let (mut places, mut is_empty) = ([0; PAGES], true);
    let mut at = WORD;
    while at + ITEM as u32 <= SECTOR - WORD {
        let Some(number) = page_of_item(flash, sector + at)? else {
            at += WORD;
            continue;
        };
        if let Some(place) = places.get_mut(usize::from(number)) {
            *place = (at + PAGE_IN_ITEM) as u16;
            is_empty = false;
        }
        at += ITEM as u32;
    }
    Ok((!is_empty).then_some(places))
}

/// The number of the page in the item at `at`, if there is a whole one.
fn page_of_item(flash: &mut impl Sectors, at: u32) -> Result<Option<u8>, StorageError> {
    let mut lengths = [0; LENGTHS.end - LENGTHS.start];
    flash.read(at + LENGTHS.start as u32, &mut lengths)?;
    if lengths != const { lengths_of_page() } {
        return Ok(None);
    }
    let mut item = [0; ITEM];
    flash.read(at, &mut item)?;
    let data = item.get(DATA).unwrap_or_default();
    let is_whole = item.starts_with(&data_checksum(data).to_le_bytes());
    Ok(data.first().copied().filter(|_| is_whole))
}

/// The length that every item has, and its checksum: CRC-16F/4.2 (P. Koopman), never 0xFFFF.
const fn lengths_of_page() -> [u8; 4] {
    let length = (1 + PAGE) as u16;
    let [low, high] = length.to_le_bytes();
    let mut crc = u16::MAX;
    let mut i = 0;
    while i < 16 {
        crc ^= match i {
            0 => low as u16,
            8 => high as u16,
            _ => 0,
        };
        crc = (crc >> 1) ^ if crc & 1 == 1 { 0x1A2E } else { 0 };
        i += 1;
    }
    let crc = !crc;
    let [c, d] = (if crc == u16::MAX { 0xFFFE } else { crc }).to_le_bytes();
    [low, high, c, d]
}

/// The checksum of an item's data: CRC-32C with another begin, and with a first byte that is neither 0 nor 0xFF.
fn data_checksum(data: &[u8]) -> u32 {
    let mut crc = 0xEEEE_EEEE_u32;
    for byte in data {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            let divisor = if crc & 1 == 1 { 0x82F6_3B78 } else { 0 };
            crc = (crc >> 1) ^ divisor;
        }
    }
    match !crc {
        0 => 1,
        crc if matches!(crc & 0xFF, 0 | 0xFF) => crc ^ 1,
        crc => crc,
    }
}

/// The log as memory that is only read, for the core's survey.
struct Log<'f, F: Sectors> {
    flash: &'f mut F,
    sector: u32,
    places: &'f [u16; PAGES],
}

impl<F: Sectors> Storage for Log<'_, F> {
    fn capacity(&self) -> u32 {
        NEEDED
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        match self.places.get(at as usize / PAGE) {
            None => Err(StorageError::Absent),
            Some(0) => {
                into.fill(0xFF);
                Ok(())
            }
            Some(place) => {
                let begin = self.sector + u32::from(*place) + at % PAGE as u32;
                self.flash.read(begin, into)
            }
        }
    }

    async fn write(&mut self, _at: u32, _bytes: &[u8]) -> Result<(), StorageError> {
        Err(StorageError::Failed)
    }
}
