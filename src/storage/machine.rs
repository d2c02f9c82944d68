//! The machine to start as: motors are put together before the Console runs, so the mechanism is looked for first.

use super::record::{LONGEST, Rejected, decode, encode};
use super::slots::survey;
use crate::port::Storage;
use crate::settings::Settings;

/// The newest settings that are stored, if they are those of a machine that is put together in another way than `made`
/// ([`Settings::is_built_as`]): a board is then started as that machine. All else in them is for the Console, which looks again, and tells what
/// it finds.
pub async fn other_machine(storage: &mut impl Storage, made: &Settings) -> Option<Settings> {
    let stored = survey(storage).await.ok()?.newest?.settings;
    (!stored.is_built_as(made) && stored.check_machine().is_ok()).then_some(stored)
}

/// The machine in a record.
///
/// # Errors
/// Why there is none.
pub fn machine_in(record: &[u8]) -> Result<Settings, Rejected> {
    let (settings, ..) = decode(record)?;
    settings.check_machine().map_err(Rejected::Illegal)?;
    Ok(settings)
}

/// Writes the record of a machine, and says how long it is; `None` if it does not fit, which a compile-time check excludes.
pub fn record_of(machine: &Settings, into: &mut [u8; LONGEST]) -> Option<usize> {
    let record = encode(machine, 0)?;
    *into = record.bytes;
    Some(record.receipt.bytes)
}
