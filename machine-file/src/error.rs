//! Errors in a machine file, and their places in the file.

use super::place::{self, Place};
use crate::short::short;
use crate::texts::{TEXTS, TextError};
use corehbot::settings::{ConnectorError, MachineName, Plugged, SHEETS, SettingsError};
use std::fmt::{self, Display};

/// An error in a machine file.
#[derive(Debug)]
pub enum MachineFileError {
    /// Not TOML.
    Syntax(toml::de::Error),
    /// A key or a name that there is not.
    Unknown {
        /// A `field` or a `variant`.
        what: &'static str,
        /// The key with its tables.
        key: String,
        /// The name in the file.
        name: String,
        /// The existing ones.
        known: Vec<String>,
    },
    /// A value of another kind.
    Kind {
        /// The key with its tables.
        key: String,
        /// The expected value.
        wanted: &'static str,
        /// The value in the file.
        found: String,
    },
    /// A list of another length.
    Length {
        /// The key with its tables.
        key: String,
        /// Values that it has.
        wanted: usize,
    },
    /// An invalid thermistor: the key with its tables.
    Thermistor(String),
    /// A value outside its range.
    Range {
        /// The key with its tables.
        key: String,
        /// The value in the file.
        value: f64,
        /// Least and greatest legal value.
        legal: String,
    },
    /// `corner` names no rule, or both.
    Corner,
    /// A list with more values than there may be.
    TooLong {
        /// The key with its tables.
        key: String,
        /// Values that it has at most.
        most: usize,
    },
    /// An invalid name of a motor.
    MotorName(String),
    /// An invalid `name`.
    Name(String),
    /// An invalid row of `mechanism`.
    Row {
        /// The key with its table.
        key: String,
        /// The row in the file.
        row: Vec<f64>,
    },
    /// An unknown name of a connector.
    Connector {
        /// The key with its table.
        key: String,
        /// The text in the file.
        value: String,
    },
    /// Steps a millimetre do not follow from the file.
    Resolution {
        /// The key with its tables.
        key: String,
        /// The problem.
        why: &'static str,
    },
    /// A text of the owner.
    Text(TextError),
    /// The board lacks a connector for a plugged-in part.
    Connectors(ConnectorError),
    /// The values do not go together.
    Settings(SettingsError),
}

