//! Read: a text becomes an accident, and an accident a text.

use super::earlier;
use super::error::AccidentError;
use super::table::{How, Place, ROWS, Row};
use std::fmt;
use std::str::FromStr;

/// Latest time, in s: a year.
const LATEST_S: f64 = 31_536_000.0;

/// Something that breaks.
#[derive(Clone, Debug)]
pub struct Accident {
    /// Its row of the table.
    pub row: &'static Row,
    /// Where.
    pub place: Place,
    /// The same by its name: of a part of belts the motor's or the pulley's.
    pub name: String,
    /// How much, if that was said or is usual.
    pub how: Option<f64>,
    /// -1 and 1 are one direction alone, 0 is both.
    pub direction: i8,
    /// When, in s by its family's clock.
    pub at_s: f64,
    /// For how many s; `None` is for good.
    pub lasts_s: Option<f64>,
    /// As it was written, or its spelling of today.
    pub text: String,
}

/// The parts of a text, none of them looked into.
struct Parts<'t> {
    word: &'t str,
    name: Option<&'t str>,
    how: Option<&'t str>,
    at: &'t str,
    lasts: Option<&'t str>,
}

impl<'t> Parts<'t> {
    fn of(text: &'t str) -> Result<Self, AccidentError> {
        let (what, time) = text.rsplit_once('@').ok_or_else(|| AccidentError::NoTime(text.to_owned()))?;
        let (at, lasts) = time.split_once('+').map_or((time, None), |(at, lasts)| (at, Some(lasts.trim())));
        let (word, name, how) = match what.split(':').map(str::trim).collect::<Vec<_>>()[..] {
            [word] => (word, None, None),
            [word, name] => (word, Some(name), None),
            [word, name, how] => (word, Some(name), Some(how)),
            _ => return Err(AccidentError::Parts(text.to_owned())),
        };
        Ok(Self { word, name, how, at: at.trim(), lasts })
    }

    /// The row and the place. Of two rows with one word the place decides.
    fn row(&self) -> Result<(&'static Row, Place, &str), AccidentError> {
        let rows: Vec<&'static Row> = ROWS.iter().filter(|row| row.word == self.word).collect();
        let Some(first) = rows.first() else { return Err(AccidentError::Word(self.word.to_owned())) };
        let usual = || rows.iter().find_map(|row| row.names().next());
        let missing = || AccidentError::NoPlace(first.word, first.places.says());
        let name = self.name.or_else(usual).ok_or_else(missing)?;
        // Parts of belts may have any name, so a list of names goes first.
        let listed = rows.iter().filter(|row| row.names().next().is_some());
        let others = rows.iter().filter(|row| row.names().next().is_none());
        let found = listed.chain(others).find_map(|row| Some((*row, row.place_of(name)?, name)));
        found.ok_or_else(|| AccidentError::Place(first.word, first.places.says(), name.to_owned()))
    }
}

/// A time such as `60s`, `2.5m`, `1h`, in s.
fn seconds(text: &str) -> Option<f64> {
    let (number, unit) = [("s", 1.0), ("m", 60.0), ("h", 3600.0)]
        .into_iter()
        .find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)))?;
    let number = number.parse::<f64>().ok()?;
    Some(number * unit).filter(|seconds| (0.0..=LATEST_S).contains(seconds))
}

impl How {
    /// How much of it a text says: a number, its unit maybe after it.
    fn read(&self, text: &str) -> Result<f64, AccidentError> {
        let [least, most] = self.bounds;
        let number = text.strip_suffix(self.unit).unwrap_or(text).trim();
        let is_right = |number: &f64| {
            (least..=most).contains(number) && (!self.is_count || number.fract() == 0.0 && *number != 0.0)
        };
        let number = number.parse().ok().filter(is_right);
        let number = number.ok_or_else(|| AccidentError::How(text.to_owned(), self.says))?;
        if number == 0.0 && text.starts_with(['+', '-']) {
            return Err(AccidentError::Sign(text.to_owned()));
        }
        Ok(number)
    }
}

impl FromStr for Accident {
    type Err = AccidentError;

    fn from_str(text: &str) -> Result<Self, AccidentError> {
        let text = earlier::today(text)?.unwrap_or_else(|| text.to_owned());
        let parts = Parts::of(&text)?;
        let (row, place, name) = parts.row()?;
        let seconds = |text: &str| seconds(text).ok_or_else(|| AccidentError::time(text, row.family));
        if parts.lasts.is_some() && !row.can_end {
            return Err(AccidentError::ForGood(row.word));
        }
        let lasts_s = parts.lasts.map(seconds).transpose()?;
        if let (Some(text), Some(0.0)) = (parts.lasts, lasts_s) {
            return Err(AccidentError::Momentary(text.to_owned()));
        }
        let direction = match parts.how.and_then(|how| how.chars().next()) {
            Some('+') => 1,
            Some('-') => -1,
            _ => 0,
        };
        let how = match (parts.how, row.how) {
            (Some(text), Some(how)) => Some(how.read(text)?),
            (Some(text), None) => return Err(AccidentError::NoHow(row.word, text.to_owned())),
            (None, how) => how.and_then(|how| how.usual),
        };
        let (name, at_s) = (name.to_owned(), seconds(parts.at)?);
        Ok(Self { row, place, name, how, direction, at_s, lasts_s, text })
    }
}

impl fmt::Display for Accident {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { row, name, how, direction, at_s, lasts_s, .. } = self;
        write!(f, "{}:{name}", row.word)?;
        if let (Some(how), Some(How { unit, .. })) = (how, row.how) {
            write!(f, ":{}{how}{unit}", if *direction > 0 { "+" } else { "" })?;
        }
        write!(f, "@{at_s}s")?;
        lasts_s.map_or(Ok(()), |lasts_s| write!(f, "+{lasts_s}s"))
    }
}
