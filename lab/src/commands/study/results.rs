//! Results: the files that a study makes. They are claimed before the computation, so that an unwritable one is
//! reported in the first second and not after hours.

use super::page;
use super::plan::{Sample, Study};
use super::summary::Summary;
use super::table;
use anyhow::{Context as _, Result, ensure};
use corehbot_host::answer::{Json, say};
use corehbot_host::output::{Outputs, Stream};
use corehbot_host::stop::Stop;
use std::io::BufWriter;
use std::path::Path;

/// Where they go.
pub(super) struct Wanted<'a> {
    /// The table.
    pub table: &'a Path,
    /// The page.
    pub report: Option<&'a Path>,
    /// The summary.
    pub json: &'a Json,
}

/// Files that are open for them.
pub(super) struct Results {
    outputs: Outputs,
    table: BufWriter<Stream>,
    report: Option<BufWriter<Stream>>,
    json: Option<BufWriter<Stream>>,
}

impl Results {
    /// Opens them; no result may be one of the study's files, or its journal.
    ///
    /// # Errors
    /// One cannot be written, or is an input or another output.
    pub(super) fn claim(wanted: &Wanted, study: &Study, journal: Option<&Path>) -> Result<Self> {
        let inputs = study.inputs.iter().map(std::path::PathBuf::as_path).chain(journal);
        let mut outputs = Outputs::new(inputs, Stop::default());
        let table = outputs.open(wanted.table)?;
        let report = wanted.report.map(|path| outputs.open(path)).transpose()?;
        let json = wanted.json.open(&mut outputs)?;
        Ok(Self { outputs, table, report, json })
    }

    /// Writes all samples of the study of a file.
    ///
    /// # Errors
    /// A sample is missing, or one cannot be written.
    pub(super) fn write(mut self, file: &Path, study: &Study, samples: &[Sample]) -> Result<()> {
        ensure!(samples.len() == study.samples, "{} of {} samples are there", samples.len(), study.samples);
        let summary = Summary::new(study, samples);
        table::write(&mut self.table, study, samples).context("cannot write the table")?;
        if let Some(out) = &mut self.report {
            page::write(out, &file.display().to_string(), study, (samples, &summary))?;
        }
        if let Some(out) = &mut self.json {
            Json::write(out, &summary)?;
        }
        say(&summary.to_string(), self.outputs.is_standard_taken())?;
        self.outputs.keep()
    }
}
