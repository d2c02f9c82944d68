//! Search: the machine that the measurements fit best, and how well they determine it.
//!
//! The unknowns are logarithms of numbers over their nominal ones, because all are positive and their uncertainties are
//! relative. What is expected of the numbers counts as further measurements. A round of the Gauss-Newton method changes
//! the logarithms by `-(J^T J + W)^-1 (J^T r + W p)`. The step is halved as long as that makes the sum of squares
//! smaller: whole steps may jump to and fro over the least one. The symbols:
//!
//! - r: excess of the model's figures, in uncertainties;
//! - J: their derivatives by each logarithm;
//! - p: the logarithms;
//! - W: the weights of what is expected.
//!
//! At the end `(J^T J / s^2 + W)^-1` is the covariance (Tarantola, Inverse Problem Theory, chapter on least squares).
//! s is 1, or larger where the differences are larger than the measurements' uncertainties explain (Birge's ratio).
//!
//! A stiffer guide lifts the bar's yaw through the axes' modes, so there may be several minima. The search begins at
//! several stiffnesses of the yaw.

use super::error::CalibrateError;
use super::figure::{Measurement, Model};
use super::parameter::{Parameter, Unknown};
use crate::math::{exp, ln, powi, square};
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use nalgebra::{DMatrix, DVector};

/// Maximum number of rounds; a few suffice.
const ROUNDS: usize = 60;

/// A step is halved at most so often.
const HALVES: i32 = 12;

/// Change of a logarithm for central differences; their error is proportional to its square.
const PROBE: f64 = 1e-4;

/// Largest change of a logarithm in a round.
const LONGEST_STEP: f64 = 0.7;

/// Largest change in all: a factor of a hundred.
const FURTHEST: f64 = 4.605;

/// The search ends at changes below this.
const CLOSE: f64 = 1e-7;

/// A figure does not depend on a number if doubling it changes the figure by less than this part (or this much of a
/// figure with a sign): rounding changes it as much.
const NO_MATTER: f64 = 1e-6;

/// Part of the sum of squares that is rounding.
const ROUNDING: f64 = 1e-12;

/// The search has converged if a step could lower the sum of squares, in squared uncertainties, by less than this.
const SETTLED: f64 = 1e-3;

/// The search also begins at so many times the nominal stiffness of the yaw.
const YAW_STARTS: [f64; 2] = [5.0, 25.0];

/// The problem: a machine of this kind, near the nominal one, that the measurements fit.
#[derive(Clone, Copy)]
pub(super) struct Search<'m> {
    pub machine: Machine,
    /// The nominal machine, with a number for each unknown.
    pub nominal: &'m Params,
    pub measurements: &'m [Measurement],
    pub sought: &'m [Unknown],
    /// Weights of what is expected.
    pub weights: &'m DMatrix<f64>,
}

/// The machine that fits best.
#[derive(Clone)]
pub(super) struct Best {
    pub params: Params,
    /// Excess of the model, in uncertainties, a row for each measurement.
    pub excess: DVector<f64>,
    /// Its derivatives by each unknown, a column for each.
    pub slopes: DMatrix<f64>,
    /// Sum of squares, with those of what was expected.
    pub cost: f64,
}

/// A machine on the way.
#[derive(Clone)]
struct Point {
    logs: DVector<f64>,
    params: Params,
    excess: DVector<f64>,
    cost: f64,
}

/// The weights of what is expected of these unknowns.
pub(super) fn weights(sought: &[Unknown], is_belt_weighed: bool) -> DMatrix<f64> {
    let mut weights = DMatrix::zeros(sought.len(), sought.len());
    for (row, unknown) in sought.iter().enumerate() {
        let (with, uncertainty) = unknown.expected(is_belt_weighed);
        let weight = 1.0 / square(uncertainty);
        weights[(row, row)] += weight;
        // A number that is not sought is exact.
        let other =
            with.and_then(|with| sought.iter().position(|u| (u.parameter, u.part) == (with.parameter, with.part)));
        if let Some(other) = other {
            weights[(other, other)] += weight;
            weights[(row, other)] -= weight;
            weights[(other, row)] -= weight;
        }
    }
    weights
}

