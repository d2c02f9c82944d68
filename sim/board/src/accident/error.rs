//! Error: why a text describes no accident.

use super::GRAMMAR;
use super::table::{Family, ROWS, Row};
use corehbot_machine_file::nearest;
use std::fmt;

/// Why a text does not describe an accident.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AccidentError {
    /// It has no time.
    NoTime(String),
    /// It has too many parts.
    Parts(String),
    /// No accident has this name.
    Word(String),
    /// This accident needs a place: its name, and what the place is.
    NoPlace(&'static str, String),
    /// This accident has no such place: its name, the places that it has, the text.
    Place(&'static str, String, String),
    /// This accident has no HOW: its name, the text.
    NoHow(&'static str, String),
    /// This is not how much of it there can be: the text, and what is expected.
    How(String, &'static str),
    /// This 0 has a sign, which would be a direction.
    Sign(String),
    /// The time is not valid: the text, and what it would be.
    Time(String, &'static str),
    /// It would end as it begins: the text of the second time.
    Momentary(String),
    /// An accident that lasts for good has no end.
    ForGood(&'static str),
    /// A brake without a force, or with more than its four parts.
    Brake(String),
}

/// The words of all accidents, each once.
pub(super) fn all_words() -> Vec<&'static str> {
    let mut words = Vec::new();
    for Row { word, .. } in &ROWS {
        if !words.contains(word) {
            words.push(*word);
        }
    }
    words
}

impl fmt::Display for AccidentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTime(text) => write!(f, "`{text}` has no time: expected {GRAMMAR}, such as open:hotend@60s"),
            Self::Parts(text) => {
                write!(f, "`{text}` has too many parts: expected {GRAMMAR}, such as rub:m1:15N@20s+5s")
            }
            Self::Word(text) => {
                let words = all_words();
                write!(f, "`{text}` is not an accident; expected {}", words.join(", "))?;
                match nearest(text, words) {
                    Some(word) => write!(f, "; did you mean `{word}`?"),
                    None => Ok(()),
                }
            }
            Self::NoPlace(word, places) => write!(f, "{word} needs a place: {places}, such as {word}:m8@20s"),
            Self::Place(word, places, text) => write!(f, "`{text}` is not a place for {word}: {places}"),
            Self::NoHow(word, text) => write!(f, "`{text}` is one part too many: {word} has a place and a time alone"),
            Self::How(text, says) => write!(f, "`{text}` is not {says}"),
            Self::Sign(text) => write!(f, "`{text}` is 0 with a sign: a direction needs a force of more than 0 N"),
            Self::Time(text, clock) => write!(f, "`{text}` is not a {clock}: 60s, 2.5m, 1h; a year at most"),
            Self::Momentary(text) => {
                write!(f, "`+{text}` ends the accident as it begins; leave it out for an accident for good")
            }
            Self::ForGood(word) => write!(f, "{word} is for good: it has no second time"),
            Self::Brake(text) => {
                write!(f, "`{text}` is not MOTOR,N[,S[,MS]], which is rub:MOTOR:N@TIME[+TIME] today")
            }
        }
    }
}

impl std::error::Error for AccidentError {}

impl AccidentError {
    /// The time of a family is wrong.
    pub(super) fn time(text: &str, family: Family) -> Self {
        Self::Time(text.to_owned(), family.clock())
    }
}
