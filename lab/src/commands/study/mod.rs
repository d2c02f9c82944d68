//! Study: results for varied numbers of the machine, as a file describes (`corehbot-lab sweep STUDY.toml`).
//!
//! A sample is a pure function of the study and of its number. So samples can be computed in any order, on any number
//! of cores and computers, and be interrupted and resumed. The result is the same bytes, with one build of the command
//! on one kind of machine. C libraries and processors round `sin`, `tanh`, `exp` and `hypot` differently.
//!
//! | file | job |
//! |---|---|
//! | `form`, `check`, `error` | the study's file, its legal values, and the messages about illegal ones |
//! | `read` | from there to a plan, with the files that it names |
//! | `plan`, `query`, `figure` | samples by their numbers, their queries, and the columns of these |
//! | `played` | the file that samples play, read when the first one is computed |
//! | `compute` | all samples, on all cores |
//! | `line`, `journal` | finished samples in a file that may be cut at any byte |
//! | `results`, `table`, `summary`, `page` | the outputs of a study |

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

use anyhow::{Result, bail, ensure};
use clap::Args;
use corehbot_host::answer::{Json, say};
use corehbot_host::output::{Outputs, STANDARD};
use corehbot_host::say::note;
use corehbot_host::status::{DONE, FAILED};
use corehbot_host::stop::Stop;
use journal::Journal;
use results::{Results, Wanted};
use std::path::{Path, PathBuf};
use summary::Summary;

/// Command-line options of a study.
#[derive(Args)]
pub(super) struct Options {
    /// File for the table of a study; `-` is standard output. Finished samples are kept next to it until it is
    /// complete.
    #[arg(short, long, value_name = "OUT.csv", conflicts_with_all = ["vary", "sample", "plan"])]
    output: Option<PathBuf>,
    /// Number of samples computed at once; the default is the number of cores.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Writes a page with a picture of each figure over each number.
    #[arg(long, value_name = "R.html", conflicts_with_all = ["sample", "plan"])]
    report: Option<PathBuf>,
    /// Computes one sample, counted from 0, and prints it as the line of a journal: the task of one computer among
    /// many.
    #[arg(long, value_name = "I", conflicts_with_all = ["vary", "plan"])]
    sample: Option<usize>,
    /// Prints the first line of the study's journal, with the number of samples.
    #[arg(long, conflicts_with = "vary")]
    plan: bool,
}

impl Options {
    /// How many threads are wanted.
    pub(super) fn jobs(&self) -> Option<usize> {
        self.jobs.map(usize::from)
    }

    /// Where the page goes.
    pub(super) const fn page(&self) -> Option<&PathBuf> {
        self.report.as_ref()
    }

    /// Writes the page of samples that are no study's, if it is asked for.
    ///
    /// # Errors
    /// It cannot be written.
    pub(super) fn report(&self, outputs: &mut Outputs, name: &str, study: &Study, samples: &[Sample]) -> Result<()> {
        let Some(path) = &self.report else { return Ok(()) };
        page::write(&mut outputs.open(path)?, name, study, (samples, &Summary::new(study, samples)))
    }

    /// Runs the study of a file with these options.
    ///
    /// # Errors
    /// The study is invalid, its journal belongs to another study, or an output cannot be written.
    pub(crate) fn answer(&self, file: &Path, json: &Json) -> Result<u8> {
        let stop = Stop::at_signals()?;
        let study = read::read(file)?;
        match (&self.output, self.sample) {
            (_, Some(number)) => one(&study, number, &stop),
            _ if self.plan => say(&format!("{}\n", line::head(&study)?), false).map(|()| DONE),
            (Some(output), _) => self.all(&study, (file, output), json, &stop),
            (None, None) => bail!("a study needs an output (-o OUT.csv); or --sample I, or --plan"),
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
                // The first error is reported, not that this fails too.
                let _ = journal.map(Journal::remove_if_empty);
                return Err(error);
            }
        };
        if let Some(status) = stop.status() {
            let (done, of) = (samples.len(), study.samples);
            match &journal {
                Some(Journal { path, .. }) => {
                    note(format_args!("corehbot: interrupted; {} keeps {done} of {of} samples", path.display()));
                }
                None => note(format_args!("corehbot: interrupted")),
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
        note(format_args!("corehbot: interrupted"));
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
