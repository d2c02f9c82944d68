//! Slots: the places of the two records, the one that counts, and the one that a save may overwrite.
//!
//! Invariant: a save never touches the slot that holds the newest settings. Transfers stay inside one page, so a power
//! cut spoils no more than the page being written, and the caller can do other things in between.

use super::map::{NEEDED, PAGE, STRIDE, address};
use super::payload::Unknown;
use super::record::{Decoded, LONGEST, Receipt, Rejected, decode, encode, length};
use crate::kinematics::Mechanism;
use crate::port::{Storage, StorageError};
use crate::settings::{Settings, SettingsError};

/// One of the two places for a record.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Slot {
    /// At address 0.
    A,
    /// Behind it.
    B,
}

impl Slot {
    const fn address(self) -> u32 {
        match self {
            Self::A => 0,
            Self::B => STRIDE,
        }
    }

    const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

impl core::fmt::Display for Slot {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::A => "A",
            Self::B => "B",
        })
    }
}

/// Settings found in a slot: whole, of this format and legal.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Stored {
    /// The settings.
    pub settings: Settings,
    /// Settings in the record that this firmware does not know.
    pub unknown: Unknown,
    /// Size and checksum of their record.
    pub receipt: Receipt,
    slot: Slot,
    sequence: u32,
}

impl Stored {
    /// Where the record lies.
    #[must_use]
    pub const fn address(&self) -> u32 {
        self.slot.address()
    }

    /// Whether this was saved after `other`; right for less than 2^31 saves in between.
    const fn is_newer_than(&self, other: &Self) -> bool {
        (other.sequence.wrapping_sub(self.sequence) as i32) < 0
    }
}

/// The contents of the two slots.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Survey {
    /// The newest settings.
    pub newest: Option<Stored>,
    /// Why the content of slot A and of slot B is not used, where it is not valid.
    pub rejected: [(Slot, Option<Rejected>); 2],
}

/// Why settings were not saved. The stored settings from before are still there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SaveError {
    /// The storage does not answer, or there is none.
    Storage(StorageError),
    /// The storage took the bytes but does not give them back: replace it.
    NotKept,
    /// The settings do not fit into a slot, which a compile-time check excludes.
    TooLong,
    /// The settings would be refused when they are read, and all others with them.
    Illegal(SettingsError),
}

impl core::fmt::Display for SaveError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Storage(error) => error.fmt(f),
            Self::NotKept => put!(f, "storage does not keep written data"),
            Self::TooLong => put!(f, "the settings are too long"),
            Self::Illegal(why) => why.fmt(f),
        }
    }
}

impl core::error::Error for SaveError {}

impl From<StorageError> for SaveError {
    fn from(error: StorageError) -> Self {
        Self::Storage(error)
    }
}

/// Whether there is storage in which settings can be kept.
pub fn is_present(storage: &impl Storage) -> bool {
    storage.capacity() >= NEEDED
}

/// Reads both slots, for any machine.
///
/// # Errors
/// The storage's, and [`StorageError::Absent`] if it is too small.
pub async fn survey(storage: &mut impl Storage) -> Result<Survey, StorageError> {
    survey_with(storage, None, &mut [0; LONGEST]).await
}

/// Reads both slots, in a place for a record. With a mechanism only its settings count: the resolutions and lengths of
/// others would be wrong.
///
/// # Errors
/// The storage's, and [`StorageError::Absent`] if it is too small.
pub async fn survey_with(
    storage: &mut impl Storage,
    own: Option<Mechanism>,
    record: &mut [u8; LONGEST],
) -> Result<Survey, StorageError> {
    let mut newest = None;
    let rejected = find_newest(storage, own.as_ref(), &mut newest, record).await?;
    Ok(Survey { newest, rejected })
}

/// Puts the newest settings into their place, and returns why the contents of slots are not used.
async fn find_newest(
    storage: &mut impl Storage,
    own: Option<&Mechanism>,
    newest: &mut Option<Stored>,
    record: &mut [u8; LONGEST],
) -> Result<[(Slot, Option<Rejected>); 2], StorageError> {
    if !is_present(storage) {
        return Err(StorageError::Absent);
    }
    let mut slots = [(Slot::A, None), (Slot::B, None)];
    for (slot, rejected) in &mut slots {
        *rejected = look_at(storage, *slot, own, newest, record).await?.err();
    }
    Ok(slots)
}

/// Takes the record in a slot for the newest, if it is.
async fn look_at(
    storage: &mut impl Storage,
    slot: Slot,
    own: Option<&Mechanism>,
    newest: &mut Option<Stored>,
    record: &mut [u8; LONGEST],
) -> Result<Result<(), Rejected>, StorageError> {
    record.fill(0);
    let length = read_record(storage, slot, record).await?;
    Ok(length.and_then(|()| take_newer(newest, slot, own, record)))
}

