//! The draft: the machine file so far, and the verdicts so far.
//!
//! An entry is a part of the configuration that needs a verdict, by its number: a key of Klipper, a word of Marlin.

use super::lines::Lines;
use super::verdict::{Kind, Verdict};
use crate::keys::{Of, bits_of, find, fraction, legal_words, numbered, shortest};
use crate::pattern::matches;
use crate::value::float_toml;
use corehbot::motors::{MOTORS, MotorName};
use corehbot::settings::rows;
use std::collections::BTreeMap;

/// A translation in progress.
pub(crate) struct Draft {
    /// The machine file so far.
    pub lines: Lines,
    /// The motors' names in it.
    pub names: [MotorName; MOTORS],
    /// What the owner has to decide or to check, beyond single entries.
    pub notes: Vec<Verdict>,
    /// Keys that the owner has to fill in, because the configuration does not say them.
    pub open: Vec<String>,
    /// The place of each entry, for comments.
    places: Vec<String>,
    verdicts: Vec<Option<Verdict>>,
    /// The entry that each key of the machine file is from.
    owners: BTreeMap<String, usize>,
}

/// Keys that measure a machine: with the end of their range they would be another machine's. All others are limits and
/// wishes, of which the nearest is a good one.
const MEASURES: [&str; 16] = [
    "axes.*.min",
    "axes.*.length",
    "axes.*.rotation_distance",
    "axes.*.steps_per_mm",
    "axes.*.full_steps",
    "drivers.*.microsteps",
    "drivers.*.stall_threshold",
    "homing.*.position",
    "probe.offset.*",
    "probe.home.*",
    "safe_z_home.[xy]",
    "screws.*",
    "bed.*",
    "shaper.*",
    "heaters.*.pid.*",
    "advance.time",
];

/// Digits of a number that a whole key loses without being told.
const ROUNDING: f64 = 1e-6;

impl Draft {
    /// An empty machine file, and entries in these places.
    pub fn new(places: Vec<String>) -> Self {
        Self {
            lines: Lines::default(),
            names: [MotorName::NONE; MOTORS],
            notes: Vec::new(),
            open: Vec::new(),
            verdicts: vec![None; places.len()],
            owners: BTreeMap::new(),
            places,
        }
    }

    /// The verdicts so far, by the numbers of entries.
    pub fn verdicts(&self) -> &[Option<Verdict>] {
        &self.verdicts
    }

    /// Adds to the verdict on an entry.
    pub fn say(&mut self, entry: usize, kind: Kind, text: impl Into<String>) {
        if let Some(verdict) = self.verdicts.get_mut(entry) {
            let new = Verdict::new(kind, text);
            *verdict = Some(match verdict.take() {
                Some(old) => old.and(new),
                None => new,
            });
        }
    }

    /// The place of an entry, for a comment.
    pub fn from(&self, entry: usize) -> String {
        self.places.get(entry).cloned().unwrap_or_default()
    }

    /// Sets a key of the machine file from an entry, and says so.
    pub fn take(&mut self, entry: usize, path: &str, value: impl Into<toml::Value>) {
        self.put(entry, path, value.into(), Kind::Taken, "");
    }

    /// Sets a key to a number from an entry. A limit outside the key's range becomes the range's end, and a whole key
    /// has no fraction, which is said. A measure of the machine outside of it is for the owner to decide.
    pub fn take_number(&mut self, entry: usize, path: &str, number: f64) {
        let (value, beyond) = self.in_range(path, number);
        let whole = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        match beyond {
            // The true one stays, so that the file is no machine before it is corrected.
            Some(legal) if MEASURES.iter().any(|measure| matches(measure, path)) => {
                self.put(
                    entry,
                    path,
                    float_toml(rounded(number)),
                    Kind::Decide,
                    &format!(", but its range is {legal}"),
                );
            }
            Some(legal) => {
                self.put(entry, path, value, Kind::Approximated, &format!(", because its range is {legal}"));
            }
            None if whole.is_some_and(|whole| (whole - number).abs() > ROUNDING * number.abs().max(1.0)) => {
                self.put(entry, path, value, Kind::Approximated, ", because it has whole numbers");
            }
            None => self.put(entry, path, value, Kind::Taken, ""),
        }
    }

    /// Sets a key to a value near an entry's.
    pub fn approximate(&mut self, entry: usize, path: &str, value: toml::Value, how: &str) {
        self.put(entry, path, value, Kind::Approximated, how);
    }

