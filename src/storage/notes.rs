//! Notes of a number each, in the last page: what a machine has found out, which is no setting.
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | the number |
//! | 4..8 | CRC-32 of the note's mark and these bytes |
//!
//! | note | mark | number |
//! |---|---|---|
//! | the last self-test that was passed: heaters need none before the next update | `CHBT` | the tested heaters |
//! | the load that a mm of strain takes, of two residuals of the belt | `CHBL` | 16 bits for each; 0 is not known |
//! | the baseline of a heater: power and movement | the sum of its model | 16 bits for each, 8 fractional |

use super::map::{BASELINES, BELT_LOADS, SELF_TEST};
use crate::checksum::crc32;
use crate::port::{Storage, StorageError};

/// A note: its address and its mark.
struct Note(u32, [u8; 4]);

const TEST: Note = Note(SELF_TEST, *b"CHBT");
const LOADS: Note = Note(BELT_LOADS, *b"CHBL");

impl Note {
    /// Checksum of a number.
    fn check(&self, number: [u8; 4]) -> [u8; 4] {
        crc32(&[&self.1, &number]).to_le_bytes()
    }

    /// The number; `None` if there is none, or if the note is not whole.
    async fn read(&self, storage: &mut impl Storage) -> Result<Option<u32>, StorageError> {
        let mut bytes = [0; 8];
        storage.read(self.0, &mut bytes).await?;
        let [a, b, c, d, check @ ..] = bytes;
        let number = [a, b, c, d];
        Ok((check == self.check(number)).then_some(u32::from_le_bytes(number)))
    }

    /// Notes a number. A power cut in between costs the note.
    async fn write(&self, storage: &mut impl Storage, number: u32) -> Result<(), StorageError> {
        let number = number.to_le_bytes();
        let ([a, b, c, d], [e, f, g, h]) = (number, self.check(number));
        storage.write(self.0, &[a, b, c, d, e, f, g, h]).await
    }
}

/// The subject of the last self-test that was passed; `None` if there was none, or if its note is not whole.
///
/// # Errors
/// The storage's.
pub async fn passed_test(storage: &mut impl Storage) -> Result<Option<u32>, StorageError> {
    TEST.read(storage).await
}

/// Notes that a self-test of this was passed. A power cut in between costs another test.
///
/// # Errors
/// The storage's.
pub async fn note_passed_test(storage: &mut impl Storage, tested: u32) -> Result<(), StorageError> {
    TEST.write(storage, tested).await
}

/// The load that a mm of strain took of each residual when it was measured; 0 is not known.
///
/// # Errors
/// The storage's.
pub async fn belt_loads(storage: &mut impl Storage) -> Result<[u16; 2], StorageError> {
    let both = LOADS.read(storage).await?.unwrap_or_default();
    Ok([both as u16, (both >> 16) as u16])
}

/// Notes these loads. A power cut in between costs the comparison with the next ones.
///
/// # Errors
/// The storage's.
pub async fn note_belt_loads(storage: &mut impl Storage, [first, second]: [u16; 2]) -> Result<(), StorageError> {
    LOADS.write(storage, u32::from(first) | u32::from(second) << 16).await
}

/// The baseline of a heater, 0 the hotend and 1 the bed, for the model with this sum; `None` if there is none, if it
/// is of another model, or if its note is not whole.
///
/// # Errors
/// The storage's.
pub async fn baseline(
    storage: &mut impl Storage,
    heater: usize,
    subject: u32,
) -> Result<Option<[u16; 2]>, StorageError> {
    let Some(place) = BASELINES.get(heater) else { return Ok(None) };
    let both = Note(*place, subject.to_le_bytes()).read(storage).await?;
    Ok(both.map(|both| [both as u16, (both >> 16) as u16]).filter(|both| *both != [0; 2]))
}

/// Notes the baseline of a heater for the model with this sum; zeros erase it. A power cut in between costs it.
///
/// # Errors
/// The storage's.
pub async fn note_baseline(
    storage: &mut impl Storage,
    heater: usize,
    subject: u32,
    [power, less]: [u16; 2],
) -> Result<(), StorageError> {
    let Some(place) = BASELINES.get(heater) else { return Ok(()) };
    Note(*place, subject.to_le_bytes()).write(storage, u32::from(power) | u32::from(less) << 16).await
}
