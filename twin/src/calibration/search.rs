//! Search: the machine that the measurements fit best, and how well they determine it.
//!
//! The unknowns are logarithms of numbers over their nominal ones, because all are positive and their uncertainties are
//! relative. What is expected of the numbers counts as further measurements. The search is that of
//! [`least_squares`](crate::solve::least_squares), which has the symbols.
//!
//! At the end `(J^T J / s^2 + W)^-1` is the covariance (Tarantola, Inverse Problem Theory, chapter on least squares).
//! The scale s is 1, or larger where the differences are larger than the measurements' uncertainties explain (Birge's
//! ratio).
//!
//! A stiffer guide lifts the bar's yaw through the axes' modes, so there may be several minima. The search begins at
//! several stiffnesses of the yaw.

use super::error::CalibrateError;
use super::figure::{Measurement, Model};
use super::parameter::{Parameter, Unknown};
use crate::math::{exp, ln, square};
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use crate::solve::least_squares::{NoMinimum, PROBE, Point, Problem, nearest_minimum};
use nalgebra::{DMatrix, DVector};

/// A figure does not depend on a number if doubling the number changes the figure by less than this part (or this much
/// of a figure with a sign). Rounding changes it as much.
const NO_MATTER: f64 = 1e-6;

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

impl Problem for Search<'_> {
    fn excess(&self, logs: &DVector<f64>) -> Result<DVector<f64>, NotHeld> {
        self.excess_of(&self.machine_at(logs))
    }

    fn slopes(&self, logs: &DVector<f64>) -> Result<DMatrix<f64>, NotHeld> {
        self.slopes_at(&self.machine_at(logs))
    }

    fn weights(&self) -> &DMatrix<f64> {
        self.weights
    }
}

impl From<NoMinimum> for CalibrateError {
    fn from(error: NoMinimum) -> Self {
        match error {
            NoMinimum::NotHeld(error) => Self::NotHeld(error),
            NoMinimum::OutOfReach(_) => Self::NoMachine,
            NoMinimum::NotConverged(_) => Self::NotConverged,
        }
    }
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
    pub(super) fn excess_of(&self, params: &Params) -> Result<DVector<f64>, NotHeld> {
        let mut model = Model::new(self.machine, params);
        let one = |m: &Measurement| Ok(m.excess(model.says(&m.figure)?));
        Ok(DVector::from_vec(self.measurements.iter().map(one).collect::<Result<_, _>>()?))
    }

    /// Derivatives of the excess at this machine, a row for each measurement, a column for each unknown.
    pub(super) fn slopes_at(&self, params: &Params) -> Result<DMatrix<f64>, NotHeld> {
        let mut slopes = DMatrix::zeros(self.measurements.len(), self.sought.len());
        for (column, unknown) in self.sought.iter().enumerate() {
            let probed = |by: f64| self.excess_of(&unknown.with(unknown.of(params) * exp(by), params));
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
    fn run_from(&self, start: Point) -> Result<Best, CalibrateError> {
        let (Point { logs, excess, cost }, slopes) = nearest_minimum(self, start)?;
        Ok(Best { params: self.machine_at(&logs), excess, slopes, cost })
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