    /// Sets a key from an entry with a verdict. A key that another entry has set to another value stays as it is: one
    /// of them cannot be taken, and the owner decides which.
    fn put(&mut self, entry: usize, path: &str, value: toml::Value, kind: Kind, how: &str) {
        if let Some(first) = self.owners.get(path).filter(|first| **first != entry) {
            let known = self.lines.get(path).filter(|known| **known != value);
            if let Some(known) = known {
                let text = format!("{path} = {known} from {} already, and it is one value for both", self.from(*first));
                return self.say(entry, Kind::Decide, text);
            }
        } else {
            self.owners.insert(path.to_owned(), entry);
        }
        self.say(entry, kind, format!("{path} = {value}{how}"));
        let from = self.from(entry);
        self.lines.set(path, value, &from);
    }

    /// Leaves a number to the owner: 0, which is outside the key's range, so that the file is no machine before it is
    /// corrected. Without the key the prototype's number would count.
    pub fn leave_open(&mut self, path: &str) {
        self.lines.set(path, 0.into(), "to decide");
    }

    /// Sets a key to a number that the configuration leaves out, for a reason in the file.
    pub fn set_number(&mut self, path: &str, number: f64, from: &str) {
        let value = self.in_range(path, number).0;
        self.lines.set(path, value, from);
    }

    /// Sets keys that the configuration does not say, each to a value with which nothing breaks, and asks the owner to
    /// fill them in.
    pub fn fill_in(&mut self, keys: &[(String, toml::Value)], what: &str) {
        let mut said = Vec::new();
        let open: Vec<_> = keys.iter().filter(|(path, _)| self.lines.get(path).is_none()).collect();
        if open.is_empty() {
            return;
        }
        for (path, value) in open {
            self.lines.set(path, value.clone(), "to be filled in");
            said.push(format!("{path} = {value}"));
        }
        self.open.push(format!("{}: {what}", said.join(", ")));
    }

    /// Sets a connector again, in what the owner is asked to fill in too.
    pub fn plug(&mut self, path: &str, plug: &str, from: &str) {
        if let Some(before) = self.lines.get(path).cloned() {
            let (old, new) = (format!("{path} = {before}"), format!("{path} = {plug:?}"));
            self.open.iter_mut().for_each(|open| *open = open.replace(&old, &new));
        }
        self.lines.set(path, plug.into(), from);
    }

    /// A number as the key's kind has it, in the key's range. If it was outside: the range in words.
    fn in_range(&self, path: &str, number: f64) -> (toml::Value, Option<String>) {
        let Some((kind, legal)) = self.kind_of(path) else { return (float_toml(rounded(number)), None) };
        let is_whole = matches!(kind, rows::ValueKind::Whole | rows::ValueKind::OfMotor | rows::ValueKind::Place);
        let whole = if is_whole { number.round() } else { rounded(number) };
        match bits_of(whole, fraction(kind)) {
            Some(bits) if legal.holds(bits) => (float_toml(whole), None),
            _ => {
                let ends = [legal.least, legal.most].map(|bits| shortest(bits, fraction(kind)));
                (float_toml(whole.clamp(ends[0], ends[1])), Some(legal_words(legal, kind)))
            }
        }
    }

    fn kind_of(&self, path: &str) -> Option<(rows::ValueKind, rows::Legal)> {
        match find(&numbered(path, &self.names))?.of {
            Of::Setting { row, text, part } => Some((text.kind, row.legal(part))),
            Of::List { .. } | Of::Other(_) | Of::Twin(_) | Of::Routing => None,
        }
    }

    /// Whether a key has that number already, as finely as the firmware keeps it.
    pub fn is_same(&self, path: &str, number: f64) -> bool {
        let (Some(first), Some((kind, _))) = (self.lines.number(path), self.kind_of(path)) else { return false };
        let (ours, _) = self.in_range(path, number);
        let ours = ours.as_float().or_else(|| ours.as_integer().map(|whole| whole as f64));
        ours.is_some_and(|ours| bits_of(ours, fraction(kind)) == bits_of(first, fraction(kind)))
    }

    /// Whether a key may have that number.
    pub fn is_legal(&self, path: &str, number: f64) -> bool {
        self.is_key(path) && self.in_range(path, number).1.is_none()
    }

    /// Whether machine files have a key of that path.
    pub fn is_key(&self, path: &str) -> bool {
        find(&numbered(path, &self.names)).is_some()
    }
}

/// Nine digits behind the point are more than any setting keeps.
pub(crate) fn rounded(number: f64) -> f64 {
    (number * 1e9).round() / 1e9
}
