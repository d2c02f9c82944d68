//! Record: what was found so far, as a file to go on from and as a report to keep.

use super::guide::Problem;
use super::steps::STEPS;
use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// How a step ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Ended {
    Passed,
    /// The owner went on in spite of its problems.
    Skipped,
    /// It is to be done again.
    Failed,
}

impl Ended {
    const fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Skipped => "skipped",
            Self::Failed => "failed",
        }
    }
}

/// A step that was done.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub(super) struct Entry {
    pub step: String,
    pub title: String,
    pub ended: Ended,
    pub notes: Vec<String>,
    pub problems: Vec<Problem>,
}

/// What was found so far.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub(super) struct Record {
    pub build: String,
    pub machine: String,
    pub entries: Vec<Entry>,
}

/// The file to go on from: next to the report, with another ending.
fn state_of(report: &Path) -> PathBuf {
    report.with_extension("json")
}

impl Record {
    /// The record of an earlier session; an empty one if there is none.
    ///
    /// # Errors
    /// The file is not a record.
    pub fn load(report: &Path) -> Result<Self> {
        let path = state_of(report);
        let Ok(text) = std::fs::read_to_string(&path) else { return Ok(Self::default()) };
        let why = || {
            format!("{} is not the state of an earlier session; remove it, or name another --report", path.display())
        };
        serde_json::from_str(&text).with_context(why)
    }

    /// Writes both files.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn save(&self, report: &Path) -> Result<()> {
        let write = |path: &Path, text: String| {
            std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
        };
        write(&state_of(report), serde_json::to_string_pretty(self)? + "\n")?;
        write(report, self.markdown())
    }

    /// Whether a step is behind us.
    pub fn is_done(&self, step: &str) -> bool {
        self.entries.iter().any(|entry| entry.step == step && entry.ended != Ended::Failed)
    }

    /// Whether a step has passed.
    pub fn has_passed(&self, step: &str) -> bool {
        self.entries.iter().any(|entry| entry.step == step && entry.ended == Ended::Passed)
    }

    /// A step has ended, perhaps again.
    pub fn put(&mut self, entry: Entry) {
        self.entries.retain(|old| old.step != entry.step);
        self.entries.push(entry);
    }

    /// Whether every step has passed.
    pub fn is_clean(&self) -> bool {
        self.entries.iter().all(|entry| entry.ended == Ended::Passed)
    }

    fn markdown(&self) -> String {
        let mut text = format!("# Bring-up report\n\n- Machine: {}\n- Firmware: {}\n", self.machine, self.build);
        // In the order and with the numbers of the guide, whatever was done again.
        let entry_of = |name: &str| self.entries.iter().find(|entry| entry.step == name);
        let entries = (1..).zip(&STEPS).filter_map(|(number, step)| Some((number, entry_of(step.name)?)));
        for (number, entry) in entries {
            // A String takes everything.
            let _ = write!(text, "\n## {number}. {}: {}\n\n", entry.title, entry.ended.word());
            entry.notes.iter().for_each(|note| text.extend(["- ", note, "\n"]));
            for Problem { what, cure } in &entry.problems {
                text.extend(["- **", what, "** Cure: ", cure, "\n"]);
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(ended: Ended) -> Entry {
        let problems = vec![Problem { what: "x: stuck.".to_owned(), cure: "free it.".to_owned() }];
        Entry { step: "endstops".into(), title: "Endstops".into(), ended, notes: vec!["y is well".into()], problems }
    }

    #[test]
    fn a_step_done_again_replaces_itself_and_a_failed_one_is_not_behind_us() {
        let mut record = Record::default();
        record.put(entry(Ended::Failed));
        assert!(!record.is_done("endstops") && !record.is_clean());
        record.put(entry(Ended::Skipped));
        assert!(record.is_done("endstops") && !record.is_clean());
        assert_eq!(record.entries.len(), 1);
        let text = record.markdown();
        assert!(text.contains("\n## 4. Endstops: skipped\n\n- y is well\n- **x: stuck.** Cure: free it.\n"), "{text}");
    }

    /// The board is greeted in every session.
    ///
    /// Reproducer: in the report of a second session the greeting stood behind the steps of the first.
    #[test]
    fn steps_stand_in_the_order_of_the_guide() {
        let mut record = Record::default();
        record.put(entry(Ended::Passed));
        record.put(Entry { step: "greeting".into(), title: "The board answers".into(), ..entry(Ended::Passed) });
        let text = record.markdown();
        let headings: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
        assert_eq!(headings, ["1. The board answers: passed", "4. Endstops: passed"]);
    }
}
