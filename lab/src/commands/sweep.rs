//! `corehbot-lab sweep`: numbers of the machine are varied, as a study says, or one of them by a word.

use super::study::{Options, Played, Query, Sample, Study, compute, varied};
use crate::sampling::levels;
use anyhow::{Result, anyhow};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::input::Plate;
use corehbot_host::printer::Printer;
use corehbot_host::say::note;
use corehbot_host::stop::Stop;
use corehbot_questions::play::RunModel;
use corehbot_questions::setup::{SetupArgs, parse_pair};
use corehbot_twin::routing::Place;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Most values: some seconds, without a file.
const MOST: usize = 1000;

/// `corehbot-lab sweep`.
#[derive(Args)]
pub(crate) struct Sweep {
    /// A study (STUDY.toml); with --vary, G-code or a step trace that is played with every value.
    #[arg(value_name = "FILE", required_unless_present = "vary")]
    file: Option<PathBuf>,
    #[command(flatten)]
    plate: Plate,
    /// Instead of a study: the key of one number, its first and last value, and how many.
    #[arg(long, value_name = "KEY=FROM:TO:COUNT", value_parser = parse_range)]
    vary: Option<Range>,
    #[command(flatten)]
    study: Options,
    #[command(flatten)]
    setup: SetupArgs,
    /// The tool's place at the begin of the file, in mm from motor 1's axis (as --at of `twin run`); without it, the
    /// firmware's place.
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    begin: Option<[f64; 2]>,
    /// Parts that move besides the tool, on the file.
    #[arg(long, value_enum, default_value = "rotors")]
    run_model: RunModel,
    #[command(flatten)]
    printer: Printer,
    #[command(flatten)]
    json: Json,
}

/// An option that a study sets in its file conflicts with it on the command line.
pub(crate) fn not_beside_a_study(arg: clap::Arg) -> clap::Arg {
    const BESIDE_A_STUDY: [&str; 8] = ["file", "vary", "output", "jobs", "report", "sample", "plan", "json"];
    let is_taken = BESIDE_A_STUDY.iter().any(|id| arg.get_id() == id);
    if is_taken { arg } else { arg.conflicts_with_all(["output", "sample", "plan"]) }
}

/// Values of a key.
#[derive(Clone)]
struct Range {
    key: String,
    values: Vec<f64>,
}

/// The results for each value.
#[derive(Serialize)]
struct Answer {
    key: String,
    rows: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    value: f64,
    #[serde(rename = "Kxx_N_per_mm")]
    kxx: f64,
    #[serde(rename = "Kyy_N_per_mm")]
    kyy: f64,
    #[serde(rename = "frequencies_Hz")]
    frequencies_hz: [f64; 2],
    #[serde(flatten)]
    run: Option<RunRow>,
}

/// The results for a file.
#[derive(Serialize)]
struct RunRow {
    contour_max_mm: f64,
    contour_rms_mm: f64,
    #[serde(rename = "torque_max_mNm")]
    torque_max_mnm: f64,
    slips: u32,
    #[serde(rename = "tension_min_N")]
    tension_min_n: f64,
}

impl Sweep {
    pub(crate) fn answer(&self) -> Result<u8> {
        match (&self.vary, &self.file) {
            (Some(vary), file) => self.vary(vary, file.as_deref()),
            (None, Some(file)) => self.study.answer(file, &self.json),
            (None, None) => Err(anyhow!("expected a study, or --vary")),
        }
    }

    /// One number.
    fn vary(&self, Range { key, values }: &Range, file: Option<&Path>) -> Result<u8> {
        let setup = self.setup.read(&self.printer.machine()?)?;
        for value in values {
            varied(&setup.params, std::slice::from_ref(key), &[*value])?;
        }
        let files = || self.printer.files().chain(file);
        self.json.check(files(), self.study.page())?;
        let stop = Stop::at_signals()?;
        let begin = self.begin.map(|[x, y]| Place::flat(x, y));
        let played = |file: &Path| Played::new(file.to_owned(), self.plate, self.printer.clone());
        let run = file.map(|file| Query::Run { file: played(file), model: self.run_model, begin });
        let study = Study::of_one(setup, key.clone(), values.clone(), run);
        let computed = compute(&study, None, Vec::new(), self.study.jobs(), &stop);
        if let Some(status) = stop.status() {
            note(format_args!("corehbot: interrupted"));
            return Ok(status);
        }
        let samples = computed?;
        let rows =
            samples.iter().zip(values).map(|(sample, value)| row(&study, *value, sample)).collect::<Result<_>>()?;
        let answer = Answer { key: key.clone(), rows };
        let name = file.map_or_else(|| key.clone(), |file| file.display().to_string());
        self.json.give_with(&answer, files(), |outputs| self.study.report(outputs, &name, &study, &samples))
    }
}

/// The figures of a sample.
fn row(study: &Study, value: f64, sample: &Sample) -> Result<Row> {
    let figures = sample.outcome.as_ref().map_err(|why| anyhow!("{} = {value}: {why}", study.keys.join(", ")))?;
    let figure = |name: &str| figures.get(study.figures().position(|known| known == name)?).copied().flatten();
    let run = || {
        Some(RunRow {
            contour_max_mm: figure("contour_max_mm")?,
            contour_rms_mm: figure("contour_rms_mm")?,
            torque_max_mnm: figure("torque_max_mNm")?,
            slips: figure("slips")? as u32,
            tension_min_n: figure("tension_min_N")?,
        })
    };
    Ok(Row {
        value,
        kxx: figure("Kxx_N_per_mm").unwrap_or(0.0),
        kyy: figure("Kyy_N_per_mm").unwrap_or(0.0),
        frequencies_hz: ["mode_1_Hz", "mode_2_Hz"].map(|name| figure(name).unwrap_or(0.0)),
        run: run(),
    })
}

/// `belt_EA_N=20000:56000:7`.
fn parse_range(text: &str) -> Result<Range, String> {
    let wrong = || format!("`{text}` is not KEY=FROM:TO:COUNT, with 2 to {MOST} values");
    let (key, range) = text.split_once('=').ok_or_else(wrong)?;
    let [from, to, count] = range.split(':').collect::<Vec<_>>()[..] else { return Err(wrong()) };
    let number = |text: &str| text.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(wrong);
    let (from, to) = (number(from)?, number(to)?);
    let count: usize = count.parse().ok().filter(|n| (2..=MOST).contains(n)).ok_or_else(wrong)?;
    Ok(Range { key: key.to_owned(), values: levels([from, to], count) })
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let has_runs = self.rows.iter().any(|row| row.run.is_some());
        let file = if has_runs { "   max um   RMS um    mN m  slips  least N" } else { "" };
        let key = &self.key;
        writeln!(f, "{key:>24}  Kxx N/mm  Kyy N/mm   mode 1, 2 Hz  {file}")?;
        for Row { value, kxx, kyy, frequencies_hz: [first, second], run } in &self.rows {
            write!(f, "{value:>24}  {kxx:>8.1}  {kyy:>8.1}  {first:>6.1} {second:>6.1}  ")?;
            if let Some(RunRow { contour_max_mm, contour_rms_mm, torque_max_mnm, slips, tension_min_n }) = run {
                let (most, rms) = (1000.0 * contour_max_mm, 1000.0 * contour_rms_mm);
                write!(f, " {most:>8.1} {rms:>8.1} {torque_max_mnm:>7.1} {slips:>6} {tension_min_n:>8.1}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
