//! The wiring of the Octopus Pro V1.0 with an STM32F446: connectors and pins of the Octopus, as far as they are used
//! (BTT's README of the Octopus Pro; Klipper's generic-bigtreetech-octopus-pro-v1.0.cfg). Only its PROBE header is
//! elsewhere, on PC5; PB7 is the BLTouch's pin.
//!
//! A field that is new counts for it as it does for the Octopus.

use crate::{Entry, octopus};
use corehbot::connectors::BoardConnectors;
use corehbot_wiring::{Board, Input, Port};

/// The names printed on it.
pub const CONNECTORS: BoardConnectors =
    BoardConnectors { key: "octopus-pro", name: "BTT Octopus Pro V1.0", shared_inputs: &[], ..octopus::CONNECTORS };

/// The board.
pub static BOARD: Board = Board {
    name: "BTT Octopus Pro V1.0",
    connectors: &CONNECTORS,
    // PROBE: by an optocoupler, which a jumper makes fit for NPN and PNP sensors (BTT's README of the Octopus Pro;
    // Voron's configuration for it: Klipper needs ~!PC5 for a sensor that opens).
    inputs: &octopus::inputs(Input::optocoupler(Port::C, 5)),
    ..octopus::BOARD
};

/// The way of an image onto it.
pub const ENTRY: Entry = Entry { board: &BOARD, ..octopus::ENTRY };
