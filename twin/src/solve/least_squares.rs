//! Least squares: the nearest minimum of a sum of squares, over the logarithms of a machine's numbers.
//!
//! A round of the Gauss-Newton method changes the logarithms by `-(J^T J + W)^-1 (J^T r + W p)`. The step is halved as
//! long as that makes the sum of squares smaller: whole steps may jump to and fro over the least one. The symbols:
//!
//! - r: excess of the model's figures, in uncertainties;
//! - J: their derivatives by each logarithm;
//! - p: the logarithms;
//! - W: the weights of what is expected.

use super::NotHeld;
use crate::math::powi;
use nalgebra::{DMatrix, DVector};

/// Maximum number of rounds; a few suffice.
const ROUNDS: usize = 60;

/// A step is halved at most so often.
const HALVES: i32 = 12;

/// Change of a logarithm for central differences; their error is proportional to its square.
pub const PROBE: f64 = 1e-4;

/// Largest change of a logarithm in a round.
const LONGEST_STEP: f64 = 0.7;

/// Largest change in all: a factor of a hundred.
pub const FURTHEST: f64 = 4.605;

/// The search ends at changes below this.
const CLOSE: f64 = 1e-7;

/// Part of the sum of squares that is rounding.
const ROUNDING: f64 = 1e-12;

/// The same where nothing is left of the sum.
const NOTHING_LEFT: f64 = 1e-18;

/// The search has converged if a step could lower the sum of squares, in squared uncertainties, by less than this.
const SETTLED: f64 = 1e-3;

/// Figures that numbers are to explain.
pub trait Problem {
    /// Excess of the figures at these logarithms, in uncertainties.
    ///
    /// # Errors
    /// Nothing holds the machine.
    fn excess(&self, logs: &DVector<f64>) -> Result<DVector<f64>, NotHeld>;

    /// Its derivatives, a column for each logarithm.
    ///
    /// # Errors
    /// Nothing holds the machine.
    fn slopes(&self, logs: &DVector<f64>) -> Result<DMatrix<f64>, NotHeld>;

    /// The weights of what is expected.
    fn weights(&self) -> &DMatrix<f64>;

    /// These logarithms with their excess.
    ///
    /// # Errors
    /// Nothing holds the machine.
    fn point(&self, logs: DVector<f64>) -> Result<Point, NotHeld> {
        let excess = self.excess(&logs)?;
        let cost = excess.norm_squared() + logs.dot(&(self.weights() * &logs));
        Ok(Point { logs, excess, cost })
    }
}

/// A place on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The logarithms.
    pub logs: DVector<f64>,
    /// The excess.
    pub excess: DVector<f64>,
    /// Sum of squares, with those of what was expected.
    pub cost: f64,
}

/// Why there is no minimum. The logarithms are those where the search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum NoMinimum {
    /// Nothing holds the machine.
    NotHeld(NotHeld),
    /// There is none within a factor of a hundred.
    OutOfReach(DVector<f64>),
    /// The search did not converge.
    NotConverged(DVector<f64>),
}

impl From<NotHeld> for NoMinimum {
    fn from(error: NotHeld) -> Self {
        Self::NotHeld(error)
    }
}

/// The minimum that is nearest to a place, with the slopes of the last round.
///
/// # Errors
/// There is none.
pub fn nearest_minimum(problem: &impl Problem, mut at: Point) -> Result<(Point, DMatrix<f64>), NoMinimum> {
    for round in 1.. {
        let slopes = problem.slopes(&at.logs)?;
        let slope = slopes.transpose() * &at.excess + problem.weights() * &at.logs;
        let normal = slopes.transpose() * &slopes + problem.weights();
        let Some(normal) = normal.cholesky() else { return Err(NoMinimum::OutOfReach(at.logs)) };
        let step = normal.solve(&slope);
        let is_settled = step.dot(&slope) < SETTLED;
        let longest = step.amax();
        let step = if longest > LONGEST_STEP { step * (LONGEST_STEP / longest) } else { step };
        let next = if round > ROUNDS { None } else { lower(problem, &at, &step)? };
        match next {
            Some(next) if longest >= CLOSE => at = next,
            next if is_settled => return Ok((next.unwrap_or(at), slopes)),
            _ => return Err(NoMinimum::NotConverged(at.logs)),
        }
        if at.logs.amax() > FURTHEST || !at.logs.iter().all(|log| log.is_finite()) {
            return Err(NoMinimum::OutOfReach(at.logs));
        }
    }
    Err(NoMinimum::NotConverged(at.logs))
}

/// The lowest place on the way back, by halves, from a step's end; `None` if none is lower, up to rounding.
fn lower(problem: &impl Problem, at: &Point, step: &DVector<f64>) -> Result<Option<Point>, NotHeld> {
    let rounding = at.cost * ROUNDING + NOTHING_LEFT;
    let mut found: Option<Point> = None;
    for half in 0..=HALVES {
        let next = problem.point(&at.logs - step * powi(0.5, half))?;
        match &found {
            Some(found) if next.cost >= found.cost - rounding => break,
            None if next.cost.is_nan() || next.cost > at.cost + rounding => {}
            _ => found = Some(next),
        }
    }
    Ok(found)
}
