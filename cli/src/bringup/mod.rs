//! `corehbot bringup`: leads an owner from a flashed board to a first print, and writes a report to keep.
//!
//! ```text
//!   steps (the table) ──▶ a step runs ──▶ nothing wrong: next ──▶ ... ──▶ report
//!                              ▲      └──▶ problems with their cures: again, skip, or quit
//!                              └──────────────────────┘
//! ```
//!
//! | state | event | then |
//! |---|---|---|
//! | a step runs | it found no problem | it is noted as passed, the next one runs |
//! | | it found problems | the owner decides |
//! | | the firmware stopped | it is restarted, and the stop is a problem |
//! | | the board restarted by itself | that is a problem |
//! | | the port is gone | the board is left alone; the guide ends and says how to go on |
//! | | Ctrl-C, `quit`, or the end of the input | heaters and motors off ([`board::Board::rest`]); the guide ends |
//! | the owner decides | again | the same step runs, with the board's machine read again |
//! | | skip | it is noted as skipped, the next one runs |
//! | | quit | it is noted as failed; the guide ends |
//!
//! After each step the record is written, so that the guide goes on from there. Every session begins with the greeting,
//! because the steps need the board's machine.
//!
//! | file | for |
//! |---|---|
//! | [`steps`] | the table of the steps; each has a file of its name |
//! | [`wiring`], [`direction_words`] | which motor hangs on which driver, from where the tool went |
//! | [`board`], [`owner`] | the conversations with the board and with the person |
//! | [`guide`], [`step_error`] | what steps share, and why one could not end |
//! | [`record`] | the report, and the file to go on from |

mod advice;
mod board;
mod direction_words;
mod directions;
mod drivers;
mod endstops;
mod greeting;
mod guide;
mod heaters;
mod homing;
mod motors;
mod owner;
mod record;
mod sensors;
mod step_error;
mod steps;
mod supply;
mod tuning;
mod wiring;

use anyhow::{Context as _, Result};
use board::Board;
use clap::Args;
use clap::builder::PossibleValuesParser;
use corehbot::settings::Settings;
use corehbot_host::say::say;
use corehbot_host::status::{DONE, FAILED};
use corehbot_host::stop::Stop;
use corehbot_machine_file as machine_file;
use guide::{Failure, Found, Guide, STOPPED};
use owner::Owner;
use record::{Ended, Entry, Record};
use std::path::PathBuf;
use std::time::Duration;
use step_error::StepError;
use steps::{STEPS, Step};

const RESTARTED: Failure = Failure {
    what: "the board restarted in the middle of this step.",
    cure: "if it was not its reset button: check the supply and its terminals, and that no wire touches another.",
};

/// The first hour with a board.
#[derive(Args)]
pub(crate) struct Bringup {
    /// The serial line to the board, such as /dev/ttyACM0.
    #[arg(value_name = "PORT", required_unless_present = "list")]
    port: Option<PathBuf>,
    /// Its rate; on USB any will do.
    #[arg(long, default_value_t = 250_000)]
    baud: u32,
    /// Silence of the board that is borne, in s. A board that is emulated on a slow computer needs more.
    #[arg(long, value_name = "S", default_value_t = board::SILENCE, value_parser = clap::value_parser!(u8).range(4..))]
    patience: u8,
    /// The machine file, to compare the board's machine with.
    #[arg(long, alias = "settings", value_name = "M.toml")]
    machine: Option<PathBuf>,
    /// The report; the state to go on from stands next to it, with the ending `json`.
    #[arg(long, value_name = "R.md", default_value = "bringup-report.md")]
    report: PathBuf,
    /// Begins with this step, whatever was done before.
    #[arg(long, value_name = "STEP", value_parser = PossibleValuesParser::new(STEPS.map(|step| step.name)))]
    from: Option<String>,
    /// Everything is as it should be: no questions, and nothing that needs a hand.
    #[arg(long)]
    yes: bool,
    /// Lists the steps, with what may be wrong and its cure.
    #[arg(long)]
    list: bool,
}

/// Everything that can be wrong before the first question.
pub(crate) struct Prepared {
    guide: Option<Guide>,
    record: Record,
    stop: Stop,
}

impl Prepared {
    pub fn new(args: &Bringup) -> Result<Self> {
        let stop = Stop::at_signals()?;
        let Some(port) = args.port.as_deref().filter(|_| !args.list) else {
            return Ok(Self { guide: None, record: Record::default(), stop });
        };
        let file = args.machine.as_deref().map(machine_file::read).transpose()?.map(|machine| machine.settings);
        let record = Record::load(&args.report)?;
        let board = Board::open(port, args.baud, Duration::from_secs(args.patience.into()))?;
        record.save(&args.report)?;
        let owner = Owner::new(args.yes, stop.clone());
        let guide = Guide { board, owner, machine: Settings::prototype(), file, build: String::new() };
        Ok(Self { guide: Some(guide), record, stop })
    }

