//! Errors of a study's file, and their places in it.

use corehbot_machine_file::{Place, with_suggestion, words};
use std::fmt;

/// The error.
#[derive(Debug)]
pub(super) enum StudyError {
    /// Not TOML, an unknown key, or a value of the wrong type.
    Syntax(toml::de::Error),
    /// A number that no machine has by this name, at a byte of the file.
    UnknownNumber { at: usize, key: String, known: Vec<String> },
    /// The value of a key is impossible.
    Value { key: String, why: String },
}

impl StudyError {
    pub(super) fn value(key: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Value { key: key.into(), why: why.into() }
    }

    /// The place in the text, if it is at one.
    pub(super) fn place(&self, text: &str) -> Option<Place> {
        match self {
            Self::Syntax(error) => error.span().map(|span| Place::of_byte(text, span.start)),
            Self::UnknownNumber { at, .. } => Some(Place::of_byte(text, *at)),
            Self::Value { key, .. } => Place::of_key(text, key),
        }
    }
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(error) => f.write_str(&words(error)),
            Self::UnknownNumber { key, known, .. } => {
                let known: Vec<String> = known.iter().map(|key| format!("`{key}`")).collect();
                let message = format!("unknown number `{key}`, expected one of {}", known.join(", "));
                f.write_str(&with_suggestion(&message))
            }
            Self::Value { key, why } => write!(f, "{key}: {why}"),
        }
    }
}

impl std::error::Error for StudyError {}
