//! The machine to start as: motors are put together before the Console runs, so the mechanism is looked for first.

use super::payload::Unknown;
use super::record::{LONGEST, Rejected, decode, encode};
use super::slots::survey;
use crate::port::Storage;
use crate::settings::Settings;

/// The machine that is stored, if there is one.
pub async fn stored_machine(storage: &mut impl Storage) -> Option<Settings> {
    let stored = survey(storage).await.ok()?.newest?.settings;
    stored.check_machine().is_ok().then_some(stored)
}

/// The machine in a record.
///
/// # Errors
/// Why there is no machine.
pub fn machine_in(record: &[u8]) -> Result<Settings, Rejected> {
    let mut settings = Settings::prototype();
    decode(record, &mut settings)?;
    settings.check_machine().map_err(Rejected::Illegal)?;
    Ok(settings)
}

/// Writes the record of a machine, and returns its length; `None` if it does not fit, which a compile-time check
/// excludes.
pub fn record_of(machine: &Settings, into: &mut [u8; LONGEST]) -> Option<usize> {
    encode(machine, &Unknown::NONE, 0, into).map(|receipt| receipt.bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_has_the_machine_that_was_written_and_says_how_long_it_is() {
        let machine = Settings::prototype();
        let mut bytes = [0; LONGEST];
        let length = record_of(&machine, &mut bytes).unwrap();
        assert_eq!(machine_in(&bytes[..length]), Ok(machine));
        // All of it counts.
        assert_eq!(machine_in(&bytes[..length - 1]).ok(), None);
    }
}
