//! Accidents of the probe: `WHAT:probe@TIME`. One row of [`KINDS`] is one kind; the grammar, its errors and the list
//! in docs/reference/commands.md follow that table.

use crate::heat_plant::accident::seconds;
use corehbot::settings::Settings;
use corehbot_rig::bed::cut_wire;
use corehbot_rig::bed::probe::ProbeFault;
use std::fmt;
use std::str::FromStr;

/// A kind of accident.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Its effect on a machine.
    does: fn(&Settings) -> ProbeFault,
    /// Its description for people.
    pub says: &'static str,
}

const fn kind(name: &'static str, does: fn(&Settings) -> ProbeFault, says: &'static str) -> Kind {
    Kind { name, does, says }
}

/// Every kind.
pub const KINDS: [Kind; 8] = [
    kind("stuck", |_| ProbeFault::Stuck, "it always reads as triggered"),
    kind("dead", |_| ProbeFault::Dead, "it never reads as triggered"),
    kind("early", |_| ProbeFault::Early, "it triggers 3.5 mm too high"),
    kind("noisy", |_| ProbeFault::Noisy, "it triggers at heights that differ by 0.2 mm (sigma)"),
    kind("alarm", |_| ProbeFault::Alarm, "a BLTouch is in alarm until it is reset"),
    kind("cut", cut_wire, "its wire is off: what an open input reads, by the machine's file"),
    kind("fallen", cut_wire, "it falls off its holder, with its contacts open"),
    kind("mended", |_| ProbeFault::None, "whatever was broken is whole again"),
];

/// Something that breaks.
#[derive(Clone, Copy, Debug)]
pub struct ProbeAccident {
    /// Its kind.
    pub kind: &'static Kind,
    /// When, in s after power-up.
    pub at_s: f64,
}

impl ProbeAccident {
    /// Whether a text names the probe as its place.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        text.contains(":probe@")
    }

    /// The fault of a probe on such a machine.
    #[must_use]
    pub fn fault(&self, settings: &Settings) -> ProbeFault {
        (self.kind.does)(settings)
    }
}

/// Why a text does not describe an accident of the probe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProbeAccidentError {
    /// The kind is unknown.
    Kind(String),
    /// The time is not valid.
    Time(String),
}

impl fmt::Display for ProbeAccidentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind(text) => {
                let known: Vec<_> = KINDS.iter().map(|kind| kind.name).collect();
                write!(f, "`{text}` is not an accident of a probe; expected {}", known.join(", "))
            }
            Self::Time(text) => write!(f, "`{text}` is not a time after power-up: 60s, 2.5m, 1h; a year at most"),
        }
    }
}

impl std::error::Error for ProbeAccidentError {}

impl FromStr for ProbeAccident {
    type Err = ProbeAccidentError;

    fn from_str(text: &str) -> Result<Self, ProbeAccidentError> {
        let (name, time) = text.split_once(":probe@").unwrap_or((text, ""));
        let kind = KINDS.iter().find(|kind| kind.name == name);
        let kind = kind.ok_or_else(|| ProbeAccidentError::Kind(name.to_owned()))?;
        let at_s = seconds(time).ok_or_else(|| ProbeAccidentError::Time(time.to_owned()))?;
        Ok(Self { kind, at_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accidents_are_read_or_named() {
        let read = |text: &str| text.parse::<ProbeAccident>().map(|accident| (accident.kind.name, accident.at_s));
        assert_eq!(read("stuck:probe@60s"), Ok(("stuck", 60.0)));
        assert_eq!(read("fallen:probe@1.5m"), Ok(("fallen", 90.0)));
        let wrong = |text: &str| read(text).unwrap_err().to_string();
        assert!(wrong("open:probe@1s").starts_with("`open` is not an accident of a probe; expected stuck, dead, "));
        assert!(wrong("stuck:probe@1").starts_with("`1` is not a time after power-up"));
        assert!(ProbeAccident::is_one("early:probe@1s") && !ProbeAccident::is_one("open:bed@1s"));
    }

    #[test]
    fn every_kind_has_a_name_of_its_own() {
        for kind in &KINDS {
            assert_eq!(KINDS.iter().filter(|other| other.name == kind.name).count(), 1, "{}", kind.name);
        }
    }
}
