//! Whether a board has the connectors that a machine uses. Checked for machine files and images, by MACHINE_STORE and
//! when a board starts. M-codes are not checked, because none of them changes a plug.

use super::{FanPlug, PLACES, ProbeKind, SensorSource, Settings, Wiring};
use crate::connectors::{BoardConnectors, ConnectorName, FANS, Heater, Output, Sensor};
use crate::motors::{MOTORS, MotorName};
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
    /// The switch of the power supply.
    Supply,
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
        if self.wiring == const { Wiring::prototype() } {
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
        let mut plugs = Plugs::new();
        for motor in self.mechanism.fitted().iter() {
            plugs.add(Plugged::Motor(self.name_of(motor)), self.wiring.of(motor).connector, true);
        }
        plugs.check(board, |_, a, b| a == b)?;
        let mut contacts = Plugs::new();
        let axes = &self.wiring.endstops;
        for (part, plug, is_needed) in [
            (Plugged::Endstop("x"), &axes.x, true),
            (Plugged::Endstop("y"), &axes.y, true),
            (Plugged::Endstop("z"), &axes.z, !self.homes_z_by_probe()),
            (Plugged::Probe, &self.probe_plug, self.probe.is_fitted()),
            (Plugged::Filament, &self.filament, false),
        ] {
            contacts.add(part, plug.connector, is_needed);
        }
        for (fan, plug) in (0..).zip(&self.fans) {
            contacts.add(Plugged::Tachometer(fan), plug.tachometer.input(), false);
        }
        contacts.check(board, BoardConnectors::is_one_line)?;
        if board.is_simulated {
            return Ok(());
        }
        if let Some(output) = self.supply.output(board).filter(|output| !board.supply_switches.contains(output)) {
            return Err(ConnectorError::NoSuch(Plugged::Supply, output, board));
        }
        if self.has_servo() && !board.has_servo {
            return Err(ConnectorError::NoServo(board));
        }
        if self.accelerometer.kind.is_some() && board.accelerometer.is_none() {
            return Err(ConnectorError::NoAccelerometer(board));
        }
        for heater in Heater::ALL {
            self.check_heater(heater, board)?;
        }
        self.check_fans(board)?;
        for ((place, _), extra) in PLACES.iter().zip(&self.thermal.sensors) {
            let is_there = match extra.sensor {
                SensorSource::At(sensor) => board.sensors.contains(&sensor),
                SensorSource::Mcu => board.has_mcu_sensor(),
            };
            if extra.is_fitted && !is_there {
                return Err(ConnectorError::NoSuchExtraSensor(place, extra.sensor, board));
            }
        }
        Ok(())
    }

    /// Each fan with a frequency is on a timer that has no other.
    fn check_fans(&self, board: &'static BoardConnectors) -> Result<(), ConnectorError> {
        let shared = self.fan_frequencies(board);
        for (fan, (plug, has)) in (0..).zip(self.fans.iter().zip(shared)) {
            match board.fans.get(usize::from(fan)) {
                _ if *plug == FanPlug::PLAIN => {}
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
        for (timer, plug) in board.fans.iter().zip(&self.fans) {
            for (place, other) in all.iter_mut().zip(board.fans) {
                if *place == 0 && timer.is_some() && other == timer {
                    *place = plug.frequency;
                }
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

/// Parts with the connectors that they are plugged into.
struct Plugs(heapless::Vec<(Plugged, ConnectorName), MOST_PLUGS>);

/// The motors, or all contacts: of three axes, the probe, filament and the fans.
const MOST_PLUGS: usize = if MOTORS > 5 + FANS { MOTORS } else { 5 + FANS };

impl Plugs {
    const fn new() -> Self {
        Self(heapless::Vec::new())
    }

    /// Adds a part, unless it has no connector and needs none.
    #[inline(never)]
    fn add(&mut self, part: Plugged, connector: ConnectorName, is_needed: bool) {
        if is_needed || !connector.is_none() {
            // There is room for all.
            let _ = self.0.push((part, connector));
        }
    }

    /// Checks that the board has each connector, and that no two are one.
    #[inline(never)]
    fn check(
        &self,
        board: &'static BoardConnectors,
        is_one: fn(&BoardConnectors, ConnectorName, ConnectorName) -> bool,
    ) -> Result<(), ConnectorError> {
        let mut earlier: &[(Plugged, ConnectorName)] = &[];
        let mut left = self.0.as_slice();
        while let [(part, connector), others @ ..] = left {
            let (part, connector) = (*part, *connector);
            if connector.is_none() {
                if !board.is_bench {
                    return Err(ConnectorError::Nowhere(part, board));
                }
            } else if !board.is_simulated && !part.connectors_of(board).contains(&connector) {
                return Err(ConnectorError::NoSuch(part, connector, board));
            } else if let Some((other, its)) = earlier.iter().find(|(_, its)| is_one(board, *its, connector)) {
                return Err(ConnectorError::Twice([*other, part], [*its, connector]));
            }
            left = others;
            earlier = self.0.get(..self.0.len() - left.len()).unwrap_or_default();
        }
        Ok(())
    }
}

impl Plugged {
    /// Where it may be plugged in.
    const fn connectors_of(self, board: &BoardConnectors) -> &'static [ConnectorName] {
        match self {
            Self::Motor(_) => board.sockets,
            Self::Endstop(_) | Self::Probe | Self::Filament | Self::Tachometer(_) => board.inputs,
            Self::Supply => board.supply_switches,
        }
    }
}

impl Display for Plugged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Motor(motor) => put!(f, "motor {motor}"),
            Self::Endstop(axis) => put!(f, "endstop of {axis}"),
            Self::Probe => put!(f, "probe"),
            Self::Filament => put!(f, "filament sensor"),
            Self::Tachometer(fan) => put!(f, "tachometer of fan{fan}"),
            Self::Supply => put!(f, "power supply"),
        }
    }
}

impl Display for ConnectorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nowhere(part, board) => {
                put!(f, "{part}: it has no connector; the {} has ", board.name)?;
                list_connectors(f, part.connectors_of(board))
            }
            Self::NoSuch(part, connector, board) => {
                put!(f, "{part}: the {} has no connector {connector}; it has ", board.name)?;
                list_connectors(f, part.connectors_of(board))
            }
            Self::Twice([a, b], [one, other]) if one == other => {
                put!(f, "{a} and {b} have the same connector, {one}")
            }
            Self::Twice([a, b], [one, other]) => {
                put!(f, "{a} and {b} cannot both be used: {one} and {other} are one line to the processor")
            }
            Self::NoSuchOutput(heater, output, board) => {
                put!(f, "heater {}: the {} has no output {}; it has ", heater.name(), board.name, output.name())?;
                let mut list = List::new(f);
                for (output, name) in &Output::ALL {
                    if board.outputs.has(*output) {
                        list.item(name)?;
                    }
                }
                list.end()
            }
            Self::NoSuchSensor(heater, sensor, board) => {
                put!(f, "heater {}: the {} has no sensor {}; it has ", heater.name(), board.name, sensor.name())?;
                list_sensors(f, board.sensors)
            }
            Self::NoServo(board) => put!(f, "probe: the {} has no servo line for a bltouch", board.name),
            Self::NoAccelerometer(board) => put!(f, "accelerometer: the {} has no connector for one", board.name),
            Self::NoSuchExtraSensor(place, sensor, board) => {
                put!(f, "sensor {place}: the {} has no sensor {}; it has ", board.name, sensor.name())?;
                list_sensors(f, board.sensors)
            }
            Self::NoSuchFan(fan, board) | Self::FixedFan(fan, board) => {
                let is_fixed = matches!(self, Self::FixedFan(..));
                let but = if is_fixed { packed!("fixes its frequency") } else { packed!("has no such fan") };
                put!(f, "fan{fan}: the {} {but}", board.name)
            }
            Self::SharedTimer(fan, has) => {
                put!(f, "fan{fan}: another fan on its timer has {has} Hz")
            }
        }
    }
}

