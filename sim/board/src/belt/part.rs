//! Accidents of parts: pulleys, their screws, teeth and cords of belts, as the command line has them. One row of
//! [`KINDS`] is one kind. The grammar, its errors, the list in docs/explanation/belt/plant.md and the soak follow that
//! table.
//!
//! `WHAT:WHERE[:HOW]@TIME[+TIME]`: WHERE is a motor of a belt by its name in the machine file, or a pulley by its
//! number in `twin geometry`. The time is motion time, as that of a brake; the second one says how long it lasts.

use crate::heat_plant::accident::seconds;
use std::fmt;
use std::str::FromStr;

/// The effect of a kind of accident.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Does {
    /// A pulley does not turn.
    Seize,
    /// A motor's pulley slips on its shaft.
    Loosen,
    /// A belt jumps over teeth of a motor's pulley.
    Jump,
    /// Cords of a motor's belt break.
    Weaken,
}

/// A kind of accident.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Its effect.
    pub does: Does,
    /// The meaning of HOW: unit, bounds, and the number without one, if that is not computed.
    pub how: How,
    /// Its description for people.
    pub says: &'static str,
}

/// How much of it.
#[derive(Clone, Copy, Debug)]
pub struct How {
    /// Its unit, which may be left out.
    pub unit: &'static str,
    /// What it is.
    pub says: &'static str,
    least: f64,
    most: f64,
    usual: Option<f64>,
}

/// Every kind. Bounds of forces are those of hits and brakes. 10 N, half of the cords and one tooth are assumed.
pub const KINDS: [Kind; 4] = [
    Kind {
        name: "seized",
        does: Does::Seize,
        how: How { unit: "N", says: "a force of 0 to 10000 N", least: 0.0, most: 10_000.0, usual: None },
        says: "the pulley does not turn: a motor's stalls its motor, over any other the belt slides",
    },
    Kind {
        name: "loose",
        does: Does::Loosen,
        how: How {
            unit: "N",
            says: "a force of 0 to 10000 N; a sign before it is one direction",
            least: -10_000.0,
            most: 10_000.0,
            usual: Some(10.0),
        },
        says: "the motor's pulley slips on its shaft when the belt pulls more than HOW: both ways, +HOW only as the \
               motor drives forward, -HOW only backward",
    },
    Kind {
        name: "jump",
        does: Does::Jump,
        how: How { unit: "", says: "a number of teeth, -50 to 50", least: -50.0, most: 50.0, usual: Some(1.0) },
        says: "the belt jumps HOW teeth of 2 mm over the motor's pulley: it is so far ahead then",
    },
    Kind {
        name: "cord",
        does: Does::Weaken,
        how: How { unit: "%", says: "1 to 100 %", least: 1.0, most: 100.0, usual: Some(50.0) },
        says: "cords of the motor's belt break: HOW of its stiffness and tension is left",
    },
];

/// A part that breaks.
#[derive(Clone, Debug)]
pub struct PartAccident {
    /// Its kind.
    pub kind: &'static Kind,
    /// The motor or pulley.
    pub place: String,
    /// How much, if that was said or is usual.
    pub how: Option<f64>,
    /// -1 and 1 are one direction alone, 0 is both.
    pub direction: i8,
    /// When, in s of motion time.
    pub from_s: f64,
    /// For how many ms; `None` is for good.
    pub ms: Option<f64>,
    /// As it was written.
    pub text: String,
}

