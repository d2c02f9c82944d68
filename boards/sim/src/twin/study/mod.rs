//! Study: what follows when numbers of the machine vary, as a file says (`corehbot twin sweep STUDY.toml`).
//!
//! A sample is a pure function of the study and of its number; so they can be computed in any order, on any number of cores
//! and computers, be interrupted and gone on with, and the result is the same bytes.
//!
//! | file | job |
//! |---|---|
//! | `form`, `check`, `error` | the study's file, what is legal in it, and what is said of what is not |
//! | `read` | from there to a plan, with the files that it names |
//! | `plan`, `query`, `figure` | samples by their numbers, what is asked of them, and the columns of that |
//! | `compute` | all samples, on all cores |
//! | `line`, `journal` | finished samples in a file that may be cut at any byte |
//! | `table`, `summary`, `page` | what becomes of them |

mod check;
mod compute;
mod error;
mod figure;
mod form;
mod journal;
mod line;
mod page;
mod plan;
mod query;
mod read;
mod summary;
mod table;

pub(super) use compute::compute;
pub(super) use plan::{Sample, Study, varied};
pub(super) use query::Query;

use super::answer::{Json, say};
use crate::cli::{DONE, FAILED};
use crate::output::{Outputs, STANDARD};
use crate::stop::Stop;
use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use journal::Journal;
use std::path::{Path, PathBuf};
use summary::Summary;

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
        let study = read::read(file, &stop);
        if let Some(status) = stop.status() {
            eprintln!("corehbot: interrupted");
            return Ok(status);
        }
        let study = study?;
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
        let samples = compute(study, journal.as_mut(), kept, self.jobs(), stop)?;
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
        let summary = Summary::new(study, &samples);
        let inputs = study.inputs.iter().map(PathBuf::as_path);
        json.give_with(&summary, inputs, |outputs| self.write(study, &samples, (file, output), outputs))?;
        journal.map_or(Ok(()), Journal::remove)?;
        Ok(DONE)
    }

    fn write(
        &self,
        study: &Study,
        samples: &[Sample],
        (file, output): (&Path, &Path),
        outputs: &mut Outputs,
    ) -> Result<()> {
        ensure!(samples.len() == study.samples, "{} of {} samples are there", samples.len(), study.samples);
        table::write(&mut outputs.open(output)?, study, samples).context("cannot write the table")?;
        let Some(path) = &self.report else { return Ok(()) };
        page::write(&mut outputs.open(path)?, &file.display().to_string(), study, samples)
    }
}

/// One sample, as a line.
fn one(study: &Study, number: usize, stop: &Stop) -> Result<u8> {
    ensure!(number < study.samples, "there is no sample {number}; the study has 0 to {}", study.samples - 1);
    match study.sample(number, stop) {
        Some(sample) => say(&format!("{}\n", line::of_sample(study, &sample)?), false).map(|()| DONE),
        None => Ok(stop.status().unwrap_or(FAILED)),
    }
}

#[cfg(test)]
mod tests;
