//! Steps played on a machine, with the parts that may move.

use clap::ValueEnum;
use corehbot_twin::dynamics::plant::Detail;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::report::Report;
use corehbot_twin::run::watch::Watch;
use corehbot_twin::run::{Run, RunError};
use corehbot_twin::steps::StepTrace;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Parts that move besides the tool.
#[derive(Clone, Copy, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunModel {
    /// Nothing: motors are where they were sent, idlers have no mass.
    Reduced,
    /// Idlers, each with its inertia.
    Full,
    /// Rotors in the sine of their fields, which may slip; idlers have no mass.
    Rotors,
    /// Rotors, and idlers each with its inertia; some five times slower.
    FullRotors,
}

impl RunModel {
    /// What moves then.
    #[must_use]
    pub const fn detail(self) -> Detail {
        match self {
            Self::Reduced => Detail { idlers: false, rotors: false },
            Self::Full => Detail { idlers: true, rotors: false },
            Self::Rotors => Detail { idlers: false, rotors: true },
            Self::FullRotors => Detail { idlers: true, rotors: true },
        }
    }

    /// Its word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reduced => "reduced",
            Self::Full => "full",
            Self::Rotors => "rotors",
            Self::FullRotors => "full-rotors",
        }
    }
}

/// Plays steps on a machine. Errors are those from the line of other steps, if there are any. `go_on` gets the computed
/// part, of 1, and returns whether to continue.
pub fn played(
    machine: Machine,
    params: &Params,
    start: Place,
    model: RunModel,
    (steps, meant): (&StepTrace, Option<&StepTrace>),
    go_on: impl FnMut(f64) -> bool,
) -> Result<(Report, Watch), RunError> {
    let begin = Instant::now();
    let run = Run::new(machine, params, start, model.detail(), steps)?;
    let run = match meant {
        Some(meant) => run.against(meant)?,
        None => run,
    };
    let watch = run.play(go_on)?;
    let trace = (steps.duration_s(), steps.events.len());
    let report = Report::new(machine, model.name(), params, &watch, trace, begin.elapsed().as_secs_f64());
    Ok((report, watch))
}
