//! The EEPROM: 4 KiB like an AT24C32, in memory or as an image file.
//!
//! Every write goes to the file at once, so a simulator that is killed has had its power cut.

use anyhow::{Context as _, Result, anyhow, bail, ensure};
use corehbot::port::{Storage, StorageError};
use corehbot::settings::Settings;
use corehbot::storage::{note_passed_test, passed_test, save, survey};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Bytes of an AT24C32.
pub const SIZE: usize = 4096;

/// The content of an erased cell.
const BLANK: u8 = 0xFF;

/// The memory, and the file that keeps it.
#[derive(Debug)]
pub struct Eeprom {
    cells: Vec<u8>,
    file: Option<File>,
    writes: u32,
}

impl Eeprom {
    /// A new one, without a file.
    #[must_use]
    pub fn blank() -> Self {
        Self { cells: vec![BLANK; SIZE], file: None, writes: 0 }
    }

    /// An EEPROM with its image in a file; a missing file becomes a blank one.
    ///
    /// # Errors
    /// If the file cannot be read and written, or is not an image.
    pub fn open(path: &Path) -> Result<Self> {
        let named = |what: &str| format!("cannot {what} {}", path.display());
        let mut cells = vec![BLANK; SIZE];
        let file = match OpenOptions::new().read(true).write(true).open(path) {
            Ok(mut file) => {
                cells.clear();
                file.read_to_end(&mut cells).with_context(|| named("read"))?;
                ensure!(
                    cells.len() == SIZE,
                    "{} is not an image of an EEPROM: its size is not {SIZE} bytes",
                    path.display()
                );
                file
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let mut file = File::create_new(path).with_context(|| named("create"))?;
                file.write_all(&cells).with_context(|| named("write"))?;
                file
            }
            Err(error) => return Err(error).with_context(|| named("open")),
        };
        Ok(Self { cells, file: Some(file), writes: 0 })
    }

    /// The settings that a firmware would find in it.
    pub fn settings(&mut self) -> Option<Settings> {
        let mut eeprom = self;
        let survey = pin!(survey(&mut eeprom)).poll(&mut Context::from_waker(Waker::noop()));
        // Nothing waits here, so the future is ready at once.
        let Poll::Ready(Ok(survey)) = survey else { return None };
        survey.newest.map(|stored| stored.settings)
    }

    /// Stores settings, as M500 does.
    ///
    /// # Errors
    /// If they could not be kept.
    pub fn save(&mut self, settings: &Settings) -> Result<()> {
        let mut eeprom = self;
        let save = pin!(save(&mut eeprom, settings)).poll(&mut Context::from_waker(Waker::noop()));
        match save {
            Poll::Ready(Ok(_)) => Ok(()),
            Poll::Ready(Err(error)) => Err(anyhow!("the settings cannot be stored: {error:?}")),
            // Nothing waits here, so the future is ready at once.
            Poll::Pending => bail!("the settings cannot be stored"),
        }
    }

    /// Notes that a self-test was passed, as a firmware does.
    ///
    /// # Errors
    /// If that could not be kept.
    pub fn note_self_test(&mut self, tested: u32) -> Result<()> {
        let mut eeprom = self;
        let note = pin!(note_passed_test(&mut eeprom, tested)).poll(&mut Context::from_waker(Waker::noop()));
        ensure!(note == Poll::Ready(Ok(())), "the note of a self-test cannot be stored");
        Ok(())
    }

    /// The note of the last self-test that was passed.
    pub fn self_test(&mut self) -> Option<u32> {
        let mut eeprom = self;
        let note = pin!(passed_test(&mut eeprom)).poll(&mut Context::from_waker(Waker::noop()));
        let Poll::Ready(Ok(note)) = note else { return None };
        note
    }

    /// Its content, to read and to damage.
    pub fn cells(&mut self) -> &mut [u8] {
        &mut self.cells
    }

    /// How often something was written.
    #[must_use]
    pub const fn writes(&self) -> u32 {
        self.writes
    }

    /// The cells of `size` bytes from `at` on.
    fn range(&self, at: u32, size: usize) -> Result<Range<usize>, StorageError> {
        let begin = usize::try_from(at).map_err(|_| StorageError::Absent)?;
        let end = begin.checked_add(size).filter(|end| *end <= self.cells.len());
        end.map(|end| begin..end).ok_or(StorageError::Absent)
    }
}

impl Storage for &mut Eeprom {
    fn capacity(&self) -> u32 {
        SIZE as u32
    }

    async fn read(&mut self, at: u32, into: &mut [u8]) -> Result<(), StorageError> {
        let range = self.range(at, into.len())?;
        into.copy_from_slice(&self.cells[range]);
        Ok(())
    }

    async fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), StorageError> {
        let range = self.range(at, bytes.len())?;
        self.writes += 1;
        self.cells[range].copy_from_slice(bytes);
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        let written = file.seek(SeekFrom::Start(u64::from(at))).and_then(|_| file.write_all(bytes));
        written.map_err(|_| StorageError::Failed)
    }
}