/// Why a text does not describe an accident.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PartError {
    /// It has not the parts that it needs.
    Form,
    /// The kind is unknown.
    Kind(String),
    /// This is not how much of it there can be: the text, and what is expected.
    How(String, &'static str),
    /// This 0 has a sign, which would be a direction.
    Sign(String),
    /// The time is not valid.
    Time(String),
    /// It would end as it begins: the text of the second time.
    Momentary(String),
    /// A kind that lasts for good has no end.
    ForGood(&'static str),
}

impl fmt::Display for PartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Form => {
                f.write_str("expected WHAT:WHERE[:HOW]@TIME[+TIME], such as seized:m8@20s or loose:m1:15N@20s+5s")
            }
            Self::Kind(text) => {
                let names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
                write!(f, "`{text}` is not an accident; expected {} (--brake rubs on a motor)", names.join(", "))
            }
            Self::How(text, says) => write!(f, "`{text}` is not {says}"),
            Self::Sign(text) => write!(f, "`{text}` is 0 with a sign: a direction needs a force of more than 0 N"),
            Self::Time(text) => write!(f, "`{text}` is not a motion time: 60s, 2.5m, 1h; a year at most"),
            Self::Momentary(text) => {
                write!(f, "`+{text}` ends the accident as it begins; leave it out for an accident for good")
            }
            Self::ForGood(kind) => write!(f, "{kind} is for good: it has no second time"),
        }
    }
}

impl std::error::Error for PartError {}

impl Kind {
    /// How much of it a text says: a number, its unit maybe after it.
    fn how_of(&self, text: &str) -> Result<f64, PartError> {
        let How { unit, says, least, most, .. } = self.how;
        let number = text.strip_suffix(unit).unwrap_or(text).trim();
        let is_right = |number: &f64| {
            (least..=most).contains(number) && (self.does != Does::Jump || number.fract() == 0.0 && *number != 0.0)
        };
        let number = number.parse().ok().filter(is_right).ok_or_else(|| PartError::How(text.to_owned(), says))?;
        if number == 0.0 && text.starts_with(['+', '-']) {
            return Err(PartError::Sign(text.to_owned()));
        }
        Ok(number)
    }
}

impl FromStr for PartAccident {
    type Err = PartError;