/// Takes a slot's content as the newest, if it is. A separate function, because settings are large. Otherwise their
/// copies would be on the stack during the wait for the storage, below all other work.
#[inline(never)]
fn take_newer(newest: &mut Option<Stored>, slot: Slot, own: Option<&Mechanism>, record: &[u8]) -> Result<(), Rejected> {
    let mut settings = Settings::prototype();
    let Decoded { unknown, sequence, receipt } = decode(record, &mut settings)?;
    if own.is_some_and(|own| settings.mechanism != *own) {
        return Err(Rejected::Mechanism);
    }
    let found = Stored { settings, unknown, receipt, slot, sequence };
    if newest.as_ref().is_none_or(|newest| found.is_newer_than(newest)) {
        *newest = Some(found);
    }
    Ok(())
}

/// Saves `settings` and reads them back; writes nothing if they are the newest already.
///
/// # Errors
/// If they are not safely stored; then those stored before still are.
pub async fn save(storage: &mut impl Storage, settings: &Settings) -> Result<Receipt, SaveError> {
    save_with(storage, settings, &mut [0; LONGEST]).await
}

/// The same in a place for a record.
///
/// # Errors
/// If they are not safely stored; then those stored before still are.
pub async fn save_with(
    storage: &mut impl Storage,
    settings: &Settings,
    record: &mut [u8; LONGEST],
) -> Result<Receipt, SaveError> {
    settings.check().map_err(SaveError::Illegal)?;
    // The newest settings are large, and leave the stack before the record comes.
    let (slot, sequence, unknown) = {
        let mut newest = None;
        find_newest(storage, None, &mut newest, record).await?;
        match &newest {
            Some(newest) if newest.settings.has_values_of(settings) => return Ok(newest.receipt),
            Some(newest) => (newest.slot.other(), newest.sequence.wrapping_add(1), newest.unknown),
            None => (Slot::A, 1, Unknown::NONE),
        }
    };
    record.fill(0);
    let receipt = encode(settings, &unknown, sequence, record).ok_or(SaveError::TooLong)?;
    let record = record.get(..receipt.bytes).unwrap_or_default();
    // The header goes last: until then the slot keeps its old content, or is damaged. Memory that must be erased first,
    // such as flash, takes the first of these writes for the begin of a save, because it does not lie below the one
    // before. No other order works.
    for (at, page) in pages(record, slot).rev() {
        storage.write(at, page).await?;
    }
    for (at, page) in pages(record, slot) {
        let mut kept = [0; PAGE];
        let kept = kept.get_mut(..page.len()).unwrap_or_default();
        storage.read(at, kept).await?;
        if kept != page {
            return Err(SaveError::NotKept);
        }
    }
    Ok(receipt)
}

/// The pages of a record and their addresses.
fn pages(record: &[u8], slot: Slot) -> impl DoubleEndedIterator<Item = (u32, &[u8])> {
    record.chunks(PAGE).enumerate().map(move |(i, page)| (slot.address() + address(i * PAGE), page))
}

/// Reads the record in a slot, with the length in its header.
async fn read_record(
    storage: &mut impl Storage,
    slot: Slot,
    record: &mut [u8; LONGEST],
) -> Result<Result<(), Rejected>, StorageError> {
    // The first page says how many follow.
    let (mut at, mut end) = (0, PAGE);
    while at < end {
        let page = record.get_mut(at..end.min(at + PAGE)).unwrap_or_default();
        storage.read(slot.address() + address(at), page).await?;
        if at == 0 {
            end = match length(page) {
                Ok(length) => length,
                Err(why) => return Ok(Err(why)),
            };
        }
        at += PAGE;
    }
    Ok(Ok(()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newer_record_is_found_across_the_wrap() {
        let receipt = Receipt { bytes: 0, crc: 0 };
        let unknown = Unknown::NONE;
        let at = |sequence| Stored { settings: Settings::prototype(), unknown, receipt, slot: Slot::A, sequence };
        assert!(at(2).is_newer_than(&at(1)) && !at(1).is_newer_than(&at(2)));
        assert!(at(0).is_newer_than(&at(u32::MAX)) && !at(u32::MAX).is_newer_than(&at(0)));
        assert!(!at(5).is_newer_than(&at(5)));
    }

    #[test]
    fn slots_and_errors_have_texts_for_users() {
        extern crate std;
        use std::string::ToString as _;
        assert_eq!([Slot::A.to_string(), Slot::B.to_string()], ["A", "B"]);
        let errors = [SaveError::Storage(StorageError::Failed), SaveError::NotKept, SaveError::TooLong];
        let texts = ["storage does not answer", "storage does not keep written data", "the settings are too long"];
        assert_eq!(errors.map(|error| error.to_string()), texts);
        let illegal = SaveError::Illegal(SettingsError::OutOfRangeBeside("advance.window"));
        assert_eq!(illegal.to_string(), "advance.window is outside its legal range");
    }
}
