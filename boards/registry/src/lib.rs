//! Every board. A board is a folder: its `wiring.rs` has connectors, pins and the way of an image onto the board, and
//! README.md says the same to its owner. Here it is a module, and a row of the image that serves it.
//!
//! Images, the command, machine files, `cargo xtask` and documents take their boards from here.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

#[path = "../../nucleo/wiring.rs"]
pub mod nucleo;
#[path = "../../octopus/wiring.rs"]
pub mod octopus;
#[path = "../../octopus-pro/wiring.rs"]
pub mod octopus_pro;
#[path = "../../sim/wiring.rs"]
pub mod sim;
#[path = "../../spider/wiring.rs"]
pub mod spider;
#[path = "../../spider-v1/wiring.rs"]
pub mod spider_v1;

mod entry;
mod printed;
#[cfg(test)]
mod tests;

pub use entry::{Entry, Package, connectors_of, tables_of};
pub use printed::{Job, Printed};

use corehbot::connectors::BoardConnectors;

/// Boards of the Octopus's image, which differ in pins alone. It is on the first of them until it is told otherwise.
pub const OCTOPUS: [&Entry; 4] = [&octopus::ENTRY, &octopus_pro::ENTRY, &spider::ENTRY, &spider_v1::ENTRY];

/// Boards of the Nucleo's image.
pub const NUCLEO: [&Entry; 1] = [&nucleo::ENTRY];

/// Every image that can be flashed.
pub const PACKAGES: [Package; 2] = [
    Package { name: "corehbot-octopus", boards: &OCTOPUS, largest_gap: Package::ALIGNMENT },
    // Sectors 0 to 2 hold the vectors and the settings; the code begins behind them.
    Package { name: "corehbot-nucleo", boards: &NUCLEO, largest_gap: 0xC000 },
];

/// Every board that can be flashed.
pub fn entries() -> impl Iterator<Item = &'static Entry> + Clone {
    PACKAGES.iter().flat_map(|package| package.boards).copied()
}

/// The connectors of every board, the simulator's last.
pub fn all() -> impl Iterator<Item = &'static BoardConnectors> + Clone {
    entries().map(|entry| entry.board.connectors).chain([&sim::CONNECTORS])
}

/// The connectors of the board with that key.
#[must_use]
pub fn called(key: &str) -> Option<&'static BoardConnectors> {
    all().find(|board| board.key == key)
}
