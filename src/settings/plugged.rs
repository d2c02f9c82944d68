//! Whether a board has the connectors that a machine uses. Checked for machine files and images, by MACHINE_STORE and
//! when a board starts. M-codes are not checked, because none of them changes a plug.

use super::{FanPlug, PLACES, ProbeKind, SensorSource, Settings, Wiring};
use crate::connectors::{BoardConnectors, ConnectorName, FANS, Heater, Output, Sensor};
use crate::motors::MotorName;
use core::fmt::{self, Display};

/// A part with a connector of its own.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Plugged {
    /// A motor.
    Motor(MotorName),
    /// The switch of an axis.
    Endstop(&'static str),
    /// The Z probe.
    Probe,
    /// The filament sensor.
    Filament,
    /// The tachometer of a fan.
    Tachometer(u8),
}

/// A part plugged in at an impossible connector.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ConnectorError {
    /// It is plugged in nowhere.
    Nowhere(Plugged, &'static BoardConnectors),
    /// The board has no such connector for it.
    NoSuch(Plugged, ConnectorName, &'static BoardConnectors),
    /// Both are in one connector, or in two of one line.
    Twice([Plugged; 2], [ConnectorName; 2]),
    /// The board has no such heater output, or cannot switch it.
    NoSuchOutput(Heater, Output, &'static BoardConnectors),
    /// The board has no such input for the temperature sensor of a heater.
    NoSuchSensor(Heater, Sensor, &'static BoardConnectors),
    /// The board has no line for the servo of a BLTouch.
    NoServo(&'static BoardConnectors),
    /// It has no connector for an accelerometer.
    NoAccelerometer(&'static BoardConnectors),
    /// Nor for the sensor without a heater at this place.
    NoSuchExtraSensor(&'static str, SensorSource, &'static BoardConnectors),
    /// The board has no such fan for a fan with a frequency or a tachometer.
    NoSuchFan(u8, &'static BoardConnectors),
    /// The board cannot change the frequency of this fan.
    FixedFan(u8, &'static BoardConnectors),
    /// An earlier fan on the timer of this one has another frequency, this one in Hz.
    SharedTimer(u8, u16),
}

impl Settings {
    /// Names the usual connectors of a board, if the settings name those of the prototype. Records and files without
    /// connectors name those, on every board.
    pub fn name_connectors(&mut self, board: &BoardConnectors) {
        if self.wiring == Wiring::prototype() {
            self.wiring = Wiring::usual(board);
        }
    }

    /// Whether the machine's probe has a servo.
    #[must_use]
    pub const fn has_servo(&self) -> bool {
        matches!(self.probe.kind, ProbeKind::BlTouch)
    }

    /// Checks that a board has every connector that the machine is plugged into, each once. Motors and heaters that are
    /// not fitted need none.
    ///
    /// # Errors
    /// The first that is wrong.
    pub fn check_connectors(&self, board: &'static BoardConnectors) -> Result<(), ConnectorError> {
        let motors = self.mechanism.fitted().iter();
        let motors = motors.map(|motor| (Plugged::Motor(self.name_of(motor)), self.wiring.of(motor).connector));
        check(motors, board, |_, a, b| a == b)?;
        let axes = &self.wiring.endstops;
        let switches = [("x", axes.x), ("y", axes.y), ("z", axes.z)].into_iter();
        let switches = switches.map(|(axis, plug)| (Plugged::Endstop(axis), plug.connector));
        let others = [(Plugged::Probe, self.probe_plug.connector), (Plugged::Filament, self.filament.connector)];
        let is_needed = |part: Plugged| match part {
            Plugged::Probe => self.probe.is_fitted(),
            Plugged::Endstop("z") => !self.homes_z_by_probe(),
            Plugged::Filament | Plugged::Tachometer(_) => false,
            Plugged::Endstop(_) | Plugged::Motor(_) => true,
        };
        let tachometers = (0..).zip(self.fans).map(|(fan, plug)| (Plugged::Tachometer(fan), plug.tachometer.input()));
        let contacts = switches.chain(others).chain(tachometers);
        let contacts = contacts.filter(|(part, connector)| !connector.is_none() || is_needed(*part));
        check(contacts, board, BoardConnectors::is_one_line)?;
        if board.is_simulated {
            return Ok(());
        }
        if self.has_servo() && !board.has_servo {
            return Err(ConnectorError::NoServo(board));
        }
        if self.accelerometer.kind.is_some() && board.accelerometer.is_none() {
            return Err(ConnectorError::NoAccelerometer(board));
        }
        Heater::ALL.into_iter().try_for_each(|heater| self.check_heater(heater, board))?;
        self.check_fans(board)?;
        let has = |source| match source {
            SensorSource::At(sensor) => board.sensors.contains(&sensor),
            SensorSource::Mcu => board.has_mcu_sensor(),
        };
        match PLACES.iter().zip(self.sensors).find(|(_, extra)| extra.is_fitted && !has(extra.sensor)) {
            Some(((place, _), extra)) => Err(ConnectorError::NoSuchExtraSensor(place, extra.sensor, board)),
            None => Ok(()),
        }
    }

    /// Each fan with a frequency is on a timer that has no other.
    fn check_fans(&self, board: &'static BoardConnectors) -> Result<(), ConnectorError> {
        let shared = self.fan_frequencies(board);
        for (fan, (plug, has)) in (0..).zip(self.fans.into_iter().zip(shared)) {
            match board.fans.get(usize::from(fan)) {
                _ if plug == FanPlug::PLAIN => {}
                None => return Err(ConnectorError::NoSuchFan(fan, board)),
                Some(None) if plug.frequency > 0 => return Err(ConnectorError::FixedFan(fan, board)),
                Some(_) if plug.frequency > 0 && plug.frequency != has => {
                    return Err(ConnectorError::SharedTimer(fan, has));
                }
                Some(_) => {}
            }
        }
        Ok(())
    }

    /// The frequency of each fan of a board in Hz: its own, or that of a fan on the same timer; 0 is the board's.
    #[must_use]
    pub fn fan_frequencies(&self, board: &BoardConnectors) -> [u16; FANS] {
        let mut all = [0; FANS];
        for (timer, plug) in board.fans.iter().zip(self.fans) {
            for (place, _) in all.iter_mut().zip(board.fans).filter(|(_, other)| timer.is_some() && *other == timer) {
                *place = if *place == 0 { plug.frequency } else { *place };
            }
        }
        all
    }

    fn check_heater(&self, heater: Heater, board: &'static BoardConnectors) -> Result<(), ConnectorError> {
        let settings = self.thermal.heater(heater);
        if settings.is_fitted && !board.outputs.has(settings.output) {
            Err(ConnectorError::NoSuchOutput(heater, settings.output, board))
        } else if settings.is_fitted && !board.sensors.contains(&settings.sensor) {
            Err(ConnectorError::NoSuchSensor(heater, settings.sensor, board))
        } else {
            Ok(())
        }
    }
}

fn check(
    plugs: impl Iterator<Item = (Plugged, ConnectorName)> + Clone,
    board: &'static BoardConnectors,
    is_one: fn(&BoardConnectors, ConnectorName, ConnectorName) -> bool,
) -> Result<(), ConnectorError> {
    for (at, (part, connector)) in plugs.clone().enumerate() {
        if connector.is_none() {
            if !board.is_bench {
                return Err(ConnectorError::Nowhere(part, board));
            }
            continue;
        }
        if !board.is_simulated && !part.connectors_of(board).contains(&connector) {
            return Err(ConnectorError::NoSuch(part, connector, board));
        }
        if let Some((other, earlier)) = plugs.clone().take(at).find(|(_, earlier)| is_one(board, *earlier, connector)) {
            return Err(ConnectorError::Twice([other, part], [earlier, connector]));
        }
    }
    Ok(())
}

impl Plugged {
    /// Where it may be plugged in.
    const fn connectors_of(self, board: &BoardConnectors) -> &'static [ConnectorName] {
        match self {
            Self::Motor(_) => board.sockets,
            Self::Endstop(_) | Self::Probe | Self::Filament | Self::Tachometer(_) => board.inputs,
        }
    }
}

impl Display for Plugged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Motor(motor) => write!(f, "motor {motor}"),
            Self::Endstop(axis) => write!(f, "endstop of {axis}"),
            Self::Probe => f.write_str("probe"),
            Self::Filament => f.write_str("filament sensor"),
            Self::Tachometer(fan) => write!(f, "tachometer of fan{fan}"),
        }
    }
}

impl Display for ConnectorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nowhere(part, board) => {
                write!(f, "{part}: it has no connector; the {} has ", board.name)?;
                list(f, sorted(part.connectors_of(board)))
            }
            Self::NoSuch(part, connector, board) => {
                write!(f, "{part}: the {} has no connector {connector}; it has ", board.name)?;
                list(f, sorted(part.connectors_of(board)))
            }
            Self::Twice([a, b], [one, other]) if one == other => {
                write!(f, "{a} and {b} have the same connector, {one}")
            }
            Self::Twice([a, b], [one, other]) => {
                write!(f, "{a} and {b} cannot both be used: {one} and {other} are one line to the processor")
            }
            Self::NoSuchOutput(heater, output, board) => {
                write!(f, "heater {}: the {} has no output {}; it has ", heater.name(), board.name, output.name())?;
                list(f, Output::ALL.into_iter().filter(|(o, _)| board.outputs.has(*o)).map(|(_, name)| name))
            }
            Self::NoSuchSensor(heater, sensor, board) => {
                write!(f, "heater {}: the {} has no sensor {}; it has ", heater.name(), board.name, sensor.name())?;
                list(f, board.sensors.iter().map(|sensor| sensor.name()))
            }
            Self::NoServo(board) => write!(f, "probe: the {} has no servo line for a bltouch", board.name),
            Self::NoAccelerometer(board) => write!(f, "accelerometer: the {} has no connector for one", board.name),
            Self::NoSuchExtraSensor(place, sensor, board) => {
                write!(f, "sensor {place}: the {} has no sensor {}; it has ", board.name, sensor.name())?;
                list(f, board.sensors.iter().map(|sensor| sensor.name()))
            }
            Self::NoSuchFan(fan, board) | Self::FixedFan(fan, board) => {
                let is_fixed = matches!(self, Self::FixedFan(..));
                let but = if is_fixed { "fixes its frequency" } else { "has no such fan" };
                write!(f, "fan{fan}: the {} {but}", board.name)
            }
            Self::SharedTimer(fan, has) => {
                write!(f, "fan{fan}: another fan on its timer has {has} Hz")
            }
        }
    }
}

impl core::error::Error for ConnectorError {}

/// Names in the order of their characters.
fn sorted(names: &[ConnectorName]) -> impl Iterator<Item = ConnectorName> {
    let after = |last: ConnectorName| names.iter().copied().filter(|name| *name > last).min();
    core::iter::successors(after(ConnectorName::NONE), move |last| after(*last))
}

fn list(f: &mut fmt::Formatter<'_>, names: impl Iterator<Item = impl Display>) -> fmt::Result {
    let mut is_empty = true;
    for name in names {
        write!(f, "{}{name}", if is_empty { "" } else { ", " })?;
        is_empty = false;
    }
    if is_empty { f.write_str("none") } else { Ok(()) }
}

#[cfg(test)]
mod tests;
