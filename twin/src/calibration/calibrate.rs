//! Calibrate: finds the parameters with which the model reproduces the measurements.
//!
//! The unknowns are logarithms of parameters, because all are positive and their uncertainties are relative. Each
//! nominal value counts as one more measurement, with its assumed uncertainty. So a parameter that the figures hardly
//! determine makes the others uncertain by its effect on them, and worse figures never determine more. A round of the
//! Gauss-Newton method changes the logarithms by `-(J^T J + W)^-1 (J^T r + W p)`:
//!
//! - r: differences of the figures' logarithms, divided by their uncertainties;
//! - J: their derivatives by each parameter;
//! - p: distances of the parameters from their nominal values;
//! - W: inverse squares of the assumed uncertainties.
//!
//! At the end `(J^T J + W)^-1` is the covariance of the logarithms (Tarantola, Inverse Problem Theory, chapter on least
//! squares).

use super::figure::{Figure, Measurement};
use super::parameter::Parameter;
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::Serialize;

/// A machine that reproduces the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// All its parameters, including the undetermined ones; together they reproduce the measurements.
    pub params: Params,
    /// The parameters that were determined.
    pub estimates: Vec<Estimate>,
    /// The parameters that are hardly better known than before.
    pub not_told: Vec<Estimate>,
    /// Remaining difference of each measurement, in their order.
    pub misfits: Vec<Misfit>,
}

/// A fitted parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value.
    pub value: f64,
    /// Its relative standard uncertainty, of 1 (of its logarithm), from the uncertainties of measurements and nominal
    /// values.
    pub uncertainty: f64,
    /// Assumed uncertainty of its nominal value.
    pub assumed_uncertainty: f64,
}

/// Difference between the model and a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Misfit {
    /// Relative excess of the model's value, of 1.
    pub part: f64,
    /// The same in uncertainties of the measurement.
    pub uncertainties: f64,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrateError {
    /// No measurement depends much on a fitted parameter.
    Nothing,
    /// The figures depend on these parameters, but determine none.
    Undetermined(Vec<Parameter>),
    /// No machine within a factor of a hundred of the start reproduces the measurements.
    NoMachine,
    /// Differences of the nearest machine from each measurement, too large for one.
    Unlike(Vec<Misfit>),
    /// The machine that reproduces the measurements has an impossible parameter.
    NoSuch(Parameter, f64),
    /// Nothing holds the machine.
    NotHeld(NotHeld),
}

impl std::fmt::Display for CalibrateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Nothing => f.write_str("nothing was measured that depends on a parameter that is sought"),
            Self::Undetermined(parameters) => {
                let keys: Vec<&str> = parameters.iter().map(|parameter| parameter.key()).collect();
                write!(f, "these measurements do not determine {}: ", keys.join(" and "))?;
                f.write_str("more than a third of the uncertainty that is assumed of each stays; ")?;
                f.write_str("measure something else that depends on it, or name one in `fixed`")
            }
            Self::NoMachine => f.write_str("no machine within a hundredfold of the nominal numbers measures like this"),
            Self::Unlike(misfits) => {
                let most = misfits.iter().map(|misfit| misfit.uncertainties.abs()).fold(0.0, f64::max);
                write!(f, "no machine measures like this: the nearest is {most:.0} uncertainties from a measurement")
            }
            Self::NoSuch(parameter, value) => {
                write!(f, "only a machine with {} = {value:.3} measures like this, ", parameter.key())?;
                f.write_str("more than ten times from the nominal one; look at the units and measure again, ")?;
                f.write_str("or give a nearer value in the table [twin] if the machine is like that")
            }
            Self::NotHeld(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for CalibrateError {}

impl From<NotHeld> for CalibrateError {
    fn from(error: NotHeld) -> Self {
        Self::NotHeld(error)
    }
}

/// A parameter is determined if at most this part of its assumed uncertainty remains (assumed: a third).
const TOLD: f64 = 1.0 / 3.0;

/// Figures depend on a parameter if less than this part of its uncertainty remains (assumed).
const DEPENDS: f64 = 0.95;

/// Largest difference of the nearest machine from a measurement, in uncertainties. Beyond, the measurement is of
/// another machine or wrong: one in two million exceeds it by chance.
const LIKE: f64 = 5.0;

/// A determined parameter is within this factor of the nominal one, as a logarithm: ten, where a factor of two is
/// assumed.
const NO_SUCH: f64 = 2.3;

/// Maximum number of rounds; a few suffice.
const ROUNDS: usize = 60;

/// Relative change of a parameter for central differences; their error is proportional to its square.
const PROBE: f64 = 1e-4;

/// Largest factor of a parameter's change in a round (as a logarithm).
const LONGEST_STEP: f64 = 0.7;

/// Largest factor of its change in all: a hundred (as a logarithm).
const FURTHEST: f64 = 4.605;

/// The search ends at changes below this (as a logarithm).
const CLOSE: f64 = 1e-9;

/// Fits all parameters except the `fixed` ones, which count as exact, beginning at `params`.
///
/// # Errors
/// The measurements do not determine a parameter, or no machine reproduces them.
pub fn calibrate(
    machine: Machine,
    params: &Params,
    measurements: &[Measurement],
    fixed: &[Parameter],
) -> Result<Calibrated, CalibrateError> {
    let sought: Vec<Parameter> = Parameter::ALL.into_iter().filter(|parameter| !fixed.contains(parameter)).collect();
    let search = Search { machine, nominal: params, measurements, sought: &sought };
    let params = search.run()?;
    let covariance = search.normal(&search.slopes(&params)?)?.inverse();
    let estimate = |(parameter, variance): (&Parameter, &f64)| Estimate {
        parameter: *parameter,
        value: parameter.of(&params),
        uncertainty: variance.sqrt(),
        assumed_uncertainty: search.assumed_uncertainty(*parameter),
    };
    let all: Vec<Estimate> = sought.iter().zip(covariance.diagonal().iter()).map(estimate).collect();
    let is_left = |e: &Estimate, part: f64| e.uncertainty <= part * e.assumed_uncertainty;
    let (estimates, not_told): (Vec<_>, Vec<_>) = all.into_iter().partition(|e| is_left(e, TOLD));
    if estimates.is_empty() {
        let depends: Vec<_> = not_told.iter().filter(|e| is_left(e, DEPENDS)).map(|e| e.parameter).collect();
        let is_nothing = depends.is_empty();
        return Err(if is_nothing { CalibrateError::Nothing } else { CalibrateError::Undetermined(depends) });
    }
    let left = search.differences(&params)?;
    let misfit = |(m, r): (&Measurement, &f64)| Misfit { part: (r * m.uncertainty).exp_m1(), uncertainties: *r };
    let misfits: Vec<Misfit> = measurements.iter().zip(left.iter()).map(misfit).collect();
    if misfits.iter().any(|misfit| misfit.uncertainties.abs() > LIKE) {
        return Err(CalibrateError::Unlike(misfits));
    }
    let is_far = |e: &&Estimate| (e.value / e.parameter.of(search.nominal)).ln().abs() > NO_SUCH;
    if let Some(far) = estimates.iter().find(is_far) {
        return Err(CalibrateError::NoSuch(far.parameter, far.value));
    }
    Ok(Calibrated { params, estimates, not_told, misfits })
}

/// The problem: a machine of this kind, near the nominal one, that reproduces the measurements.
struct Search<'m> {
    machine: Machine,
    nominal: &'m Params,
    measurements: &'m [Measurement],
    sought: &'m [Parameter],
}