    fn from_str(text: &str) -> Result<Self, PartError> {
        let (what, time) = text.rsplit_once('@').ok_or(PartError::Form)?;
        let (from, lasts) = time.split_once('+').map_or((time, None), |(from, lasts)| (from, Some(lasts)));
        let (name, place, how) = match what.split(':').map(str::trim).collect::<Vec<_>>()[..] {
            [name, place] => (name, place, None),
            [name, place, how] => (name, place, Some(how)),
            [name] if KINDS.iter().all(|kind| kind.name != name) => return Err(PartError::Kind(name.to_owned())),
            _ => return Err(PartError::Form),
        };
        let kind = KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| PartError::Kind(name.to_owned()))?;
        let seconds = |text: &str| seconds(text.trim()).ok_or_else(|| PartError::Time(text.to_owned()));
        if lasts.is_some() && matches!(kind.does, Does::Jump | Does::Weaken) {
            return Err(PartError::ForGood(kind.name));
        }
        let lasts_s = lasts.map(seconds).transpose()?;
        if let (Some(text), Some(0.0)) = (lasts, lasts_s) {
            return Err(PartError::Momentary(text.trim().to_owned()));
        }
        let direction = match how.and_then(|how| how.chars().next()) {
            Some('+') => 1,
            Some('-') => -1,
            _ => 0,
        };
        Ok(Self {
            kind,
            place: place.to_owned(),
            how: how.map(|how| kind.how_of(how)).transpose()?.or(kind.how.usual),
            direction,
            from_s: seconds(from)?,
            ms: lasts_s.map(|seconds| 1000.0 * seconds),
            text: text.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kind, place, how much, direction, begin and duration.
    type Parts = (&'static str, String, Option<f64>, i8, f64, Option<f64>);

    fn read(text: &str) -> Result<Parts, String> {
        let accident: PartAccident = text.parse().map_err(|error: PartError| error.to_string())?;
        let PartAccident { kind, place, how, direction, from_s, ms, .. } = accident;
        Ok((kind.name, place, how, direction, from_s, ms))
    }

    #[test]
    fn accidents_of_parts_are_read_or_named() {
        assert_eq!(read("seized:m8@20s"), Ok(("seized", "m8".to_owned(), None, 0, 20.0, None)));
        assert_eq!(read("seized:7:35N@1m+500s"), Ok(("seized", "7".to_owned(), Some(35.0), 0, 60.0, Some(500_000.0))));
        assert_eq!(read("loose:m1@0s+2.5s"), Ok(("loose", "m1".to_owned(), Some(10.0), 0, 0.0, Some(2500.0))));
        assert_eq!(read("loose:m1:-15@3s"), Ok(("loose", "m1".to_owned(), Some(-15.0), -1, 3.0, None)));
        assert_eq!(read("loose:m1:+15N@3s"), Ok(("loose", "m1".to_owned(), Some(15.0), 1, 3.0, None)));
        assert_eq!(read("jump:m11@3s"), Ok(("jump", "m11".to_owned(), Some(1.0), 0, 3.0, None)));
        assert_eq!(read("jump:m11:-2@3s"), Ok(("jump", "m11".to_owned(), Some(-2.0), -1, 3.0, None)));
        assert_eq!(read("cord:m4:30%@1h"), Ok(("cord", "m4".to_owned(), Some(30.0), 0, 3600.0, None)));
        let wrong = |text: &str| read(text).unwrap_err();
        let form = "expected WHAT:WHERE[:HOW]@TIME[+TIME], such as seized:m8@20s or loose:m1:15N@20s+5s";
        assert_eq!((wrong("seized:m8").as_str(), wrong("seized@1s").as_str()), (form, form));
        assert_eq!(wrong("seized:m8:1:2@1s"), form);
        let kinds = "`sized` is not an accident; expected seized, loose, jump, cord (--brake rubs on a motor)";
        assert_eq!((wrong("sized:m8@1s").as_str(), wrong("sized@1s").as_str()), (kinds, kinds));
        assert_eq!(wrong("seized:m8:-1@1s"), "`-1` is not a force of 0 to 10000 N");
        assert_eq!(wrong("loose:m8:nan@1s"), "`nan` is not a force of 0 to 10000 N; a sign before it is one direction");
        for how in ["0", "1.5", "51", "two"] {
            assert_eq!(wrong(&format!("jump:m8:{how}@1s")), format!("`{how}` is not a number of teeth, -50 to 50"));
        }
        assert_eq!(wrong("cord:m8:0%@1s"), "`0%` is not 1 to 100 %");
        assert_eq!(wrong("cord:m8@1"), "`1` is not a motion time: 60s, 2.5m, 1h; a year at most");
        assert_eq!(wrong("loose:m8@1s+2"), "`2` is not a motion time: 60s, 2.5m, 1h; a year at most");
        assert_eq!(wrong("jump:m8@1s+2s"), "jump is for good: it has no second time");
        // Either would be an accident that does nothing, or something else than its sign says.
        for text in ["seized:7@20s+0s", "loose:m8@1s+ 0m", "seized:m8:35N@1s+0.0s"] {
            let time = text.split_once('+').unwrap().1.trim();
            let says = format!("`+{time}` ends the accident as it begins; leave it out for an accident for good");
            assert_eq!(wrong(text), says);
        }
        for how in ["-0", "+0", "-0N", "-0.0"] {
            let says = format!("`{how}` is 0 with a sign: a direction needs a force of more than 0 N");
            assert_eq!(wrong(&format!("loose:m1:{how}@3s")), says);
        }
        assert_eq!(wrong("seized:m1:-0@3s"), "`-0` is 0 with a sign: a direction needs a force of more than 0 N");
        // A pulley that holds nothing, either way.
        assert_eq!(read("loose:m1:0@3s"), Ok(("loose", "m1".to_owned(), Some(0.0), 0, 3.0, None)));
    }

    #[test]
    fn every_kind_has_a_name_of_its_own() {
        for kind in &KINDS {
            assert_eq!(KINDS.iter().filter(|other| other.name == kind.name).count(), 1, "{}", kind.name);
        }
    }
}