impl Search<'_> {
    /// The nominal machine with these changes.
    fn machine_at(&self, logs: &DVector<f64>) -> Params {
        let change = |params: Params, (unknown, log): (&Unknown, &f64)| {
            unknown.with(unknown.of(self.nominal) * exp(*log), &params)
        };
        self.sought.iter().zip(logs.iter()).fold(self.nominal.clone(), change)
    }

    /// Excess of a machine's figures, in uncertainties, a row for each measurement.
    pub(super) fn excess(&self, params: &Params) -> Result<DVector<f64>, NotHeld> {
        let mut model = Model::new(self.machine, params);
        let one = |m: &Measurement| Ok(m.excess(model.says(&m.figure)?));
        Ok(DVector::from_vec(self.measurements.iter().map(one).collect::<Result<_, _>>()?))
    }

    /// Derivatives of the excess at this machine, a row for each measurement, a column for each unknown.
    pub(super) fn slopes(&self, params: &Params) -> Result<DMatrix<f64>, NotHeld> {
        let mut slopes = DMatrix::zeros(self.measurements.len(), self.sought.len());
        for (column, unknown) in self.sought.iter().enumerate() {
            let probed = |by: f64| self.excess(&unknown.with(unknown.of(params) * exp(by), params));
            let mut slope = (probed(PROBE)? - probed(-PROBE)?) / (2.0 * PROBE);
            for (entry, m) in slope.iter_mut().zip(self.measurements) {
                if (*entry * m.uncertainty).abs() < NO_MATTER {
                    *entry = 0.0;
                }
            }
            slopes.set_column(column, &slope);
        }
        Ok(slopes)
    }

    fn point(&self, logs: DVector<f64>) -> Result<Point, NotHeld> {
        let params = self.machine_at(&logs);
        let excess = self.excess(&params)?;
        let cost = excess.norm_squared() + logs.dot(&(self.weights * &logs));
        Ok(Point { logs, params, excess, cost })
    }

    /// The machine with the least sum of squares.
    pub(super) fn run(&self) -> Result<Best, CalibrateError> {
        let nominal = self.point(DVector::zeros(self.sought.len()))?;
        let mut best = self.run_from(nominal.clone());
        let yaw = self.sought.iter().position(|unknown| unknown.parameter == Parameter::YawStiffness);
        for (yaw, factor) in yaw.into_iter().flat_map(|yaw| YAW_STARTS.map(|factor| (yaw, factor))) {
            let mut logs = nominal.logs.clone();
            logs[yaw] = ln(factor);
            let Ok(start) = self.point(logs) else { continue };
            // Where no figure depends on it, all starts are alike.
            if (&start.excess - &nominal.excess).amax() < NO_MATTER {
                continue;
            }
            let Ok(other) = self.run_from(start) else { continue };
            let is_no_better = |best: &Best| other.cost >= best.cost * (1.0 - NO_MATTER) - NO_MATTER;
            if !best.as_ref().is_ok_and(is_no_better) {
                best = Ok(other);
            }
        }
        best
    }

    /// The nearest minimum.
    fn run_from(&self, mut at: Point) -> Result<Best, CalibrateError> {
        for round in 1.. {
            let slopes = self.slopes(&at.params)?;
            let slope = slopes.transpose() * &at.excess + self.weights * &at.logs;
            let normal = slopes.transpose() * &slopes + self.weights;
            let step = normal.cholesky().ok_or(CalibrateError::NoMachine)?.solve(&slope);
            let is_settled = step.dot(&slope) < SETTLED;
            let longest = step.amax();
            let step = if longest > LONGEST_STEP { step * (LONGEST_STEP / longest) } else { step };
            let next = if round > ROUNDS { None } else { self.lower(&at, &step)? };
            match next {
                Some(next) if longest >= CLOSE => at = next,
                next if is_settled => {
                    let Point { params, excess, cost, .. } = next.unwrap_or(at);
                    return Ok(Best { params, excess, slopes, cost });
                }
                _ => return Err(CalibrateError::NotConverged),
            }
            if at.logs.amax() > FURTHEST || !at.logs.iter().all(|log| log.is_finite()) {
                return Err(CalibrateError::NoMachine);
            }
        }
        Err(CalibrateError::NotConverged)
    }

    /// The lowest place on the way back, by halves, from a step's end; `None` if none is lower, up to rounding.
    fn lower(&self, at: &Point, step: &DVector<f64>) -> Result<Option<Point>, NotHeld> {
        let rounding = at.cost * ROUNDING + ROUNDING * NO_MATTER;
        let mut found: Option<Point> = None;
        for half in 0..=HALVES {
            let next = self.point(&at.logs - step * powi(0.5, half))?;
            match &found {
                Some(found) if next.cost >= found.cost - rounding => break,
                None if next.cost.is_nan() || next.cost > at.cost + rounding => {}
                _ => found = Some(next),
            }
        }
        Ok(found)
    }

    /// Covariance of the logarithms, for measurements `spread` times as uncertain as stated.
    pub(super) fn covariance(&self, slopes: &DMatrix<f64>, spread: f64) -> Result<DMatrix<f64>, CalibrateError> {
        let normal = slopes.transpose() * slopes / (spread * spread) + self.weights;
        Ok(normal.cholesky().ok_or(CalibrateError::NoMachine)?.inverse())
    }

    /// How many times larger the differences are than the uncertainties explain, at least 1. A measurement beyond those
    /// that determine a number counts.
    pub(super) fn spread(&self, best: &Best) -> Result<f64, CalibrateError> {
        let covariance = self.covariance(&best.slopes, 1.0)?;
        let used = (&best.slopes * covariance * best.slopes.transpose()).trace();
        let free = self.measurements.len() as f64 - used;
        // Of less than one measurement nothing follows.
        Ok(if free < 1.0 { 1.0 } else { (best.excess.norm_squared() / free).sqrt().max(1.0) })
    }
}
