//! Guide: what the steps share, and what a step has found.

use super::board::Board;
use super::owner::Owner;
use super::step_error::StepError;
use corehbot::connectors::Heater;
use corehbot::settings::Settings;
use serde::{Deserialize, Serialize};

/// Something that may be wrong, and its cure.
pub(super) struct Failure {
    pub what: &'static str,
    pub cure: &'static str,
}

impl Failure {
    /// It is wrong with this part.
    pub fn of(&self, part: &str) -> Problem {
        Problem { what: format!("{part}: {}", self.what), cure: self.cure.to_owned() }
    }
}

/// Something that is wrong.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub(super) struct Problem {
    pub what: String,
    pub cure: String,
}

/// A stop of the firmware, in any step.
pub(super) const STOPPED: Failure =
    Failure { what: "the firmware stopped.", cure: "docs/reference/errors.md has the cure of what it names." };

/// What a step has found.
#[derive(Default)]
pub(super) struct Found {
    pub notes: Vec<String>,
    pub problems: Vec<Problem>,
}

impl Found {
    pub fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }
}

/// What the steps share.
pub(super) struct Guide {
    pub board: Board,
    pub owner: Owner,
    /// The machine, as the board has it.
    pub machine: Settings,
    /// The machine of the owner's file.
    pub file: Option<Settings>,
    /// The first line of M115.
    pub build: String,
}

impl Guide {
    /// The answer of the board to a line.
    pub fn ask(&mut self, line: &str) -> Result<Vec<String>, StepError> {
        self.board.ask(line, &self.owner)
    }

    /// The heaters that are fitted.
    pub fn heaters(&self) -> Vec<Heater> {
        let thermal = self.machine.thermal;
        Heater::ALL.into_iter().filter(|heater| thermal.heater(*heater).is_fitted).collect()
    }

    /// The temperature of each fitted heater, if its sensor has a reading.
    pub fn temperatures(&mut self) -> Result<Vec<(Heater, Option<f64>)>, StepError> {
        let heard = self.ask("M122")?;
        let of = |heater: Heater| {
            let name = heater.name();
            let words = heard.iter().find_map(|line| line.strip_prefix(&format!("echo:heater {name} ")));
            let celsius = words.and_then(|words| words.split(' ').next()).and_then(|number| number.parse().ok());
            (heater, celsius)
        };
        Ok(self.heaters().into_iter().map(of).collect())
    }
}

/// The heater in words, with its article.
pub(super) const fn the(heater: Heater) -> &'static str {
    match heater {
        Heater::Hotend => "the hotend",
        Heater::Bed => "the bed",
        Heater::Chamber => "the chamber",
    }
}
