//! Wiring: which connector of the board each motor and each switch is plugged into.

use super::field::{Field, Number, Value, text};
use super::motor_keys::{MotorKeys, motor_keys, texts};
use super::rows::{Spec, ValueKind, rows};
use super::{Cartesian, Settings};
use crate::connectors::{BoardConnectors, ConnectorName};
use crate::kinematics::{self, MOST_NUMBER, Row};
use crate::motors::{MOTORS, Motor, MotorName, prototype};
use serde::{Deserialize, Serialize};

/// Where motors and switches are plugged in. [`Settings::check_connectors`](super::Settings::check_connectors) holds it
/// to a board; heaters have their connectors in [`HeaterSettings`](super::HeaterSettings).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Wiring {
    /// By motor, in the order of [`Motor::ALL`].
    pub motors: [MotorPlug; MOTORS],
    /// The switch of each axis.
    pub endstops: Cartesian<EndstopPlug>,
}

/// Where a motor is plugged in.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct MotorPlug {
    /// The socket of its driver.
    pub connector: ConnectorName,
    /// It turns in the other direction: its direction line is low for forward.
    pub is_reversed: bool,
}

/// Where a switch is plugged in.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct EndstopPlug {
    /// The input.
    pub connector: ConnectorName,
    /// It closes when it is pressed, so that a broken wire reads as not pressed. Otherwise it opens. Which level that
    /// is depends on the input's circuit, which the board knows.
    pub is_normally_open: bool,
}

impl Wiring {
    /// The prototype on a board: each motor and switch in its place of the board's table.
    #[must_use]
    pub const fn usual(board: &BoardConnectors) -> Self {
        Self::in_order(board.sockets, board.inputs)
    }

    /// The prototype's motors and switches in these places.
    const fn in_order(sockets: &[ConnectorName], inputs: &[ConnectorName]) -> Self {
        let mut motors = [MotorPlug::NONE; MOTORS];
        let (mut plugs, mut sockets) = (motors.split_at_mut(prototype::COUNT).0, sockets);
        while let ([plug, other_plugs @ ..], [socket, other_sockets @ ..]) = (plugs, sockets) {
            plug.connector = *socket;
            (plugs, sockets) = (other_plugs, other_sockets);
        }
        let [x, y, z] = match *inputs {
            [x, y, z, ..] => [x, y, z],
            _ => [ConnectorName::NONE; 3],
        };
        Self { motors, endstops: Cartesian { x: EndstopPlug::new(x), y: EndstopPlug::new(y), z: EndstopPlug::new(z) } }
    }

    /// The prototype's own plugs.
    pub(crate) const fn prototype() -> Self {
        const {
            let sockets = ConnectorName::all(["M0", "M1", "M4", "M3", "M2", "M5", "M6"]);
            Self::in_order(&sockets, &ConnectorName::all(["X-STOP", "Y-STOP", "Z-STOP"]))
        }
    }

    /// Where `motor` is plugged in.
    #[must_use]
    pub const fn of(&self, motor: Motor) -> MotorPlug {
        match self.motors.as_slice().split_at_checked(motor.index()) {
            Some((_, [plug, ..])) => *plug,
            _ => MotorPlug::NONE,
        }
    }
}

impl MotorPlug {
    /// Nothing is plugged in.
    pub const NONE: Self = Self { connector: ConnectorName::NONE, is_reversed: false };
}

impl EndstopPlug {
    /// Nothing is plugged in.
    pub const NONE: Self = Self::new(ConnectorName::NONE);

    /// A switch that opens when it is pressed.
    const fn new(connector: ConnectorName) -> Self {
        Self { connector, is_normally_open: false }
    }
}

/// Characters of the longest plug: a connector's name, and a mark that inverts it.
const LONGEST: usize = 1 + ConnectorName::LONGEST;

/// A plug as a machine file has it: the name of its connector, with `!` before it if it is inverted.
fn plug(connector: ConnectorName, is_inverted: bool) -> Value {
    text([if is_inverted { "!" } else { "" }, connector.as_str()])
}

/// The connector of such a text, and whether it is inverted.
fn plugged(value: &Value) -> Option<(ConnectorName, bool)> {
    let Value::Text(text) = value else { return None };
    let inverted = text.strip_prefix('!');
    Some((ConnectorName::new(inverted.unwrap_or(text))?, inverted.is_some()))
}

impl Field for MotorPlug {
    fn get(&self) -> Value {
        plug(self.connector, self.is_reversed)
    }

