//! The pages as earlier firmware kept them: a log by `sequential-storage`.

use crate::nor::Nor;
use corehbot::port::{Storage, StorageError};
use corehbot::storage::{NEEDED, PAGE};
use corehbot_stm32f446::flash_sectors::{SECTOR, SECTORS};
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use sequential_storage::Error;
use sequential_storage::cache::Cache;
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::page_pointers::ArrayPagePointers;
use sequential_storage::cache::page_states::ArrayPageStates;
use sequential_storage::map::{MapConfig, MapStorage};

const PAGES: usize = NEEDED as usize / PAGE;
type Places = Cache<ArrayPageStates<2>, ArrayPagePointers<2>, ArrayKeyPointers<u8, PAGES>, u8>;

/// Memory for settings in a log.
pub struct EarlierPages(MapStorage<u8, Nor, Places>);

impl EarlierPages {
    pub fn new(flash: Nor) -> Self {
        let places = Cache::new(ArrayPageStates::new(), ArrayPagePointers::new(), ArrayKeyPointers::new());
        Self(MapStorage::new(flash, const { MapConfig::new(SECTORS) }, places))
    }

    pub fn into_flash(self) -> Nor {
        self.0.destroy().0
    }

    async fn page(&mut self, number: u8) -> Result<[u8; PAGE], StorageError> {
        match self.0.fetch_item::<[u8; PAGE]>(&mut [0; 40], &number).await {
            Ok(found) => Ok(found.unwrap_or([0xFF; PAGE])),
            Err(Error::Corrupted { .. }) => Ok([0xFF; PAGE]),
            Err(_) => Err(StorageError::Failed),
        }
    }
}

impl Storage for EarlierPages {
    fn capacity(&self) -> u32 {
        NEEDED
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        let page = self.page((at / PAGE as u32) as u8).await?;
        into.copy_from_slice(&page[at as usize % PAGE..][..into.len()]);
        Ok(())
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let number = (at / PAGE as u32) as u8;
        let mut page = self.page(number).await?;
        page[at as usize % PAGE..][..bytes.len()].copy_from_slice(bytes);
        self.0.store_item(&mut [0; 40], &number, &page).await.map_err(|_| StorageError::Failed)
    }
}

/// The power is gone.
#[derive(Debug)]
pub struct Dead;

impl NorFlashError for Dead {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Nor {
    type Error = Dead;
}

impl ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), Dead> {
        self.look(at, into);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.cells.len()
    }
}

impl NorFlash for Nor {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR as usize;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Dead> {
        (from..to).step_by(SECTOR as usize).try_for_each(|at| self.erase_sector(at))
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), Dead> {
        self.program_words(at, bytes)
    }
}
