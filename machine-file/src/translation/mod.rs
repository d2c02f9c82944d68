//! Translation: the configuration of another firmware as a machine file, with a verdict on every part of it.
//!
//! `klipper`, `marlin`, `configuration_h` and `reprap` read the configurations. They share the work of this folder.
//!
//! | file | job |
//! |---|---|
//! | `draft` | the translation so far |
//! | `lines` | the text that it becomes |
//! | `verdict`, `report` | the verdict on every part |

pub(crate) mod draft;
mod lines;
mod report;
mod verdict;

use crate::{Machine, Problem, problems};
pub use report::{OfKey, OfSection, Report};
pub use verdict::{Kind, Verdict};

/// A configuration as a machine file.
pub struct Translation {
    /// The machine file.
    pub text: String,
    /// Its machine, if it is one.
    pub machine: Option<Machine>,
    /// Errors and doubtful values in the machine file.
    pub problems: Vec<Problem>,
    /// What became of every key.
    pub report: Report,
}

impl Translation {
    /// The translation with this machine file.
    pub(crate) fn new(text: String, report: Report) -> Self {
        let (machine, problems) = problems(&text);
        Self { text, machine, problems, report }
    }

    /// Whether the machine file is a machine, with nothing left to decide.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        let is_open = |(kind, count): &(Kind, usize)| *kind == Kind::Decide && *count > 0;
        self.machine.is_some() && !self.report.counts().iter().any(is_open)
    }
}
