//! What can be wrong with a machine file, and where in the file it is.

use super::place::{self, Place};
use corehbot::settings::SettingsError;
use std::fmt::{self, Display};

/// What is wrong with a machine file.
#[derive(Debug)]
pub enum MachineFileError {
    /// Not TOML, an unknown key, or a value of the wrong type.
    Syntax(toml::de::Error),
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
    /// A row of `mechanism` that is none.
    Row {
        /// The key with its table.
        key: String,
        /// The row in the file.
        row: Vec<f64>,
    },
    /// The values do not go together.
    Settings(SettingsError),
}

impl Display for MachineFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(error) => f.write_str(&place::words(error)),
            Self::Range { key, value, legal } => write!(f, "{key} = {value} is outside {legal}"),
            Self::Corner => f.write_str(
                "corner wants either of its keys (junction_deviation, square_corner), not both and not none",
            ),
            Self::Row { key, row } => {
                write!(f, "{key} = {row:?} is no row: -1, 0 or 1 for x, y, z and, if not 0, for e")
            }
            Self::Settings(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MachineFileError {}

impl MachineFileError {
    /// Where in the file it is, if it is at one place.
    #[must_use]
    pub fn place(&self, text: &str) -> Option<Place> {
        let key = match self {
            Self::Syntax(error) => return error.span().map(|span| Place::of_byte(text, span.start)),
            Self::Range { key, .. } | Self::Row { key, .. } => key.clone(),
            Self::Corner => "corner.square_corner".to_owned(),
            Self::Settings(SettingsError::OutOfRange(key)) => (*key).to_owned(),
            Self::Settings(SettingsError::TooManySteps(table)) => format!("{table}.max_speed"),
            Self::Settings(SettingsError::NoSuchMicrosteps(table)) => format!("{table}.microsteps"),
            Self::Settings(SettingsError::ResolutionsDiffer(axes)) => {
                // Two axes by their names; the second one is as good a place as the first.
                let axes = axes.split(" and ").map(|axis| format!("axes.{axis}.steps_per_mm"));
                return axes.filter_map(|key| Place::of_key(text, &key)).last();
            }
            Self::Settings(SettingsError::SharedHeater(what)) => format!("heaters.bed.{what}"),
            Self::Settings(SettingsError::Mechanism(_)) => "mechanism".to_owned(),
        };
        Place::of_key(text, &key)
    }
}
