//! The connectors of a board, by the names printed on it. The boards are in `boards`, one folder each.

use super::{ConnectorName, OutputSet, Sensor};

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
    /// Inputs for switches and other contacts, in the order of the board's table of pins: x, y and z of the prototype,
    /// then others. Any part with a contact may be in any of them.
    pub inputs: &'static [ConnectorName],
    /// Inputs that are one line to the processor, so that a machine can use one of them.
    pub shared_inputs: &'static [[ConnectorName; 2]],
    /// Sockets with a line of the debug port: while a machine uses one, no debug probe can connect to the processor.
    pub debug_sockets: &'static [ConnectorName],
    /// Heater outputs that may heat.
    pub outputs: OutputSet,
    /// Inputs for temperature sensors.
    pub sensors: &'static [Sensor],
    /// The timer of each fan output, FAN0 and so on. Fans on one timer share its frequency; without a number a fan's
    /// frequency is fixed.
    pub fans: &'static [Option<u8>],
    /// Outputs that may switch the power supply, in the order of the board's table of pins: its own connector for that,
    /// and pins of headers that no part uses.
    pub supply_switches: &'static [ConnectorName],
    /// It has the line of a servo, which a BLTouch needs.
    pub has_servo: bool,
    /// The name of its connector for an accelerometer (SPI).
    pub accelerometer: Option<&'static str>,
    /// A bench rig: motors that it has no socket for are counted, and do not turn.
    pub is_bench: bool,
    /// There are no real plugs, so every name is legal.
    pub is_simulated: bool,
}

impl BoardConnectors {
    /// No board's: every name is legal, and any part needs none.
    pub const ANY: Self = Self {
        key: "",
        name: "board",
        sockets: &[],
        inputs: &[],
        shared_inputs: &[],
        debug_sockets: &[],
        outputs: OutputSet::NONE,
        sensors: &[],
        fans: &[],
        supply_switches: &[],
        has_servo: true,
        accelerometer: Some("SPI"),
        is_bench: true,
        is_simulated: true,
    };

    /// Whether its processor measures its own temperature. It does so with the converter that checks the thermistors'
    /// supply, so every board with thermistors has it.
    #[must_use]
    pub const fn has_mcu_sensor(&self) -> bool {
        !self.sensors.is_empty()
    }

    /// Whether two inputs are one line to the processor.
    #[must_use]
    pub fn is_one_line(&self, a: ConnectorName, b: ConnectorName) -> bool {
        a == b || self.shared_inputs.iter().any(|[one, other]| (*one, *other) == (a, b) || (*one, *other) == (b, a))
    }
}

/// Boards for tests.
#[cfg(test)]
pub(crate) mod samples {
    use super::*;
    use crate::connectors::Output;

    const fn names<const N: usize>(texts: [&'static str; N]) -> [ConnectorName; N] {
        ConnectorName::all(texts)
    }

    /// A board with the connectors that the prototype names, and others.
    pub(crate) const PRINTER: BoardConnectors = BoardConnectors {
        key: "printer",
        name: "sample",
        sockets: &names(["M0", "M1", "M4", "M3", "M2", "M5", "M6", "M7"]),
        inputs: &names([
            "X-STOP", "Y-STOP", "Z-STOP", "Z2-STOP", "E0DET", "E1DET", "E2DET", "E3DET", "BLTOUCH", "PROBE",
        ]),
        shared_inputs: &[names(["BLTOUCH", "PROBE"])],
        debug_sockets: &names(["M7"]),
        outputs: OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1),
        sensors: &[Sensor::Bed, Sensor::Hotend0, Sensor::Hotend1, Sensor::Hotend2, Sensor::Hotend3],
        fans: &[Some(1), Some(9), Some(4), Some(4), Some(4), None],
        supply_switches: &names(["PS-ON", "PE7"]),
        has_servo: true,
        accelerometer: Some("SPI3"),
        is_bench: false,
        is_simulated: false,
    };

    /// A board with other names.
    pub(crate) const OTHER: BoardConnectors = BoardConnectors {
        key: "other",
        name: "other",
        sockets: &names(["X-MOT", "Y-MOT", "E2-MOT", "Z-MOT", "E3-MOT", "E4-MOT", "E0-MOT", "E1-MOT"]),
        inputs: &names(["X-MIN", "Y-MIN", "Z-MIN", "X-MAX", "Y-MAX", "Z-MAX"]),
        shared_inputs: &[],
        debug_sockets: &[],
        supply_switches: &names(["PC9"]),
        has_servo: false,
        accelerometer: None,
        ..PRINTER
    };

    /// A bench rig with sockets for the belt's motors.
    pub(crate) const BENCH: BoardConnectors = BoardConnectors {
        key: "bench",
        name: "rig",
        sockets: &names(["X", "Y", "A", "Z"]),
        inputs: &names(["X", "Y", "Z"]),
        outputs: OutputSet::NONE,
        sensors: &[],
        fans: &[],
        supply_switches: &[],
        is_bench: true,
        ..OTHER
    };
}