    fn set(&mut self, value: &Value) -> bool {
        let Some((connector, is_reversed)) = plugged(value) else { return false };
        *self = Self { connector, is_reversed };
        true
    }
}

impl Field for EndstopPlug {
    fn get(&self) -> Value {
        plug(self.connector, self.is_normally_open)
    }

    fn set(&mut self, value: &Value) -> bool {
        let Some((connector, is_normally_open)) = plugged(value) else { return false };
        *self = Self { connector, is_normally_open };
        true
    }
}

impl Field for ConnectorName {
    fn get(&self) -> Value {
        text(["", self.as_str()])
    }

    fn set(&mut self, value: &Value) -> bool {
        let Value::Text(text) = value else { return false };
        let Some(name) = Self::new(text) else { return false };
        *self = name;
        true
    }
}

impl Field for MotorName {
    fn get(&self) -> Value {
        text(["", self.as_str()])
    }

    fn set(&mut self, value: &Value) -> bool {
        let Value::Text(text) = value else { return false };
        let Some(name) = Self::new(text) else { return false };
        *self = name;
        true
    }
}

/// Rows of [`Settings::motor_names`].
pub(super) mod names {
    use super::*;

    rows! {
        for name in |s, part| s.motor_names.get_mut(part), named &["motors.names"; MOTORS];

        /// The motors, each by a name of up to 4 letters and digits, in the order of a trace's columns. `[mechanism]`
        /// and `[motors]` call them by these names.
        100 "" = name, "", [Spec::text(MotorName::LONGEST, ValueKind::MotorName)];
    }
}

/// Rows of [`Wiring::motors`]. In the keys of motors, `#0` stands for the name of the first one.
pub(super) mod motors {
    use super::*;

    const KEYS: MotorKeys<9> = motor_keys(*b"motors.#0");

    rows! {
        for motor in |s, part| s.wiring.motors.get_mut(part), named &texts(&KEYS);

        /// Socket of the motor, as printed on the board; ! before it turns the motor the other way round; empty is
        /// nowhere.
        96 "" = motor, "", [Spec::text(LONGEST, ValueKind::Plug)];
    }
}

/// Rows of [`Wiring::endstops`] and the probe.
pub(super) mod endstops {
    use super::*;

    impl Settings {
        /// The plug of the switch of x, y or z, or of the probe.
        const fn plug_mut(&mut self, part: usize) -> Option<&mut EndstopPlug> {
            match part {
                3 => Some(&mut self.probe_plug),
                axis => self.wiring.endstops.get_mut(axis),
            }
        }
    }

    rows! {
        for plug in |s, part| s.plug_mut(part), named &["endstops.x", "endstops.y", "endstops.z", "endstops.probe"];

        /// Input of the switch or probe, which opens when it triggers; ! before it: which closes then. The board knows
        /// the level of an open input. Empty is no probe; probe.kind says how one is used, and M119 reports it.
        97 "" = plug, "", [Spec::text(LONGEST, ValueKind::Plug)];
    }
}

/// The row of the filament sensor, which came later than its neighbours.
pub(super) mod filament {
    use super::*;

    rows! {
        for plug in |s, _| Some(&mut s.filament), named &["endstops.filament"];

        /// Input of the filament sensor, with a switch that opens when filament presses it; ! before it: which closes
        /// then. Empty is none. M119 reports it; so far nothing stops at the end of the filament.
        109 "" = plug, "", [Spec::text(LONGEST, ValueKind::Plug)];
    }
}

impl Number for Row {
    fn value(&self) -> Option<i64> {
        // The number of an illegal row is out of range.
        Some(kinematics::row_number(*self).unwrap_or(i16::MAX).into())
    }

    fn put(&mut self, number: i64) -> bool {
        let Some(row) = i16::try_from(number).ok().and_then(kinematics::row_of) else { return false };
        *self = row;
        true
    }
}

/// Rows of the mechanism: the turn of each motor for a step of x, y, z and e.
pub(super) mod mechanism {
    use super::*;

    const KEYS: MotorKeys<12> = motor_keys(*b"mechanism.#0");

    rows! {
        for row in |s, part| s.mechanism.rows.get_mut(part), named &texts(&KEYS);

        /// Steps of the motor for one step of x, y, z and e (0 if left out): -1, 0 or 1, all times one whole number.
        98 "" = row, "", [Spec::packed(MOST_NUMBER as i64, ValueKind::MotorRow)];
    }
}
