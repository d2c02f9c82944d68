//! Plan: a study as it is computed, every sample a pure function of it and of the sample's number.

use super::query::{Places, Query};
use crate::sampling::Design;
use anyhow::Result;
use corehbot_host::stop::Stop;
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::{Params, ParamsError, ROWS, Row};
use corehbot_twin::queries::Setup;
use corehbot_twin::routing::Machine;
use std::path::PathBuf;

/// Most samples of a study, for the memory of their table.
pub(in crate::commands) const MOST: usize = 1_000_000;

/// A study.
pub(in crate::commands) struct Study {
    /// Its identity among all studies, as a hash.
    pub(super) identity: String,
    /// The machines; each has every point of the design, one after the other.
    pub(super) machines: Vec<Machine>,
    /// The numbers that are not varied.
    pub(super) params: Params,
    /// The keys of those that are.
    pub(in crate::commands) keys: Vec<String>,
    /// Their values.
    pub(super) design: Design,
    /// How many samples that makes.
    pub(super) samples: usize,
    /// The queries.
    pub(super) queries: Vec<Query>,
    /// The files that define it.
    pub(super) inputs: Vec<PathBuf>,
}

/// The subject of a sample.
pub(in crate::commands) struct Point {
    pub machine: Machine,
    /// The values of the numbers that are varied.
    pub values: Vec<f64>,
}

/// A sample that was computed.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::commands) struct Sample {
    /// Its number, counted from 0.
    pub number: usize,
    /// Its figures, as far as each exists; or why it has none at all.
    pub outcome: Result<Vec<Option<f64>>, String>,
}

impl Study {
    /// One number at these levels, on one machine with its tool at a place; and the figures of a file, if there is one.
    pub(in crate::commands) fn of_one(setup: Setup, key: String, levels: Vec<f64>, run: Option<Query>) -> Self {
        let Setup { machine, params, tool, freedom } = setup;
        let places = Places::At(tool);
        let queries = [Query::Stiffness { places, freedom }, Query::Modes { places, freedom }];
        Self {
            identity: String::new(),
            machines: vec![machine],
            params,
            keys: vec![key],
            samples: levels.len(),
            design: Design::Grid(vec![levels]),
            queries: queries.into_iter().chain(run).collect(),
            inputs: Vec::new(),
        }
    }

    /// The columns of all figures.
    pub(in crate::commands) fn figures(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.queries.iter().flat_map(|query| query.figures()).map(|figure| figure.name)
    }

    /// The subject of the sample with this number.
    pub(in crate::commands) fn point(&self, number: usize) -> Option<Point> {
        let machine = *self.machines.get(number.checked_rem(self.machines.len())?)?;
        let values = self.design.point(number / self.machines.len())?;
        Some(Point { machine, values })
    }

    /// Reads the file for samples, unless it was read before.
    ///
    /// # Errors
    /// It cannot be played, or it was stopped.
    pub(super) fn load(&self, stop: &Stop) -> Result<()> {
        self.queries.iter().try_for_each(|query| query.load(stop))
    }

    /// Computes a sample; `None` if there is no such sample, if its file was not loaded, or if it was stopped.
    pub(super) fn sample(&self, number: usize, stop: &Stop) -> Option<Sample> {
        let point = self.point(number).filter(|_| self.queries.iter().all(Query::is_loaded))?;
        let outcome = self.outcome(&point, stop);
        (!stop.is_set()).then_some(Sample { number, outcome })
    }

    fn outcome(&self, Point { machine, values }: &Point, stop: &Stop) -> Result<Vec<Option<f64>>, String> {
        let params = varied(&self.params, &self.keys, values).map_err(|error| error.to_string())?;
        let reach = workspace(*machine, &params);
        if !(reach.x[0] < reach.x[1] && reach.y[0] < reach.y[1]) {
            return Err("these pulleys leave the tool no room".to_owned());
        }
        let mut figures = Vec::new();
        for query in &self.queries {
            let answer = query.answer(*machine, &params, stop).map_err(|error| error.to_string())?;
            figures.extend(answer.into_iter().map(|figure| Some(figure).filter(|figure| figure.is_finite())));
        }
        Ok(figures)
    }
}

/// Why numbers do not make a machine.
#[derive(Debug)]
pub(in crate::commands) enum NotVaried {
    /// No number has the key.
    Unknown { key: String, known: Vec<String> },
    /// No machine has the number.
    Illegal(ParamsError),
}

/// Numbers with others by their keys.
pub(in crate::commands) fn varied(params: &Params, keys: &[String], values: &[f64]) -> Result<Params, NotVaried> {
    let mut params = params.clone();
    for (key, value) in keys.iter().zip(values) {
        let row = Row::of(key).ok_or_else(|| NotVaried::Unknown {
            key: key.clone(),
            known: ROWS.iter().map(|row| row.key.to_owned()).collect(),
        })?;
        // Numbers of several belts or motors keep their proportions.
        let varied = row.values(&params).with_first(*value);
        (row.field)(&mut params).set(varied);
    }
    params.check().map_err(NotVaried::Illegal)?;
    Ok(params)
}

impl std::fmt::Display for NotVaried {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unknown { key, known } => write!(f, "there is no `{key}`; there are {}", known.join(", ")),
            Self::Illegal(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for NotVaried {}
