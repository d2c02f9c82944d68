//! Study: what follows when numbers of the machine vary, as a file says (`corehbot twin sweep STUDY.toml`).
//!
//! A sample is a pure function of the study and of its number; so they can be computed in any order, on any number of
//! cores and computers, be interrupted and gone on with, and the result is the same bytes: with one build of the
//! command, on one kind of machine. What `sin`, `tanh`, `exp` and `hypot` round to differs between C libraries and
//! processors.
//!
//! | file | job |
//! |---|---|
//! | `form`, `check`, `error` | the study's file, what is legal in it, and what is said of what is not |
//! | `read` | from there to a plan, with the files that it names |
//! | `plan`, `query`, `figure` | samples by their numbers, what is asked of them, and the columns of that |
//! | `played` | the file that samples play, read when the first one is computed |
//! | `compute` | all samples, on all cores |
//! | `line`, `journal` | finished samples in a file that may be cut at any byte |
//! | `results`, `table`, `summary`, `page` | what becomes of them |

mod check;
mod compute;
mod error;
mod figure;
mod form;
mod journal;
mod line;
mod page;
mod plan;
mod played;
mod query;
mod read;
mod results;
mod summary;
mod table;

pub(super) use compute::compute;
pub(super) use plan::{Sample, Study, varied};
pub(super) use played::Played;
pub(super) use query::Query;

use super::answer::{Json, say};
use crate::output::STANDARD;
use crate::status::{DONE, FAILED};
use crate::stop::Stop;
use anyhow::{Result, bail, ensure};
use clap::Args;
use journal::Journal;
use results::{Results, Wanted};
use std::path::{Path, PathBuf};

/// What a study is told on the command line.
#[derive(Args)]
pub(super) struct Options {
    /// Where the table of a study goes; `-` is standard output. What is finished is kept beside it until it is whole.
    #[arg(short, long, value_name = "OUT.csv", conflicts_with_all = ["vary", "sample", "plan"])]
    output: Option<PathBuf>,
    /// How many samples are computed at once; as many as there are cores without it.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Writes a page with a picture of each figure over each number.
    #[arg(long, value_name = "R.html", conflicts_with_all = ["vary", "sample", "plan"])]
    report: Option<PathBuf>,
    /// Computes one sample, counted from 0, and prints it as the line of a journal: the task of a computer among many.
    #[arg(long, value_name = "I", conflicts_with_all = ["vary", "plan"])]
    sample: Option<usize>,
    /// Prints the first line of the study's journal, which says how many samples there are.
    #[arg(long, conflicts_with = "vary")]
    plan: bool,
}

impl Options {
    /// How many threads are wanted.
    pub(super) fn jobs(&self) -> Option<usize> {
        self.jobs.map(usize::from)
    }

    /// Does what they say with the study of a file.
    ///
    /// # Errors
    /// The study is none, its journal is another one's, or an output cannot be written.
    pub(super) fn answer(&self, file: &Path, json: &Json) -> Result<u8> {
        let stop = Stop::at_signals()?;
        let study = read::read(file)?;
        match (&self.output, self.sample) {
            (_, Some(number)) => one(&study, number, &stop),
            _ if self.plan => say(&format!("{}\n", line::head(&study)?), false).map(|()| DONE),
            (Some(output), _) => self.all(&study, (file, output), json, &stop),
            (None, None) => bail!("a study wants an output (-o OUT.csv); or --sample I, or --plan"),
        }
    }

    fn all(&self, study: &Study, (file, output): (&Path, &Path), json: &Json, stop: &Stop) -> Result<u8> {
        let is_file = output != Path::new(STANDARD);
        let (mut journal, kept) = match is_file.then(|| Journal::open(output, study)).transpose()? {
            Some((journal, kept)) => (Some(journal), kept),
            None => (None, Vec::new()),
        };
        let wanted = Wanted { table: output, report: self.report.as_deref(), json };
        let computed = Results::claim(&wanted, study, journal.as_ref().map(|journal| journal.path.as_path()))
            .and_then(|results| Ok((results, compute(study, journal.as_mut(), kept, self.jobs(), stop)?)));
        let (results, samples) = match computed {
            Ok(computed) => computed,
            Err(error) => {
                // What went wrong first is told, not that this does too.
                let _ = journal.map(Journal::remove_if_empty);
                return Err(error);
            }
        };
        if let Some(status) = stop.status() {
            let (done, of) = (samples.len(), study.samples);
            match &journal {
                Some(Journal { path, .. }) => {
                    eprintln!("corehbot: interrupted; {} keeps {done} of {of} samples", path.display());
                }
                None => eprintln!("corehbot: interrupted"),
            }
            return Ok(status);
        }
        results.write(file, study, &samples)?;
        journal.map_or(Ok(()), Journal::remove)?;
        Ok(DONE)
    }
}

/// One sample, as a line.
fn one(study: &Study, number: usize, stop: &Stop) -> Result<u8> {
    ensure!(number < study.samples, "there is no sample {number}; the study has 0 to {}", study.samples - 1);
    let loaded = study.load(stop);
    if let Some(status) = stop.status() {
        eprintln!("corehbot: interrupted");
        return Ok(status);
    }
    loaded?;
    match study.sample(number, stop) {
        Some(sample) => say(&format!("{}\n", line::of_sample(study, &sample)?), false).map(|()| DONE),
        None => Ok(stop.status().unwrap_or(FAILED)),
    }
}

#[cfg(test)]
mod tests;
