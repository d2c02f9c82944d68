//! The map of the memory: 4,096 bytes, the size of an AT24C32, in pages of 32 bytes.
//!
//! | from | bytes | content |
//! |---|---|---|
//! | 0 | 1,280 | settings, slot A: the first part of a record |
//! | 1,280 | 160 | mesh, slot A |
//! | 1,440 | 384 | settings, slot A: the second part |
//! | 1,824 | 224 | reserved for a power loss: a layer of 160 bytes, and positions of a page each |
//! | 2,048 | 1,280 | settings, slot B: the first part of a record |
//! | 3,328 | 160 | mesh, slot B |
//! | 3,488 | 384 | settings, slot B: the second part |
//! | 3,872 | 192 | reserved for a power loss: a layer of 160 bytes, and a position |
//! | 4,064 | 32 | notes of 8 bytes: the last self-test, the load of belt motors, the baselines of hotend and bed |
//!
//! The second part lies behind the mesh, so that everything has the address of earlier firmware: an update moves
//! nothing, and a power cut in between has nothing to spoil.
//!
//! A page stands a million writes (AT24C32E datasheet 8905F, 1). A position each second is 36,000 pages in a print of
//! ten hours. Positions may also take the pages of a slot behind the record in it. A reader never looks at them, and
//! the next position replaces one that a save has overwritten. With records of 960 bytes, as of the prototype, there
//! are 22 such pages in each slot and three reserved ones. This makes 766 writes of each page, so the memory stands
//! 1,300 such prints. Three pages alone, next to the longest records, stand 83.

use super::record::{FIRST, LONGEST};

/// Transfers never cross a multiple of this: the page of an AT24C32 (AT24C32E datasheet 8905F, 8.2).
pub const PAGE: usize = 32;

/// Bytes of storage that are needed.
pub const NEEDED: u32 = 4096;

/// A part of the memory.
#[derive(Clone, Copy)]
pub(super) struct Region {
    pub begin: u32,
    pub bytes: u32,
}

const fn region(begin: u32, bytes: u32) -> Region {
    Region { begin, bytes }
}

/// First parts of records in slot A and slot B.
const FIRST_PARTS: [Region; 2] = [region(0, FIRST as u32), region(2048, FIRST as u32)];

/// A mesh in slot A and slot B: `mesh` has its layout, and asserts that 7 by 7 points fit.
pub(super) const MESH: [Region; 2] = [region(1280, 160), region(3328, 160)];

/// Second parts of records.
const SECOND_PARTS: [Region; 2] = [region(1440, SECOND), region(3488, SECOND)];

/// Bytes of a second part.
const SECOND: u32 = (LONGEST - FIRST) as u32;

/// A layer and positions of a print that a power loss may end.
const POWER_LOSS: [Region; 2] = [region(1824, 160 + 2 * PAGE as u32), region(3872, 160 + PAGE as u32)];

/// Notes, which are written at any time: only this page needs no erased slot in flash.
const NOTE: Region = region(4064, PAGE as u32);

/// All of it, by address.
const MAP: [Region; 9] = [
    FIRST_PARTS[0],
    MESH[0],
    SECOND_PARTS[0],
    POWER_LOSS[0],
    FIRST_PARTS[1],
    MESH[1],
    SECOND_PARTS[1],
    POWER_LOSS[1],
    NOTE,
];

/// Distance of the two slots, in which everything lies alike.
pub const STRIDE: u32 = FIRST_PARTS[1].begin;
const _: () =
    assert!(STRIDE == MESH[1].begin - MESH[0].begin && STRIDE == SECOND_PARTS[1].begin - SECOND_PARTS[0].begin);

/// The address of the bytes of a record in slot A from `at` on: the mesh lies between the two parts.
pub(super) const fn address(at: usize) -> u32 {
    let at = at as u32;
    if at < FIRST_PARTS[0].bytes { at } else { at + MESH[0].bytes }
}

/// The address of the note of the last self-test.
pub(super) const SELF_TEST: u32 = NOTE.begin;

/// The address of the note of the load of belt motors.
pub(super) const BELT_LOADS: u32 = NOTE.begin + 8;

/// The addresses of the notes of the baselines of hotend and bed.
pub(super) const BASELINES: [u32; 2] = [NOTE.begin + 16, NOTE.begin + 24];

// The regions follow each other without a gap, in whole pages, up to the end.
const _: () = {
    let (mut at, mut left): (u32, &[Region]) = (0, &MAP);
    while let [region, rest @ ..] = left {
        assert!(region.begin == at && region.bytes > 0 && region.bytes.is_multiple_of(PAGE as u32));
        (at, left) = (at + region.bytes, rest);
    }
    assert!(at == NEEDED);
};
