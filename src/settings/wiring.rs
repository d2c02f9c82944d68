//! Wiring: which connector of the board each motor and each switch is plugged into.

use super::Cartesian;
use crate::connectors::{BoardConnectors, ConnectorName, OCTOPUS};
use crate::motors::Motor;
use serde::{Deserialize, Serialize};

/// Where motors and switches are plugged in. [`Settings::check_connectors`](super::Settings::check_connectors) holds it to a
/// board; heaters have their connectors in [`HeaterSettings`](super::HeaterSettings).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Wiring {
    /// By motor, in the order of [`Motor::ALL`].
    pub motors: [MotorPlug; Motor::ALL.len()],
    /// The switch of each axis.
    pub endstops: Cartesian<EndstopPlug>,
}

/// Where a motor is plugged in.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct MotorPlug {
    /// The socket of its driver.
    pub connector: ConnectorName,
    /// It turns the other way round: its direction line is low for forward.
    pub is_reversed: bool,
}

/// Where a switch is plugged in.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct EndstopPlug {
    /// The input.
    pub connector: ConnectorName,
    /// It closes when it is pressed, so that a broken wire reads as not pressed. Otherwise it opens.
    pub is_normally_open: bool,
}

impl Wiring {
    /// The prototype on a board: each motor and switch in its place of the board's table.
    #[must_use]
    pub const fn usual(board: &BoardConnectors) -> Self {
        let mut motors = [MotorPlug { connector: ConnectorName::NONE, is_reversed: false }; Motor::ALL.len()];
        let (mut plugs, mut sockets): (&mut [MotorPlug], _) = (&mut motors, board.sockets);
        while let ([plug, other_plugs @ ..], [socket, other_sockets @ ..]) = (plugs, sockets) {
            plug.connector = *socket;
            (plugs, sockets) = (other_plugs, other_sockets);
        }
        let [x, y, z] = match *board.endstops {
            [x, y, z, ..] => [x, y, z],
            _ => [ConnectorName::NONE; 3],
        };
        Self { motors, endstops: Cartesian { x: EndstopPlug::new(x), y: EndstopPlug::new(y), z: EndstopPlug::new(z) } }
    }

    /// The prototype on an Octopus.
    pub(crate) const fn prototype() -> Self {
        Self::usual(&OCTOPUS)
    }

    /// Where `motor` is plugged in.
    #[must_use]
    pub const fn of(&self, motor: Motor) -> MotorPlug {
        let [m1, m4, m8, m11, z1, z2, e0] = self.motors;
        match motor {
            Motor::M1 => m1,
            Motor::M4 => m4,
            Motor::M8 => m8,
            Motor::M11 => m11,
            Motor::Z1 => z1,
            Motor::Z2 => z2,
            Motor::E0 => e0,
        }
    }
}

impl EndstopPlug {
    /// Nothing is plugged in.
    pub const NONE: Self = Self::new(ConnectorName::NONE);

    /// A switch that opens when it is pressed.
    const fn new(connector: ConnectorName) -> Self {
        Self { connector, is_normally_open: false }
    }
}