impl Search<'_> {
    /// Excess of the model in uncertainties, a row for each measurement.
    fn differences(&self, params: &Params) -> Result<DVector<f64>, NotHeld> {
        let one = |m: &Measurement| {
            let says = m.figure.predict(self.machine, params)?;
            Ok((says / m.measured).ln() / m.uncertainty)
        };
        let all: Vec<f64> = self.measurements.iter().map(one).collect::<Result<_, _>>()?;
        Ok(DVector::from_vec(all))
    }

    /// Their derivatives by each parameter's logarithm, a column for each.
    fn slopes(&self, params: &Params) -> Result<DMatrix<f64>, NotHeld> {
        let mut slopes = DMatrix::zeros(self.measurements.len(), self.sought.len());
        for (column, parameter) in self.sought.iter().enumerate() {
            let probed = |by: f64| self.differences(&parameter.with(parameter.of(params) * by.exp(), params));
            slopes.set_column(column, &((probed(PROBE)? - probed(-PROBE)?) / (2.0 * PROBE)));
        }
        Ok(slopes)
    }

    /// Assumed uncertainty of a nominal value.
    fn assumed_uncertainty(&self, parameter: Parameter) -> f64 {
        let is_belt_weighed = self.measurements.iter().any(|m| matches!(m.figure, Figure::BeltMass));
        parameter.assumed_uncertainty(is_belt_weighed)
    }

    /// The weights of the nominal values.
    fn weights(&self) -> DVector<f64> {
        DVector::from_iterator(self.sought.len(), self.sought.iter().map(|p| self.assumed_uncertainty(*p).powi(-2)))
    }

    /// Matrix of the normal equations. The weights keep it positive definite.
    fn normal(&self, slopes: &DMatrix<f64>) -> Result<Cholesky<f64, Dyn>, CalibrateError> {
        let matrix = slopes.transpose() * slopes + DMatrix::from_diagonal(&self.weights());
        matrix.cholesky().ok_or(CalibrateError::NoMachine)
    }

    /// The machine with the least sum of squares.
    fn run(&self) -> Result<Params, CalibrateError> {
        let mut found = self.nominal.clone();
        for _ in 0..ROUNDS {
            let slopes = self.slopes(&found)?;
            let gone = self.sought.iter().map(|p| (p.of(&found) / p.of(self.nominal)).ln());
            let gone = DVector::from_iterator(self.sought.len(), gone);
            let slope = slopes.transpose() * self.differences(&found)? + self.weights().component_mul(&gone);
            let step = self.normal(&slopes)?.solve(&slope);
            let goes = gone - step.map(|by| by.clamp(-LONGEST_STEP, LONGEST_STEP));
            if goes.amax() > FURTHEST {
                return Err(CalibrateError::NoMachine);
            }
            for (parameter, way) in self.sought.iter().zip(goes.iter()) {
                found = parameter.with(parameter.of(self.nominal) * way.exp(), &found);
            }
            if step.amax() < CLOSE {
                return Ok(found);
            }
        }
        Err(CalibrateError::NoMachine)
    }
}