impl Display for MachineFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(error) => f.write_str(&place::words(error)),
            Self::Unknown { what, name, known, .. } => {
                if *what == "field"
                    && let Some(answer) = crate::peers::answer(name)
                {
                    return write!(f, "unknown field `{}`: {answer}", short(name));
                }
                let known = known.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
                let message = format!("unknown {what} `{}`, expected one of {known}", short(name));
                f.write_str(&place::with_suggestion(&message))
            }
            Self::Kind { key, wanted, found } => write!(f, "{key} = {}: expected {wanted}", short(found)),
            Self::Length { key, wanted } => write!(f, "{key} has {wanted} values"),
            Self::Thermistor(_) => {
                f.write_str("thermistor is one of ")?;
                for (at, sheet) in SHEETS.iter().enumerate() {
                    let before = if at == 0 {
                        ""
                    } else if at + 1 == SHEETS.len() {
                        " and "
                    } else {
                        ", "
                    };
                    write!(f, "{before}{}", sheet.name)?;
                }
                f.write_str(
                    ", or an NTC: { points = [[25, 100000], [150, 1641.9], [250, 226.15]] } in C and Ohm, or { ohms = \
                     100000, beta = 3950 }",
                )
            }
            Self::Range { key, value, legal } => write!(f, "{key} = {value} is outside {legal}"),
            Self::Corner => f.write_str("corner needs exactly one of its keys: junction_deviation or square_corner"),
            Self::TooLong { key, most } => write!(f, "{key} has {most} values at most"),
            Self::MotorName(name) => {
                let (name, most) = (short(name), corehbot::motors::MotorName::LONGEST);
                write!(f, "motors.names: {name:?} is no name of a motor: up to {most} letters and digits")
            }
            Self::Name(name) => write!(
                f,
                "name = {:?} is not a name: up to {} letters, digits, blanks and {}, a blank neither first nor last",
                short(name),
                MachineName::LONGEST,
                MachineName::MARKS
            ),
            Self::Row { key, row } => {
                write!(
                    f,
                    "{key} = {} is not a row: -1, 0 or 1, all times one whole number up to 16, for x, y, z and, if \
                    not 0, for e",
                    short(&format!("{row:?}"))
                )
            }
            Self::Connector { key, value } => {
                write!(
                    f,
                    "{key} = {:?} is not a connector: its name on the board, up to 8 characters; perhaps ! before it",
                    short(value)
                )
            }
            Self::Resolution { key, why } => write!(f, "{key}: {why}"),
            Self::Text(error) => error.fmt(f),
            Self::Connectors(error) => error.fmt(f),
            Self::Settings(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MachineFileError {}

impl MachineFileError {
    /// A value of another kind.
    pub(crate) fn kind(key: &str, wanted: &'static str, found: &toml::Value) -> Self {
        Self::Kind { key: key.to_owned(), wanted, found: found.to_string() }
    }

    /// Whether it is one key that is wrong, whatever the others say.
    #[must_use]
    pub const fn is_of_one_key(&self) -> bool {
        matches!(
            self,
            Self::Syntax(_)
                | Self::Unknown { .. }
                | Self::Kind { .. }
                | Self::Length { .. }
                | Self::Thermistor(_)
                | Self::Range { .. }
                | Self::Row { .. }
                | Self::Connector { .. }
                | Self::TooLong { .. }
                | Self::MotorName(_)
                | Self::Name(_)
                | Self::Text(_)
        )
    }

    /// Where in the file it is, if it is at one place.
    #[must_use]
    pub fn place(&self, text: &str) -> Option<Place> {
        let key = match self {
            Self::Syntax(error) => return error.span().map(|span| Place::of_byte(text, span.start)),
            Self::Unknown { what: "field", key, .. } => return Place::of_name(text, key),
            Self::Unknown { key, .. }
            | Self::Kind { key, .. }
            | Self::Length { key, .. }
            | Self::TooLong { key, .. }
            | Self::Thermistor(key)
            | Self::Range { key, .. }
            | Self::Row { key, .. }
            | Self::Connector { key, .. }
            | Self::Resolution { key, .. } => key.clone(),
            Self::Connectors(error) => {
                return Place::of_key(text, &plugged(error)).or_else(|| Place::of_key(text, "board"));
            }
            Self::Corner => "corner.square_corner".to_owned(),
            Self::MotorName(_) | Self::Settings(SettingsError::MotorNames | SettingsError::NamedAsGroup(_)) => {
                "motors.names".to_owned()
            }
            Self::Settings(SettingsError::BeltCurrents { motors, .. }) => {
                // One of them is in the file.
                let keys = motors.map(|motor| Place::of_key(text, &format!("drivers.{motor}.current_ma")));
                return keys.into_iter().flatten().last();
            }
            Self::Name(_) => "name".to_owned(),
            Self::Text(error) => format!("{TEXTS}.{}", error.name),
            Self::Settings(SettingsError::OutOfRange(key)) => key.to_string(),
            Self::Settings(SettingsError::OutOfRangeBeside(key)) => (*key).to_owned(),
            Self::Settings(SettingsError::TooManySteps(table)) => format!("{table}.max_speed"),
            Self::Settings(SettingsError::NoSuchMicrosteps(table)) => format!("{table}.microsteps"),
            Self::Settings(SettingsError::MicrostepsDiffer { keys, .. }) => {
                // The second one is as good a place as the first.
                let keys = keys.map(|key| Place::of_key(text, &format!("{key}.microsteps")));
                return keys.into_iter().flatten().last();
            }
            Self::Settings(SettingsError::ResolutionsDiffer(axes)) => {
                // Two axes by their names; the second one is as good a place as the first.
                let axes = axes.split(" and ").map(|axis| format!("axes.{axis}.steps_per_mm"));
                return axes.filter_map(|key| Place::of_key(text, &key)).last();
            }
            Self::Settings(SettingsError::GuardsNothing(place)) => format!("sensors.{place}.guards"),
            Self::Settings(SettingsError::SharedHeater(what)) => format!("heaters.bed.{what}"),
            Self::Settings(SettingsError::Mechanism { .. } | SettingsError::Nameless(_)) => "mechanism".to_owned(),
            Self::Settings(SettingsError::Circulation) => "belt.closed".to_owned(),
            Self::Settings(SettingsError::NoProbe) => "probe.z_home".to_owned(),
            Self::Settings(SettingsError::HomingOrder) => "homing.order".to_owned(),
        };
        Place::of_key(text, &key)
    }
}

/// The key of the wrongly plugged-in part; of two, the second one's key.
fn plugged(error: &ConnectorError) -> String {
    match error {
        ConnectorError::Nowhere(part, _) | ConnectorError::NoSuch(part, ..) | ConnectorError::Twice([_, part], _) => {
            match part {
                Plugged::Motor(motor) => format!("motors.{motor}"),
                Plugged::Endstop(axis) => format!("endstops.{axis}"),
                Plugged::Probe => "endstops.probe".to_owned(),
                Plugged::Filament => "endstops.filament".to_owned(),
                Plugged::Tachometer(fan) => format!("fans.fan{fan}.tachometer"),
                Plugged::Supply => "supply.switch".to_owned(),
            }
        }
        ConnectorError::NoSuchOutput(heater, ..) => format!("heaters.{}.output", heater.name()),
        ConnectorError::NoSuchSensor(heater, ..) => format!("heaters.{}.sensor", heater.name()),
        ConnectorError::NoServo(_) => "probe.kind".to_owned(),
        ConnectorError::NoAccelerometer(_) => "accelerometer.kind".to_owned(),
        ConnectorError::NoSuchExtraSensor(place, ..) => format!("sensors.{place}.sensor"),
        ConnectorError::NoSuchFan(fan, _) => format!("fans.fan{fan}"),
        ConnectorError::FixedFan(fan, _) | ConnectorError::SharedTimer(fan, ..) => {
            format!("fans.fan{fan}.frequency")
        }
    }
}
