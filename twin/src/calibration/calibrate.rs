//! Calibrate: finds the numbers with which the model reproduces the measurements.
//!
//! The [`search`](super::search) finds the best machine. It is refused by its differences from the measurements alone,
//! never by its distance from the nominal one. Then measurements are left out one after the other: the wrong one is the
//! one without which the others fit.

use super::error::{CalibrateError, Misfit};
use super::figure::{Figure, Measurement};
use super::further::{Further, further};
use super::parameter::{Parameter, Unknown};
use super::search::{Best, Search, weights};
use crate::math::exp;
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// A machine that reproduces the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// All its numbers, including the undetermined ones; together they reproduce the measurements.
    pub params: Params,
    /// The numbers that were determined.
    pub estimates: Vec<Estimate>,
    /// The numbers that matter to a measurement and are hardly better known than before.
    pub not_told: Vec<Estimate>,
    /// The numbers on which no measurement depends.
    pub unasked: Vec<Unknown>,
    /// Remaining difference of each measurement, in their order.
    pub misfits: Vec<Misfit>,
    /// Factor by which the differences enlarged the uncertainties of the measurements; 1 if they did not.
    pub spread: f64,
    /// Further measurements, the most helpful first.
    pub further: Vec<Further>,
}

/// A fitted number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The parameter.
    pub parameter: Parameter,
    /// The belt, from 1, where each has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub belt: Option<usize>,
    /// Both.
    #[serde(skip)]
    pub unknown: Unknown,
    /// Its value.
    pub value: f64,
    /// Its nominal value.
    pub nominal: f64,
    /// Its relative standard uncertainty, of 1 (of its logarithm), from the uncertainties of measurements, their
    /// differences from the model, and the uncertainty of the numbers that are not determined.
    pub uncertainty: f64,
    /// Uncertainty that was assumed before.
    pub assumed_uncertainty: f64,
    /// The measurements that it comes from, the most important first.
    #[serde(skip)]
    pub from: Vec<usize>,
}

impl From<NotHeld> for CalibrateError {
    fn from(error: NotHeld) -> Self {
        Self::NotHeld(error)
    }
}

/// A number is determined if at most this part of its assumed uncertainty remains (assumed: a third).
const TOLD: f64 = 1.0 / 3.0;

/// Figures depend on a number if less than this part of its uncertainty remains (assumed).
const DEPENDS: f64 = 0.95;

/// Largest difference of the nearest machine from a measurement, in uncertainties. Beyond, the measurement is of
/// another machine or wrong: one in two million exceeds it by chance.
const LIKE: f64 = 5.0;

/// So many of the most doubtful measurements are left out in turn.
const DOUBTED: usize = 4;

/// A measurement is a source of a number if this part of its resolution, or of its variance, comes from it.
const SOURCE: f64 = 0.15;

/// Fits all numbers except the `fixed` ones, which count as exact, beginning at `params`.
///
/// # Errors
/// The measurements do not determine a number, or no machine reproduces them.
pub fn calibrate(
    machine: Machine,
    params: &Params,
    measurements: &[Measurement],
    fixed: &[Parameter],
) -> Result<Calibrated, CalibrateError> {
    let mut sought = Unknown::of_machine(machine, fixed);
    // A number that is 0 is left out of the machine, and has no logarithm.
    sought.retain(|unknown| unknown.of(params) > 0.0);
    // A number that follows from others counts from here on.
    let mut nominal = sought.iter().fold(params.clone(), |params, unknown| unknown.with(unknown.of(&params), &params));
    // A fixed one stays, whatever it would follow.
    if fixed.contains(&Parameter::YawInertia) {
        nominal.bar_yaw_inertia_kg_m2 = Some(params.bar_yaw_inertia_kg_mm2() * 1e-6);
    }
    let is_belt_weighed = measurements.iter().any(|m| matches!(m.figure, Figure::BeltMass));
    let weights = weights(&sought, is_belt_weighed);
    let search = Search { machine, nominal: &nominal, measurements, sought: &sought, weights: &weights };
    let best = match search.run() {
        Ok(best) => best,
        Err(error @ (CalibrateError::NoMachine | CalibrateError::NotConverged)) => {
            return Err(search.without_suspect(0..measurements.len())?.map_or(error, CalibrateError::Unlike));
        }
        Err(error) => return Err(error),
    };
    if best.slopes.iter().all(|slope| *slope == 0.0) {
        return Err(CalibrateError::Nothing);
    }
    let misfits = search.misfits(&best.excess, None);
    if misfits.iter().any(|misfit| misfit.uncertainties.abs() > LIKE) {
        let doubted = search.doubted(&best)?;
        return Err(CalibrateError::Unlike(search.without_suspect(doubted)?.unwrap_or(misfits)));
    }
    let spread = search.spread(&best)?;
    let covariance = search.covariance(&best.slopes, spread)?;
    let assumed = search.covariance(&DMatrix::zeros(0, sought.len()), 1.0)?;
    let (mut estimates, mut not_told, mut unasked) = (Vec::new(), Vec::new(), Vec::new());
    let gain = &covariance * best.slopes.transpose();
    for (i, unknown) in sought.iter().enumerate() {
        // Those that resolve it, then others with an error that reaches it.
        let (row, column) = (gain.row(i), best.slopes.column(i));
        let mut from = sources(row.iter().zip(column.iter()).map(|(gain, slope)| (gain * slope).max(0.0)));
        let reach = sources(row.iter().map(|gain| gain * gain));
        for measurement in reach {
            if !from.contains(&measurement) {
                from.push(measurement);
            }
        }
        if best.slopes.column(i).amax() == 0.0 {
            unasked.push(*unknown);
            continue;
        }
        let estimate = Estimate {
            parameter: unknown.parameter,
            belt: (unknown.parts > 1).then_some(unknown.part + 1),
            unknown: *unknown,
            value: unknown.of(&best.params),
            nominal: unknown.of(params),
            uncertainty: covariance[(i, i)].sqrt(),
            assumed_uncertainty: assumed[(i, i)].sqrt(),
            from,
        };
        let is_told = estimate.uncertainty <= TOLD * estimate.assumed_uncertainty;
        if is_told { &mut estimates } else { &mut not_told }.push(estimate);
    }
    if estimates.is_empty() {
        let depends = |e: &&Estimate| e.uncertainty <= DEPENDS * e.assumed_uncertainty;
        let depends: Vec<_> = not_told.iter().filter(depends).map(|e| e.unknown).collect();
        let is_nothing = depends.is_empty();
        return Err(if is_nothing { CalibrateError::Nothing } else { CalibrateError::Undetermined(depends) });
    }
    let further = further(&search, &best.params, &covariance)?;
    let mut found = best.params;
    // What no measurement asks for stays as it was: an inertia may follow the bar's mass on.
    if unasked.iter().any(|unknown| unknown.parameter == Parameter::YawInertia) {
        found.bar_yaw_inertia_kg_m2 = params.bar_yaw_inertia_kg_m2;
    }
    Ok(Calibrated { params: found, estimates, not_told, unasked, misfits, spread, further })
}

