//! Values: from the TOML value behind a key to a setting's value, and the reverse.

use crate::error::MachineFileError;
use crate::keys::{names_of, shortest};
pub(crate) use crate::numbers::{float, float_toml, number};
use crate::thermistor;
use corehbot::kinematics::{self, MOST_MULTIPLE, Row};
use corehbot::motors::MotorName;
use corehbot::settings::rows::{Field, Legal, Text24, Value, ValueKind};
use corehbot::settings::{EndstopPlug, MachineName, Range, Thermistor, ranges};
use corehbot_twin::params::{Each, MOST_PARTS, Row as TwinRow};
use toml::Value as Toml;

/// The number 0 of a setting whose bits 0 are "auto": the least number above it.
const PLAIN_ZERO: i64 = 1;

/// The value of a setting.
///
/// # Errors
/// The problem of the value.
pub(crate) fn value(key: &str, toml: &Toml, kind: ValueKind, legal: Legal) -> Result<Value, MachineFileError> {
    match kind {
        ValueKind::Fixed(_) | ValueKind::Whole => number(key, toml, kind, legal).map(Value::Number),
        ValueKind::Auto(_) => match toml {
            Toml::String(word) if word == "auto" => Ok(Value::Number(0)),
            // 0 is "auto", which a file says by that word. Where 0 is a legal number too, the least one above it says
            // 0.
            Toml::Integer(_) | Toml::Float(_) => {
                let bits = number(key, toml, kind, Legal { may_be_zero: false, ..legal })?;
                Ok(Value::Number(if bits == 0 { PLAIN_ZERO } else { bits }))
            }
            other if legal.least < 0 => Err(MachineFileError::kind(key, "\"auto\" or a number", other)),
            other => Err(MachineFileError::kind(key, "\"auto\" or a number of seconds", other)),
        },
        // The greatest is no place, which a file does not say.
        ValueKind::Place => number(key, toml, kind, Legal { most: legal.most - 1, ..legal }).map(Value::Number),
        // 0 is the value of the group, which a file does not say.
        ValueKind::OfMotor => number(key, toml, kind, Legal { may_be_zero: false, ..legal }).map(Value::Number),
        ValueKind::Switch => match toml {
            Toml::Boolean(is) => Ok(Value::Number((*is).into())),
            other => Err(MachineFileError::kind(key, "true or false", other)),
        },
        ValueKind::Choice(name) => match toml {
            Toml::String(word) => choice(key, word, &names_of(name)).map(|number| Value::Number(number as i64)),
            other => Err(MachineFileError::kind(key, "a name in quotes", other)),
        },
        ValueKind::Name => match toml {
            Toml::String(name) if MachineName::new(name).is_some() => Ok(text(name)),
            Toml::String(name) => Err(MachineFileError::Name(name.clone())),
            other => Err(MachineFileError::kind(key, "a name in quotes", other)),
        },
        ValueKind::MotorName => match toml {
            Toml::String(name) if MotorName::new(name).is_some_and(|name| !name.is_none()) => Ok(text(name)),
            Toml::String(name) => Err(MachineFileError::MotorName(name.clone())),
            other => Err(MachineFileError::kind(key, "names in quotes", other)),
        },
        ValueKind::Plug => match toml {
            Toml::String(name) => plug(key, name),
            other => Err(MachineFileError::kind(key, "the name of a connector in quotes", other)),
        },
        // No name begins with the mark that inverts.
        ValueKind::Connector => match toml {
            Toml::String(name) if !name.starts_with('!') => plug(key, name),
            other => Err(MachineFileError::kind(key, "the name of an output in quotes, without !", other)),
        },
        ValueKind::Thermistor => thermistor::read(key, toml).map(|thermistor| thermistor.get()),
        ValueKind::MotorRow => match toml {
            Toml::Array(items) => motor_row(key, items).map(|row| row.get()),
            other => Err(MachineFileError::kind(key, "a list of numbers", other)),
        },
    }
}