    /// Leads through the steps.
    pub fn run(self, args: &Bringup) -> Result<u8> {
        let Self { guide, mut record, stop } = self;
        let Some(mut guide) = guide else {
            list()?;
            return Ok(DONE);
        };
        if !guide.owner.is_absent() {
            guide
                .owner
                .tell("Enter is the usual answer to a question; `quit` leaves, and the same command goes on later.");
        }
        let begin = args.from.as_ref().and_then(|from| STEPS.iter().position(|step| step.name == *from));
        for (number, step) in STEPS.iter().enumerate() {
            let is_behind = begin.map_or_else(|| record.is_done(step.name), |begin| number < begin);
            if number > 0 && is_behind {
                continue;
            }
            guide.owner.tell(&format!("\n== {}. {} ({})\n{}", number + 1, step.title, step.name, step.does));
            let trouble = match take(&mut guide, step, &mut record, args) {
                Ok(()) => continue,
                Err(trouble) => trouble,
            };
            // Steps before `--from` may not be done yet.
            let from = args.from.as_ref().map(|_| format!(" with --from {}", step.name)).unwrap_or_default();
            let resume = format!("The same command{from} goes on with this step");
            guide.owner.tell(&format!("\n{trouble}\n{resume}; the report so far: {}", args.report.display()));
            // What cannot be reached any more is at rest by its own guards.
            if !matches!(trouble, StepError::Lost(_) | StepError::Unfit(_)) && matches!(guide.board.rest(), Ok(false)) {
                guide.owner.tell("The board has not confirmed that it rests: M112 has stopped everything.");
            }
            return Ok(stop.status().unwrap_or(FAILED));
        }
        guide.owner.tell(&format!("\nDone. Keep the report: {}", args.report.display()));
        Ok(if record.is_clean() { DONE } else { FAILED })
    }
}

/// Takes a step until it has passed or is skipped.
fn take(guide: &mut Guide, step: &Step, record: &mut Record, args: &Bringup) -> Result<(), StepError> {
    if !is_ready(guide, step, record)? {
        note(step, record, Ended::Skipped, Found { notes: vec!["left out".to_owned()], ..Found::default() });
        record.save(&args.report).context("the report")?;
        return Ok(());
    }
    loop {
        let found = match (step.run)(guide) {
            Err(StepError::Halted(why)) => {
                guide.board.restart(&guide.owner)?;
                Found { problems: vec![STOPPED.of(&why)], ..Found::default() }
            }
            Err(StepError::Restarted(why)) => Found { problems: vec![RESTARTED.of(&why)], ..Found::default() },
            found => found?,
        };
        found.notes.iter().for_each(|note| guide.owner.tell(&format!("  {note}")));
        for problem in &found.problems {
            guide.owner.tell(&format!("  ! {}\n    Cure: {}", problem.what, problem.cure));
        }
        let decision = if found.problems.is_empty() { Decision::GoOn } else { decide(guide, step)? };
        let ended = match decision {
            Decision::GoOn => Ended::Passed,
            Decision::Skip => Ended::Skipped,
            Decision::Again | Decision::Quit => Ended::Failed,
        };
        (record.build, record.machine) = (guide.build.clone(), guide.machine.name.to_string());
        note(step, record, ended, found);
        record.save(&args.report).context("the report")?;
        match decision {
            Decision::GoOn | Decision::Skip => return Ok(()),
            Decision::Quit => return Err(StepError::Left),
            Decision::Again => drop((STEPS[0].run)(guide)?),
        }
    }
}

/// Notes how a step has ended.
fn note(step: &Step, record: &mut Record, ended: Ended, Found { notes, problems }: Found) {
    record.put(Entry { step: step.name.into(), title: step.title.into(), ended, notes, problems });
}

/// Whether the steps that this one builds on have passed, or the owner wants it all the same.
fn is_ready(guide: &Guide, step: &Step, record: &Record) -> Result<bool, StepError> {
    let missing: Vec<_> = step.needs.iter().filter(|name| !record.has_passed(name)).copied().collect();
    if missing.is_empty() {
        return Ok(true);
    }
    let question = format!("Not passed before this step: {}. Do it all the same? yes, skip", missing.join(", "));
    guide.owner.ask(&format!("{} needs", step.name), &question, "skip", |answer| match answer {
        "y" | "yes" => Some(true),
        "s" | "skip" => Some(false),
        _ => None,
    })
}

/// What the owner wants after problems.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Decision {
    GoOn,
    Again,
    Skip,
    Quit,
}

fn decide(guide: &Guide, step: &Step) -> Result<Decision, StepError> {
    let question = "again, skip (with these problems in the report), or quit and go on another time?";
    let usual = if guide.owner.is_absent() { "quit" } else { "again" };
    guide.owner.ask(&format!("{} decide", step.name), question, usual, |answer| match answer {
        "again" | "a" => Some(Decision::Again),
        "skip" | "s" => Some(Decision::Skip),
        "quit" | "q" => Some(Decision::Quit),
        _ => None,
    })
}

/// Says every step with what may be wrong.
fn list() -> Result<()> {
    for (number, step) in STEPS.iter().enumerate() {
        let Step { title, name, does, asks, .. } = step;
        say(format_args!("{}. {title} ({name})\n   {does}\n   Asks: {asks}", number + 1))?;
        for Failure { what, cure } in step.failures {
            say(format_args!("   - {what} Cure: {cure}"))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    /// The tutorial is the guide's text version.
    #[test]
    fn the_tutorial_has_the_same_steps_in_the_same_order() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/tutorial/first-hour.md");
        let text = std::fs::read_to_string(path).unwrap();
        let headings: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
        let titles: Vec<_> = (1..).zip(&STEPS).map(|(n, step)| format!("{n}. {}", step.title)).collect();
        assert_eq!(headings, titles);
        let mut missing = String::new();
        for failure in STEPS.iter().flat_map(|step| step.failures) {
            if !text.contains(failure.what) || !text.contains(failure.cure) {
                writeln!(missing, "| {} | {} |", failure.what, failure.cure).unwrap();
            }
        }
        assert_eq!(missing, "", "rows that docs/tutorial/first-hour.md lacks");
    }

    #[test]
    fn names_of_steps_differ() {
        for step in &STEPS {
            assert_eq!(STEPS.iter().filter(|other| other.name == step.name).count(), 1, "{}", step.name);
        }
    }
}
