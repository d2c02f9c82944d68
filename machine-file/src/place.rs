//! Places: where in a TOML file an error is, and which name the writer may have meant.
//!
//! Nothing here knows the keys of a machine. Places come from the TOML parser. Suggestions come from the list of names
//! in the error.

use crate::short::short;
use std::fmt::{self, Display};
use toml::de::{DeTable, DeValue, Error};

/// A wrong name counts as a known one if it differs in at most this many of ten letters.
const WRONG_OF_TEN: usize = 4;

/// A place in a text, from 1; columns are characters.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Place {
    /// The line.
    pub line: usize,
    /// The character in it.
    pub column: usize,
}

impl Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

impl Place {
    /// The place of the byte at `offset`.
    #[must_use]
    pub fn of_byte(text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line = before.rfind('\n').map_or(before, |end| &before[end + 1..]);
        Self { line: 1 + before.matches('\n').count(), column: 1 + line.chars().count() }
    }

    /// The place of the last word of a key with its tables, which the file has.
    #[must_use]
    pub fn of_name(text: &str, key: &str) -> Option<Self> {
        let document = DeTable::parse(text).ok()?;
        let mut table = document.get_ref();
        let mut found = None;
        for part in key.split('.') {
            let (name, value) = table.iter().find(|(name, _)| name.get_ref().as_ref() == part)?;
            found = Some(name.span().start);
            let DeValue::Table(inner) = value.get_ref() else { break };
            table = inner;
        }
        found.map(|offset| Self::of_byte(text, offset))
    }

    /// The place of the value of a key with its tables (`axes.x.max_speed`); where the file has no such key, the header
    /// of the innermost table that it has.
    #[must_use]
    pub fn of_key(text: &str, key: &str) -> Option<Self> {
        let document = DeTable::parse(text).ok()?;
        let mut table = document.get_ref();
        let mut found = None;
        for part in key.split('.') {
            let Some((name, value)) = table.iter().find(|(name, _)| name.get_ref().as_ref() == part) else { break };
            match value.get_ref() {
                DeValue::Table(inner) => {
                    found = Some(name.span().start);
                    table = inner;
                }
                _ => return Some(Self::of_byte(text, value.span().start)),
            }
        }
        found.map(|offset| Self::of_byte(text, offset))
    }
}

/// A TOML error in one line, with the known name that is nearest to an unknown one.
#[must_use]
pub fn words(error: &Error) -> String {
    // Every other part is a name or a value of the file, in backticks.
    let message = error.message().lines().collect::<Vec<_>>().join(", ");
    let parts: Vec<_> = message.split('`').enumerate().collect();
    let parts = parts.into_iter().map(|(place, part)| if place % 2 == 1 { short(part) } else { part.into() });
    with_suggestion(&parts.collect::<Vec<_>>().join("`"))
}

/// A message about an unknown name and the known ones, with a suggestion.
#[must_use]
pub fn with_suggestion(message: &str) -> String {
    match suggestion(message) {
        Some(name) => format!("{message}; did you mean `{name}`?"),
        None => message.to_owned(),
    }
}

/// The suggested name, if `message` lists an unknown name and then the known ones, as serde's messages do.
fn suggestion(message: &str) -> Option<&str> {
    if !message.starts_with("unknown") {
        return None;
    }
    let mut names = message.split('`').skip(1).step_by(2);
    let wrong = names.next()?;
    nearest(wrong, names)
}

/// The known name that the writer of an unknown one may have meant.
#[must_use]
pub fn nearest<'n>(wrong: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let names = names.into_iter().map(|name| (strsim::damerau_levenshtein(wrong, name), name));
    let (distance, nearest) = names.min()?;
    let length = wrong.chars().count().max(nearest.chars().count());
    (10 * distance <= WRONG_OF_TEN * length).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"ü\" # one\n[axes.x]\n  max_speed = 5000\n[shaper]\ny = { kind = \"zv\", span = 99 }\n";

    fn place(key: &str) -> Option<(usize, usize)> {
        Place::of_key(TEXT, key).map(|place| (place.line, place.column))
    }

    #[test]
    fn a_key_is_where_its_value_begins() {
        assert_eq!(place("axes.x.max_speed"), Some((3, 15)));
        assert_eq!(place("shaper.y.span"), Some((5, 27)));
        assert_eq!(place("name"), Some((1, 8)));
        assert_eq!(Place::of_key("a.b.c = 1", "a.b.c"), Some(Place { line: 1, column: 9 }));
    }

    #[test]
    fn what_is_left_out_is_where_its_table_begins() {
        assert_eq!(place("axes.x.length"), Some((2, 7)));
        assert_eq!(place("axes.y.length"), Some((2, 2)));
        assert_eq!(place("corner.square_corner"), None);
    }

    #[test]
    fn columns_count_characters() {
        let place = Place::of_byte(TEXT, TEXT.find('#').unwrap());
        assert_eq!(place.to_string(), "1:12");
    }

    #[test]
    fn a_name_that_is_nearly_known_is_suggested() {
        let said = |wrong: &str| {
            suggestion(&format!("unknown field `{wrong}`, expected one of `max_speed`, `length`")).map(str::to_owned)
        };
        assert_eq!(said("max_sped"), Some("max_speed".to_owned()));
        assert_eq!(said("lenght"), Some("length".to_owned()));
        assert_eq!(said("colour"), None);
        assert_eq!(suggestion("missing field `a`, not `b`"), None);
    }
}
