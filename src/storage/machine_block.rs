//! The machine block: a place in every image that holds a machine, so that an image is made for a machine without a compiler.
//!
//! | bytes | what |
//! |---|---|
//! | 0..16 | [`MARK`], which stands nowhere else in an image |
//! | 16..24 | the key of the board that the image is for |
//! | 24.. | a [record](super::record), or 0xFF throughout: no machine |

use super::machine::machine_in;
use super::record::{LONGEST, Receipt, Rejected, encode};
use crate::connectors::ConnectorName;
use crate::settings::Settings;

/// What a block begins with.
pub const MARK: [u8; 16] = *b"corehbot machine";

/// Where the record begins.
const HEAD: usize = MARK.len() + ConnectorName::LONGEST;

/// Bytes of a block.
pub const BLOCK: usize = HEAD + LONGEST;

/// A block without a machine, in an image for the board of that key.
#[must_use]
pub const fn blank_block(board: &str) -> [u8; BLOCK] {
    let mut block = [0xFF; BLOCK];
    let (head, _) = block.split_at_mut(HEAD);
    let (mark, key) = head.split_at_mut(MARK.len());
    mark.copy_from_slice(&MARK);
    key.copy_from_slice(ConnectorName::lit(board).as_bytes());
    block
}

/// The machine in a block.
///
/// # Errors
/// Why there is none.
pub fn machine_of(block: &[u8; BLOCK]) -> Result<Settings, Rejected> {
    let (_, record) = block.split_at(HEAD);
    machine_in(record)
}

/// The key of the board that the image of a block is for, or `None` if the bytes are no block.
#[must_use]
pub fn board_of(block: &[u8; BLOCK]) -> Option<ConnectorName> {
    let key = block.strip_prefix(&MARK)?.first_chunk()?;
    ConnectorName::from_bytes(*key)
}

/// Puts a machine into a block; `None` if it does not fit, which a compile-time check of records excludes.
pub fn put_machine(block: &mut [u8; BLOCK], machine: &Settings) -> Option<Receipt> {
    let record = encode(machine, 0)?;
    let (_, place) = block.split_at_mut(HEAD);
    place.fill(0xFF);
    let used = record.bytes.get(..record.receipt.bytes)?;
    place.get_mut(..used.len())?.copy_from_slice(used);
    Some(record.receipt)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_gives_back_the_machine_that_was_put_in() {
        let mut block = blank_block("octopus");
        assert_eq!(machine_of(&block), Err(Rejected::Blank));
        assert_eq!(board_of(&block), ConnectorName::new("octopus"));
        let machine = Settings::prototype();
        let receipt = put_machine(&mut block, &machine).unwrap();
        assert_eq!(machine_of(&block), Ok(machine));
        assert_eq!(board_of(&block), ConnectorName::new("octopus"));
        // Every bit counts.
        for at in 0..receipt.bytes {
            block[HEAD + at] ^= 1 << (at % 8);
            assert!(machine_of(&block).is_err(), "{at}");
            block[HEAD + at] ^= 1 << (at % 8);
        }
        block[0] = 0;
        assert_eq!(board_of(&block), None);
    }

    #[test]
    fn what_is_no_machine_is_refused() {
        let mut loose = Settings::prototype();
        loose.mechanism.rows = Default::default();
        let mut block = blank_block("octopus");
        put_machine(&mut block, &loose).unwrap();
        assert!(matches!(machine_of(&block), Err(Rejected::Illegal(_))));
    }
}
