//! The work on one define: its entry, and its numbers.

use super::defines::Defines;
use crate::marlin::source::ITEM;
use crate::marlin::work::Work;
use crate::translation::Kind;

/// The work on one define: its entry, and its numbers.
pub(super) struct Look<'w, 'd, 's> {
    pub work: &'w mut Work<'s>,
    pub defines: &'d Defines,
}

impl Look<'_, '_, '_> {
    pub fn entry(&self, name: &str) -> Option<usize> {
        self.defines.find(name)?;
        self.work.said.find(ITEM, name)
    }

    /// Whether a define says how far Z rises before homing.
    pub fn is_before_homing(&self) -> bool {
        ["Z_HOMING_HEIGHT", "Z_CLEARANCE_FOR_HOMING"].iter().any(|name| self.entry(name).is_some())
    }

    /// The entry of a define that is switched on.
    pub fn on(&self, name: &str) -> Option<usize> {
        self.entry(name).filter(|_| self.defines.has(name))
    }

    pub fn number(&mut self, name: &str) -> Option<(usize, f64)> {
        let entry = self.entry(name)?;
        match self.defines.of(name) {
            Some(number) => Some((entry, number)),
            None => {
                self.work.say(entry, Kind::Decide, "its value is not known here: write it yourself");
                None
            }
        }
    }

    pub fn take(&mut self, name: &str, path: &str, times: f64) -> Option<f64> {
        let (entry, number) = self.number(name)?;
        self.work.take_number(entry, path, number * times);
        Some(number)
    }

    pub fn say(&mut self, name: &str, kind: Kind, text: impl Into<String>) {
        if let Some(entry) = self.entry(name) {
            self.work.say(entry, kind, text);
        }
    }
}

/// The axes with a switch.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];
