//! The machine block: a place in every image that holds a machine, so that an image is made for a machine without a
//! compiler.
//!
//! Boards that differ in pins alone share an image, so the block also says on which of them it is.
//!
//! | bytes | content |
//! |---|---|
//! | 0..16 | [`MARK`], which stands nowhere else in an image |
//! | 16..32 | the key of the board that the image is on, with zeros behind it |
//! | 32..96 | the keys of all boards that it may be on, with a blank after each and zeros behind them |
//! | 96.. | a [record](super::record) of one part, or 0xFF throughout: no machine |

use super::machine::machine_in;
use super::payload::Unknown;
use super::record::{FIRST, LONGEST, Receipt, Rejected, encode};
use crate::connectors::BoardConnectors;
use crate::settings::Settings;

/// The first bytes of a block.
pub const MARK: [u8; 16] = *b"corehbot machine";

/// Bytes of the key of a board.
const KEY: usize = 16;

/// Bytes of the keys of all boards.
const KEYS: usize = 64;

/// Where the record begins.
const HEAD: usize = MARK.len() + KEY + KEYS;

/// Bytes of a block. It stays as it is: a block of another size would reach into the program of earlier images.
pub const BLOCK: usize = HEAD + FIRST;

/// A block without a machine, in an image that may be on any of these boards, and is on the first. One that the block
/// has no room for does not compile in a `const`.
#[must_use]
pub const fn blank_block(boards: &[&BoardConnectors]) -> [u8; BLOCK] {
    let mut block = [0xFF; BLOCK];
    let (head, _) = block.split_at_mut(HEAD);
    let (mark, head) = head.split_at_mut(MARK.len());
    mark.copy_from_slice(&MARK);
    let (key, mut keys) = head.split_at_mut(KEY);
    if let [first, ..] = boards {
        put_text(key, first.key);
    }
    let mut boards = boards;
    while let [board, others @ ..] = boards {
        keys = put_text(keys, board.key);
        assert!(!keys.is_empty(), "too many boards");
        let (blank, after) = keys.split_at_mut(1);
        blank.copy_from_slice(b" ");
        (boards, keys) = (others, after);
    }
    put_text(keys, "");
    block
}

/// Puts a text and zeros after it into `place`; returns the rest of it.
const fn put_text<'p>(place: &'p mut [u8], text: &str) -> &'p mut [u8] {
    assert!(text.len() <= place.len(), "no room for the key of a board");
    let (text_place, mut zeros) = place.split_at_mut(text.len());
    text_place.copy_from_slice(text.as_bytes());
    while let [zero, others @ ..] = zeros {
        *zero = 0;
        zeros = others;
    }
    let (_, behind) = place.split_at_mut(text.len());
    behind
}

/// The machine in a block.
///
/// # Errors
/// Why there is no machine.
pub fn machine_of(block: &[u8; BLOCK]) -> Result<Settings, Rejected> {
    let (_, record) = block.split_at(HEAD);
    machine_in(record)
}

/// The key of the board that the image of a block is on, if it is one of those that it may be on.
// The mark is not checked: that would put it into images a second time.
#[must_use]
pub fn board_of(block: &[u8; BLOCK]) -> Option<&str> {
    let key = block.get(MARK.len()..MARK.len() + KEY)?.split(|byte| *byte == 0).next()?;
    core::str::from_utf8(key).ok().filter(|key| boards_of(block).any(|board| board == *key))
}

/// The keys of the boards that the image of a block may be on.
pub fn boards_of(block: &[u8; BLOCK]) -> impl Iterator<Item = &str> {
    let keys = block.get(MARK.len() + KEY..HEAD).unwrap_or_default();
    let keys = keys.split(|byte| *byte == b' ').filter(|key| !key.contains(&0));
    keys.filter_map(|key| core::str::from_utf8(key).ok())
}

/// Says on which board the image of a block is. False if it knows no such board; then nothing has changed.
#[must_use]
pub fn choose_board(block: &mut [u8; BLOCK], key: &str) -> bool {
    let is_known = boards_of(block).any(|board| board == key);
    let place = block.get_mut(MARK.len()..MARK.len() + KEY).filter(|place| is_known && key.len() <= place.len());
    let Some(place) = place else { return false };
    let key = key.bytes().chain(core::iter::repeat(0));
    place.iter_mut().zip(key).for_each(|(to, byte)| *to = byte);
    true
}

