//! The map of the memory: 4,096 bytes, the size of an AT24C32, in pages of 32 bytes.
//!
//! | from | bytes | content |
//! |---|---|---|
//! | 0 | 1,280 | settings, slot A |
//! | 1,280 | 160 | mesh, slot A |
//! | 1,440 | 608 | reserved: positions for a power loss, 19 pages in turn |
//! | 2,048 | 1,280 | settings, slot B |
//! | 3,328 | 160 | mesh, slot B |
//! | 3,488 | 480 | reserved: layers for a power loss, three records of 160 bytes in turn |
//! | 3,968 | 96 | free |
//! | 4,064 | 32 | notes: 8 bytes of the last self-test, 8 of the load of belt motors; 16 are free |
//!
//! A page stands a million writes (AT24C32E datasheet 8905F, 1). A position each second is 36,000 pages in a print of
//! ten hours, 1,895 writes of each page, so the memory stands 527 such prints.

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

/// Settings in slot A and slot B.
const SETTINGS: [Region; 2] = [region(0, SLOT), region(2048, SLOT)];

/// A mesh in slot A and slot B: `mesh` has its layout, and asserts that 7 by 7 points fit.
pub(super) const MESH: [Region; 2] = [region(SLOT, 160), region(2048 + SLOT, 160)];

/// Positions of a print that a power loss may end.
const POSITIONS: Region = region(1440, 19 * PAGE as u32);

/// Layers of such a print.
const LAYERS: Region = region(3488, 3 * 160);

/// For later.
const FREE: Region = region(3968, 3 * PAGE as u32);

/// Notes, which are written at any time: only this page needs no erased slot in flash.
const NOTE: Region = region(4064, PAGE as u32);

/// All of it, by address.
const MAP: [Region; 8] = [SETTINGS[0], MESH[0], POSITIONS, SETTINGS[1], MESH[1], LAYERS, FREE, NOTE];

/// Room for the settings in a slot.
pub(super) const SLOT: u32 = 1280;

/// Distance of the two slots.
pub const STRIDE: u32 = SETTINGS[1].begin;

/// The address of the note of the last self-test.
pub(super) const SELF_TEST: u32 = NOTE.begin;

/// The address of the note of the load of belt motors.
pub(super) const BELT_LOADS: u32 = NOTE.begin + 8;

// The regions follow each other without a gap, in whole pages, up to the end.
const _: () = {
    let (mut at, mut left): (u32, &[Region]) = (0, &MAP);
    while let [region, rest @ ..] = left {
        assert!(region.begin == at && region.bytes > 0 && region.bytes.is_multiple_of(PAGE as u32));
        (at, left) = (at + region.bytes, rest);
    }
    assert!(at == NEEDED);
};
