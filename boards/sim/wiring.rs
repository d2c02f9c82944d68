//! The simulated board: the connectors of an Octopus, and any other name.

use crate::octopus;
use corehbot::connectors::BoardConnectors;

/// Its connectors.
pub const CONNECTORS: BoardConnectors = BoardConnectors {
    key: "sim",
    name: "simulator",
    debug_sockets: &[],
    has_servo: true,
    is_bench: true,
    is_simulated: true,
    ..octopus::CONNECTORS
};