/// Takes the machine out of a block.
pub fn clear_machine(block: &mut [u8; BLOCK]) {
    block.split_at_mut(HEAD).1.fill(0xFF);
}

/// Puts a machine into a block; `None` if its record has two parts, and then nothing has changed.
pub fn put_machine(block: &mut [u8; BLOCK], machine: &Settings) -> Option<Receipt> {
    let mut record = [0; LONGEST];
    let receipt = encode(machine, &Unknown::NONE, 0, &mut record)?;
    let (_, place) = block.split_at_mut(HEAD);
    let used = record.get(..receipt.bytes).filter(|used| used.len() <= place.len())?;
    place.fill(0xFF);
    place.get_mut(..used.len())?.copy_from_slice(used);
    Some(receipt)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::connectors::samples::{BENCH, PRINTER};
    use std::vec::Vec;

    #[test]
    fn an_image_is_on_one_of_its_boards() {
        let mut block = blank_block(&[&PRINTER, &BENCH]);
        assert_eq!(boards_of(&block).collect::<Vec<_>>(), ["printer", "bench"]);
        assert_eq!(board_of(&block), Some("printer"));
        let before = block;
        assert!(!choose_board(&mut block, "sim") && !choose_board(&mut block, "") && block == before);
        assert!(choose_board(&mut block, "bench"));
        assert_eq!((board_of(&block), machine_of(&block)), (Some("bench"), Err(Rejected::Blank)));
        assert!(choose_board(&mut block, "printer") && block == before);
        for (at, byte) in [(MARK.len(), b'P'), (MARK.len() + KEY, b'P'), (MARK.len(), 0xFF)] {
            let mut spoilt = before;
            spoilt[at] = byte;
            assert_eq!(board_of(&spoilt), None, "{at}");
        }
    }

    #[test]
    fn the_parts_of_a_block_lie_where_images_of_earlier_versions_have_them() {
        let mut block = blank_block(&[&PRINTER, &BENCH]);
        let receipt = put_machine(&mut block, &Settings::prototype()).unwrap();
        let text = |place: &[u8], text: &str| {
            place.starts_with(text.as_bytes()) && place[text.len()..].iter().all(|b| *b == 0)
        };
        assert_eq!(block.len(), 96 + 1280);
        assert_eq!(block[..16], *b"corehbot machine");
        assert!(text(&block[16..32], "printer") && text(&block[32..96], "printer bench "));
        assert_eq!(machine_in(&block[96..]), Ok(Settings::prototype()));
        assert!(block[96 + receipt.bytes..].iter().all(|byte| *byte == 0xFF));
    }

    #[test]
    fn a_key_may_fill_its_place() {
        let board = BoardConnectors { key: "sixteen-letters!", ..PRINTER };
        let block = blank_block(&[&board]);
        assert_eq!(board_of(&block), Some("sixteen-letters!"));
    }

    #[test]
    fn a_block_gives_back_the_machine_that_was_put_in() {
        let mut block = blank_block(&[&PRINTER]);
        assert_eq!(machine_of(&block), Err(Rejected::Blank));
        assert_eq!(board_of(&block), Some("printer"));
        let machine = Settings::prototype();
        let receipt = put_machine(&mut block, &machine).unwrap();
        assert_eq!(machine_of(&block), Ok(machine));
        assert_eq!(board_of(&block), Some("printer"));
        // Every bit counts.
        for at in 0..receipt.bytes {
            block[HEAD + at] ^= 1 << (at % 8);
            assert!(machine_of(&block).is_err(), "{at}");
            block[HEAD + at] ^= 1 << (at % 8);
        }
        clear_machine(&mut block);
        assert_eq!(block, blank_block(&[&PRINTER]));
    }

    #[test]
    fn what_is_no_machine_is_refused() {
        let mut loose = Settings::prototype();
        loose.mechanism.rows = Default::default();
        let mut block = blank_block(&[&PRINTER]);
        put_machine(&mut block, &loose).unwrap();
        assert!(matches!(machine_of(&block), Err(Rejected::Illegal(_))));
    }
}
