//! The wiring of the Octopus Pro V1.0 with an STM32F446: connectors and pins of the Octopus, as far as they are used
//! (BTT's README of the Octopus Pro; Klipper's generic-bigtreetech-octopus-pro-v1.0.cfg). Only its PROBE header is
//! elsewhere, on PC5, and not in use; PB7 is the BLTouch's pin.
//!
//! A field that is new counts for it as it does for the Octopus.

use crate::{Entry, octopus};
use corehbot::connectors::{BoardConnectors, ConnectorName};
use corehbot_wiring::Board;

/// The names printed on it.
pub const CONNECTORS: BoardConnectors = BoardConnectors {
    key: "octopus-pro",
    name: "BTT Octopus Pro V1.0",
    probes: &ConnectorName::all(["BLTOUCH"]),
    ..octopus::CONNECTORS
};

/// The board.
pub static BOARD: Board = Board { name: "BTT Octopus Pro V1.0", connectors: &CONNECTORS, ..octopus::BOARD };

/// The way of an image onto it.
pub const ENTRY: Entry = Entry { board: &BOARD, ..octopus::ENTRY };
