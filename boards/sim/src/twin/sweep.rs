//! `twin sweep`: one number of the machine is varied.

use super::answer::Json;
use super::play::{RunModel, play};
use super::setup::{SetupArgs, parse_pair};
use super::source::Source;
use crate::cli::Printer;
use crate::stop::Stop;
use anyhow::{Context as _, Result, bail};
use clap::Args;
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::modes::Modes;
use corehbot_twin::queries::stiffness::Stiffness;
use corehbot_twin::routing::Place;
use serde::Serialize;
use serde_json::Value;
use std::path::PathBuf;

/// Most values: some seconds, without a file.
const MOST: usize = 1000;

/// `twin sweep`.
#[derive(Args)]
pub(crate) struct Sweep {
    /// G-code or a step trace that is played with every value.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// The key of the number, its first and last value, and how many.
    #[arg(long, value_name = "KEY=FROM:TO:COUNT", value_parser = parse_range)]
    vary: Range,
    #[command(flatten)]
    setup: SetupArgs,
    /// Where the tool is at the begin of the file, in mm from motor 1's axis; without it, where the firmware is.
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    begin: Option<[f64; 2]>,
    /// What moves besides the tool, on the file.
    #[arg(long, value_enum, default_value = "rotors")]
    run_model: RunModel,
    #[command(flatten)]
    printer: Printer,
    #[command(flatten)]
    json: Json,
}

/// Values of a key.
#[derive(Clone)]
struct Range {
    key: String,
    values: Vec<f64>,
}

/// What follows from each value.
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

/// What follows for a file.
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
    pub(super) fn answer(&self) -> Result<u8> {
        let setup = self.setup.read()?;
        let stop = Stop::at_signals()?;
        let source = self.file.as_deref().map(|file| Source::read(file, &self.printer, &stop));
        let rows = source.transpose().and_then(|source| {
            let row = |value: &f64| self.row(&setup, *value, source.as_ref(), &stop);
            self.vary.values.iter().map(row).collect::<Result<Vec<_>>>()
        });
        if let Some(status) = stop.status() {
            eprintln!("corehbot: interrupted");
            return Ok(status);
        }
        let answer = Answer { key: self.vary.key.clone(), rows: rows? };
        let files = self.setup.machine.files().chain(self.printer.files()).chain(self.file.as_deref());
        self.json.give(&answer, files)
    }

    fn row(&self, nominal: &Setup, value: f64, source: Option<&Source>, stop: &Stop) -> Result<Row> {
        let key = &self.vary.key;
        let params = varied(&nominal.params, key, value)?;
        let reach = workspace(nominal.machine, &params);
        if !reach.has(nominal.tool) {
            bail!("{key} = {value}: the tool does not reach ({:.1}, {:.1})", nominal.tool.x, nominal.tool.y);
        }
        let setup = Setup { params, ..nominal.clone() };
        let (stiffness, modes) = (Stiffness::new(&setup)?, Modes::new(&setup)?);
        let frequencies_hz = [0, 1].map(|i| modes.frequencies_hz.get(i).copied().unwrap_or(0.0));
        let run = source.map(|source| self.run(&setup, source, stop)).transpose();
        let run = run.with_context(|| format!("{key} = {value}"))?;
        Ok(Row { value, kxx: stiffness.kxx, kyy: stiffness.kyy, frequencies_hz, run })
    }

    fn run(&self, setup: &Setup, source: &Source, stop: &Stop) -> Result<RunRow> {
        let origin = workspace(setup.machine, &setup.params).origin();
        let [x, y] = self.begin.unwrap_or([origin.x + source.begin[0], origin.y + source.begin[1]]);
        let (report, _) =
            play(setup.machine, &setup.params, Place { x, y }, self.run_model, (&source.steps, None), stop)?;
        Ok(RunRow {
            contour_max_mm: report.contour.max_mm,
            contour_rms_mm: report.contour.rms_mm,
            torque_max_mnm: report.motors.iter().map(|motor| motor.torque_max_mnm).fold(0.0, f64::max),
            slips: report.motors.iter().map(|motor| motor.slips).sum(),
            tension_min_n: report.tension_n.values().map(|[least, _]| *least).fold(f64::INFINITY, f64::min),
        })
    }
}

/// Numbers with another one by its key.
fn varied(params: &Params, key: &str, value: f64) -> Result<Params> {
    let mut all = serde_json::to_value(params)?;
    let keys = all.as_object().map(|all| all.keys().cloned().collect::<Vec<_>>()).unwrap_or_default();
    match all.get_mut(key) {
        Some(entry) => *entry = Value::from(value),
        None => bail!("there is no `{key}`; there are {}", keys.join(", ")),
    }
    let params: Params = serde_json::from_value(all)?;
    params.check()?;
    Ok(params)
}

/// `belt_EA_N=20000:56000:7`.
fn parse_range(text: &str) -> Result<Range, String> {
    let wrong = || format!("`{text}` is not KEY=FROM:TO:COUNT, with 2 to {MOST} values");
    let (key, range) = text.split_once('=').ok_or_else(wrong)?;
    let [from, to, count] = range.split(':').collect::<Vec<_>>()[..] else { return Err(wrong()) };
    let number = |text: &str| text.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(wrong);
    let (from, to) = (number(from)?, number(to)?);
    let count: usize = count.parse().ok().filter(|n| (2..=MOST).contains(n)).ok_or_else(wrong)?;
    let value = |i: usize| from + (to - from) * i as f64 / (count - 1) as f64;
    Ok(Range { key: key.to_owned(), values: (0..count).map(value).collect() })
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