/// The numbers of a row of the twin: one, or a list where there are several parts.
///
/// # Errors
/// The problem of the value.
pub(crate) fn each(key: &str, toml: &Toml, row: &TwinRow) -> Result<Each, MachineFileError> {
    let listed = match toml {
        Toml::Array(items) if row.is_list() => items.iter().map(|item| float(key, item)).collect::<Result<_, _>>()?,
        Toml::Array(_) => return Err(MachineFileError::kind(key, "a number", toml)),
        _ => vec![float(key, toml)?],
    };
    // No number stands for another key's number, of a row that has none by itself.
    if listed.is_empty() && row.default.is_some() {
        return Err(MachineFileError::kind(key, "a number, or a list of numbers", toml));
    }
    if let Some(value) = listed.iter().find(|value| !row.allows(**value)) {
        return Err(MachineFileError::Range { key: key.to_owned(), value: *value, legal: row.legal().to_owned() });
    }
    Each::listed(&listed).ok_or_else(|| MachineFileError::TooLong { key: key.to_owned(), most: MOST_PARTS })
}

/// The number of a name.
///
/// # Errors
/// The word is none of the names.
pub(crate) fn choice(key: &str, word: &str, names: &[&'static str]) -> Result<usize, MachineFileError> {
    names.iter().position(|name| *name == word).ok_or_else(|| MachineFileError::Unknown {
        what: "variant",
        key: key.to_owned(),
        name: word.to_owned(),
        known: names.iter().map(|name| (*name).to_owned()).collect(),
    })
}

fn text(text: &str) -> Value {
    Text24::try_from(text).map_or(Value::Absent, Value::Text)
}

/// The name of a connector, which the field itself checks.
fn plug(key: &str, name: &str) -> Result<Value, MachineFileError> {
    let value = text(name);
    let mut plug = EndstopPlug::NONE;
    // An empty connector cannot be inverted.
    if name != "!" && plug.set(&value) {
        return Ok(value);
    }
    Err(MachineFileError::Connector { key: key.to_owned(), value: name.to_owned() })
}

/// x, y, z and perhaps e.
fn motor_row(key: &str, items: &[Toml]) -> Result<Row, MachineFileError> {
    let listed = items.iter().map(|item| float(key, item)).collect::<Result<Vec<_>, _>>()?;
    let mut row = [0; 4];
    let is_of_numbers = row.iter_mut().zip(&listed).all(|(slot, times)| {
        let legal = (-MOST_MULTIPLE..=MOST_MULTIPLE).find(|legal| f64::from(*legal) == *times);
        *slot = legal.unwrap_or_default();
        legal.is_some()
    });
    if is_of_numbers && kinematics::row_number(row).is_some() && matches!(listed.len(), 3 | 4) {
        Ok(row)
    } else {
        Err(MachineFileError::Row { key: key.to_owned(), row: listed })
    }
}

/// Full steps a turn: from tin-can motors of 18 degrees to motors of 0.45 degrees.
pub(crate) const FULL_STEPS: Range<u16> = Range { least: 20, most: 800 };

/// A value as a machine file has it; `None` if it is left out.
pub(crate) fn toml(value: &Value, kind: ValueKind) -> Option<Toml> {
    Some(match (value, kind) {
        (Value::Absent, _) | (Value::Number(0), ValueKind::OfMotor) => return None,
        (Value::Number(number), ValueKind::Place) if *number == i64::from(ranges::NOWHERE) => return None,
        (Value::Number(0), ValueKind::Auto(_)) => "auto".into(),
        (Value::Number(PLAIN_ZERO), ValueKind::Auto(_)) => 0.into(),
        (Value::Number(bits), ValueKind::Fixed(fraction) | ValueKind::Auto(fraction)) => {
            float_toml(shortest(*bits, fraction))
        }
        (Value::Number(number), ValueKind::Switch) => (*number != 0).into(),
        (Value::Number(number), ValueKind::Choice(name)) => name(usize::try_from(*number).ok()?)?.into(),
        (Value::Number(_), ValueKind::Thermistor) => {
            let mut kind = Thermistor::PT1000;
            kind.set(value).then_some(())?;
            match kind {
                Thermistor::Beta { ohms, beta, cubic } => thermistor::written(ohms, beta, cubic),
                Thermistor::Sheet(_) => kind.sheet()?.name.into(),
            }
        }
        (Value::Number(_), ValueKind::MotorRow) => {
            let mut row = Row::default();
            row.set(value).then_some(())?;
            Toml::Array(row.map(|times| i64::from(times).into()).to_vec())
        }
        (
            Value::Number(number),
            ValueKind::Whole
            | ValueKind::OfMotor
            | ValueKind::Place
            | ValueKind::Name
            | ValueKind::MotorName
            | ValueKind::Plug
            | ValueKind::Connector,
        ) => (*number).into(),
        (Value::Text(text), _) => text.as_str().into(),
    })
}
