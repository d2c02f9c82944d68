//! Pages of settings in the processor's flash, which erases 16 KiB at a time.
//!
//! The crate `sequential-storage` keeps each page as the value of its number in a log that goes round the sectors, so
//! a save costs no erasing but one in some twenty, and a power cut in any operation leaves a page old or new. It costs
//! 18 KiB of flash, which this board has to spare. Our own version would be a few hundred lines that fewer people test.
//! Two copies in turns, as the core keeps them, make up for what is left: a log that is damaged beyond repair.
//!
//! What does not hold yet: `sequential-storage` judges a sector by its first and its last byte. An erase that is cut so that the first is
//! as it was and the last is erased, or that both are erased and cells in between are not, is not noticed, and both copies may be lost. A sector
//! for each copy, erased before each save, would not need to judge; it has to read today's log once.
//!
//! To find a page, all items of the log are looked through, 4 ms if it is full (in the emulator); when it goes round, that was done for each of its
//! items, so that the Console hung for seconds. So where each page lies is found out once, at the start, and kept in RAM.

use core::ops::Range;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use corehbot::port::StorageError;
use corehbot::storage::{NEEDED, PAGE};
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::Error;
use sequential_storage::cache::Cache;
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::page_pointers::ArrayPagePointers;
use sequential_storage::cache::page_states::ArrayPageStates;
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

/// How many pages there are, and how many sectors.
const PAGES: usize = NEEDED as usize / PAGE;
const RING: usize = ((SECTORS.end - SECTORS.start) / SECTOR) as usize;

type Places = Cache<ArrayPageStates<RING>, ArrayPagePointers<RING>, ArrayKeyPointers<u8, PAGES>, u8>;
type Map<F> = MapStorage<u8, F, Places>;

/// Memory of the size that the settings need, in flash.
pub struct FlashPages<F: NorFlash> {
    map: Map<F>,
    /// Pages that may be in the log; others are blank.
    exists: [bool; PAGES],
}

impl<F: NorFlash> FlashPages<F> {
    /// The pages in the sectors of `flash`, whose first byte has address 0. Looks for all of them: 0.13 s for 33 pages in a
    /// log that is nearly full, in the emulator.
    pub fn new(flash: F) -> Self {
        let places = Cache::new(ArrayPageStates::new(), ArrayPagePointers::new(), ArrayKeyPointers::new());
        let mut map = Map::new(flash, const { MapConfig::new(SECTORS) }, places);
        // Whoever reads a page is told what is wrong.
        let exists = now(find(&mut map)).ok().and_then(Result::ok).unwrap_or([true; PAGES]);
        Self { map, exists }
    }

    /// The flash, as it is.
    pub fn into_flash(self) -> F {
        self.map.destroy().0
    }

    /// One page; blank if it was never written, or if the sectors hold something else.
    fn page(&mut self, number: u8) -> Result<[u8; PAGE], StorageError> {
        if !self.exists.get(usize::from(number)).is_some_and(|exists| *exists) {
            return Ok([0xFF; PAGE]);
        }
        let mut room = [0; ROOM];
        match now(self.map.fetch_item::<[u8; PAGE]>(&mut room, &number))? {
            Ok(found) => Ok(found.unwrap_or([0xFF; PAGE])),
            Err(Error::Corrupted { .. }) => Ok([0xFF; PAGE]),
            Err(_) => Err(StorageError::Failed),
        }
    }

    fn put(&mut self, number: u8, page: &[u8; PAGE]) -> Result<(), StorageError> {
        if let Some(exists) = self.exists.get_mut(usize::from(number)) {
            *exists = true;
        }
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

/// Finds out which pages are in the log, and where.
async fn find<F: NorFlash>(map: &mut Map<F>) -> Result<[bool; PAGES], Error<F::Error>> {
    let (mut room, mut exists) = ([0; ROOM], [false; PAGES]);
    // Repairs what a power cut has left, which `fetch_all_items` of sequential-storage 8.0.2 does not.
    map.fetch_item::<[u8; PAGE]>(&mut room, &0).await?;
    let mut items = map.fetch_all_items(&mut room).await?;
    while let Some((number, _)) = items.next::<[u8; PAGE]>(&mut room).await? {
        if let Some(exists) = exists.get_mut(usize::from(number)) {
            *exists = true;
        }
    }
    // Which notes the place.
    for (number, _) in (0..).zip(exists).filter(|(_, exists)| *exists) {
        map.fetch_item::<[u8; PAGE]>(&mut room, &number).await?;
    }
    Ok(exists)
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