impl core::error::Error for ConnectorError {}

/// A list of names with commas, or "none".
struct List<'a, 'b> {
    f: &'a mut fmt::Formatter<'b>,
    is_empty: bool,
}

impl<'a, 'b> List<'a, 'b> {
    const fn new(f: &'a mut fmt::Formatter<'b>) -> Self {
        Self { f, is_empty: true }
    }

    #[inline(never)]
    fn item(&mut self, name: &str) -> fmt::Result {
        if !self.is_empty {
            self.f.write_str(", ")?;
        }
        self.is_empty = false;
        self.f.write_str(name)
    }

    fn end(self) -> fmt::Result {
        if self.is_empty { self.f.write_str("none") } else { Ok(()) }
    }
}

/// Connectors in the order of their characters.
#[inline(never)]
fn list_connectors(f: &mut fmt::Formatter<'_>, names: &[ConnectorName]) -> fmt::Result {
    let (mut list, mut last) = (List::new(f), ConnectorName::NONE);
    while let Some(next) = names.iter().filter(|name| **name > last).min() {
        list.item(next.as_str())?;
        last = *next;
    }
    list.end()
}

#[inline(never)]
fn list_sensors(f: &mut fmt::Formatter<'_>, sensors: &[Sensor]) -> fmt::Result {
    let mut list = List::new(f);
    for sensor in sensors {
        list.item(sensor.name())?;
    }
    list.end()
}

#[cfg(test)]
mod tests;
