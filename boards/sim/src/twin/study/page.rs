//! Page: a picture of each figure over each number that was varied, without any network; of one family with
//! `corehbot twin run --report`.

use super::plan::{Sample, Study};
use super::summary::Summary;
use crate::twin::page::fill;
use anyhow::{Context as _, Result};
use serde::Serialize;
use std::io::Write;

/// The page.
const TEMPLATE: &str = include_str!("page.html");

/// Most samples that are drawn; of more, evenly chosen ones.
const MOST_DRAWN: usize = 5000;

#[derive(Serialize)]
struct Data<'a> {
    file: &'a str,
    summary: Summary,
    keys: &'a [String],
    figures: Vec<&'static str>,
    machines: Vec<&'static str>,
    points: Vec<Drawn>,
}

/// A sample that has figures.
#[derive(Serialize)]
struct Drawn {
    sample: usize,
    /// Its place among `machines`.
    machine: usize,
    values: Vec<f64>,
    figures: Vec<Option<f64>>,
}

/// Writes the page.
///
/// # Errors
/// What `out` reports.
pub(super) fn write(out: &mut impl Write, file: &str, study: &Study, samples: &[Sample]) -> Result<()> {
    let drawn = |sample: &Sample| {
        let point = study.point(sample.number)?;
        let machine = study.machines.iter().position(|machine| *machine == point.machine)?;
        let figures = sample.outcome.as_ref().ok()?.clone();
        Some(Drawn { sample: sample.number, machine, values: point.values, figures })
    };
    let every = samples.len().div_ceil(MOST_DRAWN).max(1);
    let data = Data {
        file,
        summary: Summary::new(study, samples),
        keys: &study.keys,
        figures: study.figures().collect(),
        machines: study.machines.iter().map(|machine| machine.name()).collect(),
        points: samples.iter().step_by(every).filter_map(drawn).collect(),
    };
    fill(out, TEMPLATE, &data).context("cannot write the report")
}
