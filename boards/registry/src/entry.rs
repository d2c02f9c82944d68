//! What the registry has of a board and of an image.

use crate::printed::Printed;
use corehbot::connectors::BoardConnectors;
use corehbot_wiring::Board;

/// A board that can be flashed.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its connectors and pins. [`key`](BoardConnectors::key) is the name of its folder.
    pub board: &'static Board,
    /// The processor as probe-rs names it; the letter after 446 is its package.
    pub chip: &'static str,
    /// Where its bootloader starts an image, or the processor if there is none.
    pub start: u32,
    /// Its bootloader takes `firmware.bin` from a card.
    pub has_card_slot: bool,
    /// What to do before the processor's own bootloader runs, on a board with USB.
    pub before_dfu: &'static str,
    /// Its pins that no table drives.
    pub printed: Printed,
}

/// A package that makes an image for boards that differ in pins alone.
#[derive(Clone, Copy, Debug)]
pub struct Package {
    /// Its name.
    pub name: &'static str,
    /// Its boards; the image is on the first until it is told otherwise.
    pub boards: &'static [&'static Entry],
    /// Bytes that the image may leave free in one place.
    pub largest_gap: u32,
}

impl Package {
    /// Gaps larger than any alignment are a mistake in the memory map.
    pub const ALIGNMENT: u32 = 64;
}

/// The tables of boards, without the rest, which the firmware does not need.
#[must_use]
pub const fn tables_of<const N: usize>(entries: [&'static Entry; N]) -> [&'static Board; N] {
    let mut boards = [&crate::octopus::BOARD; N];
    let (mut from, mut to): (&[&Entry], &mut [&Board]) = (&entries, &mut boards);
    while let ([entry, entries @ ..], [board, boards @ ..]) = (from, to) {
        *board = entry.board;
        (from, to) = (entries, boards);
    }
    boards
}

/// The connectors of boards.
#[must_use]
pub const fn connectors_of<const N: usize>(entries: [&'static Entry; N]) -> [&'static BoardConnectors; N] {
    let mut connectors = [&BoardConnectors::ANY; N];
    let (mut from, mut to): (&[&Entry], &mut [&BoardConnectors]) = (&entries, &mut connectors);
    while let ([entry, entries @ ..], [board, boards @ ..]) = (from, to) {
        *board = entry.board.connectors;
        (from, to) = (entries, boards);
    }
    connectors
}
