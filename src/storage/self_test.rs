//! The note of the last self-test that was passed, in the last page: heaters need none before the next update.
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | the tested heaters, as one number |
//! | 4..8 | CRC-32 of `CHBT` and these bytes |

use super::map::SELF_TEST;
use crate::checksum::crc32;
use crate::port::{Storage, StorageError};

const MAGIC: [u8; 4] = *b"CHBT";

/// Checksum of a note.
fn check(tested: [u8; 4]) -> [u8; 4] {
    crc32(MAGIC.into_iter().chain(tested)).to_le_bytes()
}

/// The subject of the last self-test that was passed; `None` if there was none, or if its note is not whole.
///
/// # Errors
/// The storage's.
pub async fn passed_test(storage: &mut impl Storage) -> Result<Option<u32>, StorageError> {
    let mut bytes = [0; 8];
    storage.read(SELF_TEST, &mut bytes).await?;
    let [a, b, c, d, check @ ..] = bytes;
    let tested = [a, b, c, d];
    Ok((check == self::check(tested)).then_some(u32::from_le_bytes(tested)))
}

/// Notes that a self-test of this was passed. A power cut in between costs the note, and so another test.
///
/// # Errors
/// The storage's.
pub async fn note_passed_test(storage: &mut impl Storage, tested: u32) -> Result<(), StorageError> {
    let tested = tested.to_le_bytes();
    let ([a, b, c, d], [e, f, g, h]) = (tested, check(tested));
    storage.write(SELF_TEST, &[a, b, c, d, e, f, g, h]).await
}
