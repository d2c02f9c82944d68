//! Numbers: from TOML and back.

use crate::error::MachineFileError;
use crate::keys::{bits_of, fraction, legal_words};
use corehbot::settings::rows::{Legal, ValueKind};
use toml::Value as Toml;

/// A number in its range.
///
/// # Errors
/// The problem of the value.
pub(crate) fn number(key: &str, toml: &Toml, kind: ValueKind, legal: Legal) -> Result<i64, MachineFileError> {
    let number = float(key, toml)?;
    let is_whole = number.fract() == 0.0 || !matches!(kind, ValueKind::Whole | ValueKind::OfMotor | ValueKind::Place);
    match bits_of(number, fraction(kind)) {
        Some(bits) if is_whole && legal.holds(bits) => Ok(bits),
        _ => Err(MachineFileError::Range { key: key.to_owned(), value: number, legal: legal_words(legal, kind) }),
    }
}

/// Any number.
///
/// # Errors
/// The value is not a number.
pub(crate) fn float(key: &str, toml: &Toml) -> Result<f64, MachineFileError> {
    match toml {
        Toml::Integer(number) => Ok(*number as f64),
        Toml::Float(number) => Ok(*number),
        other => Err(MachineFileError::kind(key, "a number", other)),
    }
}

/// A number of TOML, a whole one if it is.
pub(crate) fn float_toml(number: f64) -> Toml {
    if number.fract() == 0.0 { Toml::Integer(number as i64) } else { Toml::Float(number) }
}