/// The measurements with the largest parts of a sum, the largest first.
fn sources(parts: impl Iterator<Item = f64>) -> Vec<usize> {
    let mut parts: Vec<(usize, f64)> = parts.enumerate().collect();
    let sum: f64 = parts.iter().map(|(_, part)| part).sum();
    parts.retain(|(_, part)| *part >= SOURCE * sum && *part > 0.0);
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    parts.into_iter().map(|(measurement, _)| measurement).collect()
}

impl Search<'_> {
    /// Differences of a machine with this excess.
    fn misfits(&self, excess: &DVector<f64>, suspect: Option<usize>) -> Vec<Misfit> {
        let misfit = |(i, (m, uncertainties)): (usize, (&Measurement, &f64))| {
            let off = uncertainties * m.uncertainty;
            let (model, size) = if m.figure.has_sign() {
                (m.measured + off, m.measured.abs().max(m.uncertainty))
            } else {
                (m.measured * exp(off), m.measured)
            };
            Misfit {
                measured: m.measured,
                model,
                unit: m.figure.unit(),
                part: (model - m.measured) / size,
                uncertainties: *uncertainties,
                is_suspect: suspect == Some(i),
            }
        };
        self.measurements.iter().zip(excess.iter()).enumerate().map(misfit).collect()
    }

    /// The doubtful measurements: those with the largest difference over its own uncertainty. A measurement that pulls
    /// the machine to itself hides its error.
    fn doubted(&self, best: &Best) -> Result<Vec<usize>, CalibrateError> {
        let covariance = self.covariance(&best.slopes, 1.0)?;
        let pulls = (&best.slopes * covariance * best.slopes.transpose()).diagonal();
        let doubt = |(i, excess): (usize, &f64)| (i, excess.abs() / (1.0 - pulls[i]).max(1e-9).sqrt());
        let mut doubted: Vec<(usize, f64)> = best.excess.iter().enumerate().map(doubt).collect();
        doubted.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(doubted.into_iter().take(DOUBTED).map(|(out, _)| out).collect())
    }

    /// The suspect is the measurement without which the others fit; the one without which they fit best, where there
    /// are several. Differences of the machine that the others fit.
    fn without_suspect(&self, doubted: impl IntoIterator<Item = usize>) -> Result<Option<Vec<Misfit>>, CalibrateError> {
        let mut found: Option<(usize, Best)> = None;
        for out in doubted {
            let others: Vec<Measurement> =
                self.measurements.iter().enumerate().filter(|(i, _)| *i != out).map(|(_, m)| *m).collect();
            if others.is_empty() {
                continue;
            }
            let Ok(best) = (Search { measurements: &others, ..*self }).run() else { continue };
            let fits = best.excess.iter().all(|excess| excess.abs() <= LIKE);
            if fits && found.as_ref().is_none_or(|(_, found)| best.cost < found.cost) {
                found = Some((out, best));
            }
        }
        let Some((out, best)) = found else { return Ok(None) };
        Ok(Some(self.misfits(&self.excess_of(&best.params)?, Some(out))))
    }
}
