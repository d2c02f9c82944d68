//! Pages of settings in the processor's flash, which erases 16 KiB at a time.
//!
//! The crate `sequential-storage` keeps each page as the value of its number in a log that goes round the sectors, so
//! a save costs no erasing but one in some twenty, and a power cut in any operation leaves a page old or new. It costs
//! 18 KiB of flash, which this board has to spare. Our own version would be a few hundred lines that fewer people test.
//! Two copies in turns, as the core keeps them, make up for what is left: a log that is damaged beyond repair.

use core::ops::Range;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use corehbot::port::StorageError;
use corehbot::storage::{NEEDED, PAGE};
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::Error;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

use crate::memory::Memory;

/// The sectors that are put aside: 1 and 2, of 16 KiB each (RM0390, 3.3). The vectors stay in sector 0, where the
/// processor looks for them, and the code begins after them (`settings.x` of the board).
pub const SECTORS: Range<u32> = 0x4000..0xC000;

/// Size of one of them.
pub const SECTOR: u32 = 0x4000;

/// Room for a page and its number, in whole words.
const ROOM: usize = 40;
const _: () = assert!(PAGE < ROOM && NEEDED / PAGE as u32 <= 256);

type Map<F> = MapStorage<u8, F, Cache<Uncached, Uncached, Uncached, u8>>;

/// Memory of the size that the settings need, in flash.
pub struct FlashPages<F: NorFlash> {
    map: Map<F>,
}

impl<F: NorFlash> FlashPages<F> {
    /// The pages in the sectors of `flash`, whose first byte has address 0.
    pub const fn new(flash: F) -> Self {
        Self { map: Map::new(flash, const { MapConfig::new(SECTORS) }, Cache::new_uncached()) }
    }

    /// The flash, as it is.
    pub fn into_flash(self) -> F {
        self.map.destroy().0
    }

    /// One page; blank if it was never written, or if the sectors hold something else.
    fn page(&mut self, number: u8) -> Result<[u8; PAGE], StorageError> {
        let mut room = [0; ROOM];
        match now(self.map.fetch_item::<[u8; PAGE]>(&mut room, &number))? {
            Ok(found) => Ok(found.unwrap_or([0xFF; PAGE])),
            Err(Error::Corrupted { .. }) => Ok([0xFF; PAGE]),
            Err(_) => Err(StorageError::Failed),
        }
    }

    fn put(&mut self, number: u8, page: &[u8; PAGE]) -> Result<(), StorageError> {
        let mut room = [0; ROOM];
        match now(self.map.store_item(&mut room, &number, page))? {
            Ok(()) => return Ok(()),
            // Nothing in there can be read, so nothing is lost: code of an older image, most likely.
            Err(Error::Corrupted { .. }) => {}
            Err(_) => return Err(StorageError::Failed),
        }
        now(self.map.erase_all())?.map_err(|_| StorageError::Failed)?;
        now(self.map.store_item(&mut room, &number, page))?.map_err(|_| StorageError::Failed)
    }
}

/// The result of a future that never waits, as all are whose flash does not.
fn now<T>(future: impl Future<Output = T>) -> Result<T, StorageError> {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => Ok(result),
        Poll::Pending => Err(StorageError::Failed),
    }
}

/// The page that holds `size` bytes at `at`, and where in it they begin.
fn place(at: u32, size: usize) -> Result<(u8, usize), StorageError> {
    let begin = at as usize % PAGE;
    let number = u8::try_from(at / PAGE as u32).map_err(|_| StorageError::Absent)?;
    if at >= NEEDED {
        return Err(StorageError::Absent);
    }
    if begin + size <= PAGE { Ok((number, begin)) } else { Err(StorageError::Failed) }
}

impl<F: NorFlash> Memory for FlashPages<F> {
    fn capacity(&self) -> u32 {
        NEEDED
    }

    fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        let (number, begin) = place(at, into.len())?;
        let page = self.page(number)?;
        into.iter_mut().zip(page.iter().skip(begin)).for_each(|(to, byte)| *to = *byte);
        Ok(())
    }

    /// Takes a millisecond or two, and up to 0.5 s when a sector is erased.
    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let (number, begin) = place(at, bytes.len())?;
        let mut page = self.page(number)?;
        page.iter_mut().skip(begin).zip(bytes).for_each(|(to, byte)| *to = *byte);
        self.put(number, &page)
    }

    fn is_done(&mut self) -> Result<bool, StorageError> {
        Ok(true)
    }
}
