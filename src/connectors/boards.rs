//! The connectors of each board, by the names printed on it.

use super::{ConnectorName, FANS, Output, OutputSet, Sensor};

/// The connectors of a board for a machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BoardConnectors {
    /// Its name in files and on command lines.
    pub key: &'static str,
    /// Its name in messages.
    pub name: &'static str,
    /// Sockets of motor drivers, in the order of the board's table of pins: first the sockets of the prototype's
    /// motors, then others.
    pub sockets: &'static [ConnectorName],
    /// Inputs for switches, in the order of the board's table of pins: x, y and z of the prototype, then others.
    pub endstops: &'static [ConnectorName],
    /// Sockets with a line of the debug port: while a machine uses one, no debug probe can connect to the processor.
    pub debug_sockets: &'static [ConnectorName],
    /// Heater outputs that may heat.
    pub outputs: OutputSet,
    /// Inputs for temperature sensors.
    pub sensors: &'static [Sensor],
    /// Fan outputs, FAN0 and so on.
    pub fans: usize,
    /// Names of the one input for a Z probe, if there is one.
    pub probes: &'static [ConnectorName],
    /// A bench rig: motors that it has no socket for are counted, and do not turn.
    pub is_bench: bool,
    /// There are no real plugs, so every name is legal.
    pub is_simulated: bool,
}

/// BTT Octopus V1.0 and V1.1 (BTT's schematic). M2 is one driver with two plugs. The direction line of M7 (PA14) is the
/// clock of the debug port. Left out, though printed: heater outputs HE2 and HE3, because no timer can end their pulses
/// (`boards/octopus/src/wiring.rs`).
pub const OCTOPUS: BoardConnectors = BoardConnectors {
    key: "octopus",
    name: "BTT Octopus",
    sockets: &names(["M0", "M1", "M4", "M3", "M2", "M5", "M6", "M7"]),
    endstops: &names(["X-STOP", "Y-STOP", "Z-STOP", "Z2-STOP", "E0DET", "E1DET", "E2DET", "E3DET"]),
    debug_sockets: &names(["M7"]),
    outputs: OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1),
    sensors: &[Sensor::Bed, Sensor::Hotend0, Sensor::Hotend1, Sensor::Hotend2, Sensor::Hotend3],
    fans: FANS,
    probes: &names(["PROBE", "BLTOUCH"]),
    is_bench: false,
    is_simulated: false,
};

/// BTT Octopus Pro V1.0 with an STM32F446: connectors and pins of the Octopus, as far as they are used
/// (`boards/octopus-pro`); only its PROBE header has another pin. A field that is new counts for it, and for [`SIM`],
/// as it does for the Octopus.
pub const OCTOPUS_PRO: BoardConnectors =
    BoardConnectors { key: "octopus-pro", name: "BTT Octopus Pro V1.0", probes: &names(["BLTOUCH"]), ..OCTOPUS };

/// Fysetc Spider V1.x and V2.x with an STM32F446 (Fysetc's README). Left out, though printed: heater outputs with
/// pulses that no timer of ours can end, and fans. Z-MAX is the probe's connector (`boards/spider/wiring.rs`).
pub const SPIDER: BoardConnectors = BoardConnectors {
    key: "spider",
    name: "Fysetc Spider",
    sockets: &names(["X-MOT", "Y-MOT", "E2-MOT", "Z-MOT", "E3-MOT", "E4-MOT", "E0-MOT", "E1-MOT"]),
    endstops: &names(["X-MIN", "Y-MIN", "Z-MIN", "X-MAX", "Y-MAX"]),
    debug_sockets: &[],
    outputs: OutputSet::NONE,
    sensors: &[Sensor::Bed, Sensor::Hotend0, Sensor::Hotend1, Sensor::Hotend2],
    fans: 0,
    probes: &names(["Z-MAX"]),
    is_bench: false,
    is_simulated: false,
};

/// Nucleo-F446RE with a CNC shield v3: the sockets and limit inputs of the shield.
pub const NUCLEO: BoardConnectors = BoardConnectors {
    key: "nucleo",
    name: "CNC shield",
    sockets: &names(["X", "Y", "A", "Z"]),
    endstops: &names(["X", "Y", "Z"]),
    debug_sockets: &[],
    outputs: OutputSet::NONE,
    sensors: &[],
    fans: 0,
    probes: &[],
    is_bench: true,
    is_simulated: false,
};

/// The simulator: as an Octopus, with any other name as well.
pub const SIM: BoardConnectors = BoardConnectors {
    key: "sim",
    name: "simulator",
    debug_sockets: &[],
    is_bench: true,
    is_simulated: true,
    ..OCTOPUS
};

impl BoardConnectors {
    /// Every board.
    pub const ALL: [&'static Self; 5] = [&OCTOPUS, &OCTOPUS_PRO, &SPIDER, &NUCLEO, &SIM];
}

const fn names<const N: usize>(texts: [&'static str; N]) -> [ConnectorName; N] {
    let mut names = [ConnectorName::NONE; N];
    let (mut from, mut to): (&[&str], &mut [ConnectorName]) = (&texts, &mut names);
    while let ([text, texts @ ..], [name, names @ ..]) = (from, to) {
        *name = ConnectorName::lit(text);
        (from, to) = (texts, names);
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_board_has_a_name_twice() {
        for board in BoardConnectors::ALL {
            assert!(board.debug_sockets.iter().all(|name| board.sockets.contains(name)));
            for names in [board.sockets, board.endstops, board.probes] {
                assert!(names.iter().all(|name| names.iter().filter(|other| *other == name).count() == 1));
                assert!(!names.contains(&ConnectorName::NONE));
            }
            assert_eq!(BoardConnectors::ALL.iter().filter(|other| other.key == board.key).count(), 1);
        }
    }
}
