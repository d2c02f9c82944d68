//! The work on one report: a draft, and a look at the words of the report.

use super::firmware::Firmware;
use super::said::{Said, Word};
use crate::translation::draft::{Draft, rounded};
use crate::translation::{Kind, Verdict};
use std::ops::{Deref, DerefMut};

/// A report that is being translated: a draft that knows its report.
pub(crate) struct Work<'s> {
    pub said: &'s Said,
    draft: Draft,
}

/// Millimetres of an inch.
const INCH: f64 = 25.4;

/// What to say of a length in inches.
const IN_INCHES: &str = "in inches it has two decimals only: G21 before M503 says it exactly";

/// Greater numbers are no setting of any printer, and would lose their digits on the way.
const GREATEST: f64 = 1e9;

impl<'s> Work<'s> {
    pub fn new(said: &'s Said) -> Self {
        // The word itself says more in a comment than the number of a line that scrolled by.
        let place = |word: &Word| match word.code.as_str() {
            "M115" | "M119" => format!("{} {}", word.code, word.key),
            code => format!("{code} {}{}", word.key, word.value),
        };
        let places = said.words.iter().map(place);
        Self { said, draft: Draft::new(places.collect()) }
    }

    /// The work on words of another source, each with its place.
    pub fn of(said: &'s Said, places: Vec<String>) -> Self {
        Self { said, draft: Draft::new(places) }
    }

    /// The entry of a word, and its value.
    pub fn value(&self, code: &str, key: &str) -> Option<(usize, &'s str)> {
        let number = self.said.find(code, key)?;
        Some((number, self.said.words.get(number)?.value.as_str()))
    }

    /// The entry of a word, and its number. A value that is no number is for the owner to decide.
    pub fn number(&mut self, code: &str, key: &str) -> Option<(usize, f64)> {
        let (entry, text) = self.value(code, key)?;
        match text.parse::<f64>() {
            Ok(number) if number.abs() <= GREATEST => Some((entry, number)),
            _ => {
                self.say(entry, Kind::Decide, "no number: correct it");
                None
            }
        }
    }

    /// The same for a number that follows G20, in mm.
    pub fn length(&mut self, code: &str, key: &str) -> Option<(usize, f64)> {
        let (entry, number) = self.number(code, key)?;
        if !self.said.words.get(entry)?.is_inches {
            return Some((entry, number));
        }
        let is_said = |verdict: &Verdict| verdict.text.contains(IN_INCHES);
        if !self.verdicts().get(entry).and_then(Option::as_ref).is_some_and(is_said) {
            self.say(entry, Kind::Approximated, IN_INCHES);
        }
        Some((entry, rounded(number * INCH)))
    }

    /// Says what follows from the firmware that answered.
    pub fn of_firmware(&mut self) {
        let Some((_, name)) = self.value("M115", "FIRMWARE_NAME") else { return };
        let text = match Firmware::called(name) {
            Firmware::Marlin => return,
            Firmware::Corehbot => {
                "CoreH-bot firmware answered: `corehbot config get PORT` reads its whole machine".to_owned()
            }
            _ => format!("{name} is not Marlin: check every line"),
        };
        self.notes.push(Verdict::new(Kind::Approximated, text));
    }
}

impl Deref for Work<'_> {
    type Target = Draft;

    fn deref(&self) -> &Draft {
        &self.draft
    }
}

impl DerefMut for Work<'_> {
    fn deref_mut(&mut self) -> &mut Draft {
        &mut self.draft
    }
}
