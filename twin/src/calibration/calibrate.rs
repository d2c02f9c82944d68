//! Calibrate: the numbers with which the model measures as the machine did.
//!
//! Unknown are the logarithms of parameters, as all are above 0 and their uncertainties are parts of them. Each nominal value
//! counts as one more measurement, with the uncertainty that is assumed of it: so a parameter that the figures hardly tell
//! makes the others uncertain by what it does to them, and worse figures never tell more. With r the differences of the
//! figures' logarithms over their uncertainties, J what each parameter does to them, p the parameters' ways from their nominal
//! values and W the inverse squares of the assumed uncertainties, a round goes by `-(J^T J + W)^-1 (J^T r + W p)` (Gauss and
//! Newton). At the end `(J^T J + W)^-1` is the covariance of the logarithms (Tarantola, Inverse Problem Theory, chapter on
//! least squares).

use super::figure::{Figure, Measurement};
use super::parameter::Parameter;
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::Serialize;

/// A machine that measures as it was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// All its numbers; together they measure as the machine did, also those that were not told.
    pub params: Params,
    /// Those that were told.
    pub estimates: Vec<Estimate>,
    /// Those that are hardly better known than before.
    pub not_told: Vec<Estimate>,
    /// What is left of each measurement's difference, in their order.
    pub misfits: Vec<Misfit>,
}

/// A number that was sought.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Which.
    pub parameter: Parameter,
    /// What it is.
    pub value: f64,
    /// Its standard uncertainty as a part of it, of 1 (of its logarithm), from those of the measurements and nominal values.
    pub uncertainty: f64,
    /// What was assumed of its nominal value before.
    pub assumed_uncertainty: f64,
}

/// How far the model is from a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Misfit {
    /// By what part the model says more, of 1.
    pub part: f64,
    /// The same in uncertainties of the measurement.
    pub uncertainties: f64,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrateError {
    /// Nothing was measured that depends much on what is sought.
    Nothing,
    /// The figures depend on these parameters, but tell none.
    Undetermined(Vec<Parameter>),
    /// No machine within a hundredfold of the one that the search began with measures like this.
    NoMachine,
    /// The nearest machine is this far from each measurement, and too far from one.
    Unlike(Vec<Misfit>),
    /// The machine that measures like this has a number that none has.
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
                f.write_str("or give a nearer value by --params if the machine is like that")
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

/// A parameter is told if no more than this part of the uncertainty that was assumed of it is left (assumed: a third).
const TOLD: f64 = 1.0 / 3.0;

/// Figures depend on a parameter if they leave less than this part of it (assumed).
const DEPENDS: f64 = 0.95;

/// A measurement from which the nearest machine is further than this, in its uncertainties, was made of another machine, or not
/// as it should: one in two million is by chance.
const LIKE: f64 = 5.0;

/// A number that is told is within this factor of the nominal one, as a logarithm: ten, where a factor of two is assumed.
const NO_SUCH: f64 = 2.3;

/// Rounds of the search; it ends in a few.
const ROUNDS: usize = 60;

/// A parameter is changed by this part to see what follows; the error of central differences goes with its square.
const PROBE: f64 = 1e-4;

/// A parameter changes by no more than this factor in a round (as a logarithm).
const LONGEST_STEP: f64 = 0.7;

/// Nor by more than a hundredfold in all (as a logarithm).
const FURTHEST: f64 = 4.605;

/// The search ends where it changes nothing by this (as a logarithm).
const CLOSE: f64 = 1e-9;

/// Begins at `params` and seeks all parameters but for the `fixed` ones, which count as exact.
///
/// # Errors
/// The measurements do not determine a parameter, or no machine measures like this.
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

/// What is looked for: a machine of this kind, near the nominal one, that measures like this.
struct Search<'m> {
    machine: Machine,
    nominal: &'m Params,
    measurements: &'m [Measurement],
    sought: &'m [Parameter],
}

impl Search<'_> {
    /// By how many uncertainties the model says more, a row for each measurement.
    fn differences(&self, params: &Params) -> Result<DVector<f64>, NotHeld> {
        let one = |m: &Measurement| {
            let says = m.figure.predict(self.machine, params)?;
            Ok((says / m.measured).ln() / m.uncertainty)
        };
        let all: Vec<f64> = self.measurements.iter().map(one).collect::<Result<_, _>>()?;
        Ok(DVector::from_vec(all))
    }

    /// What each parameter's logarithm does to them, a column for each.
    fn slopes(&self, params: &Params) -> Result<DMatrix<f64>, NotHeld> {
        let mut slopes = DMatrix::zeros(self.measurements.len(), self.sought.len());
        for (column, parameter) in self.sought.iter().enumerate() {
            let probed = |by: f64| self.differences(&parameter.with(parameter.of(params) * by.exp(), params));
            slopes.set_column(column, &((probed(PROBE)? - probed(-PROBE)?) / (2.0 * PROBE)));
        }
        Ok(slopes)
    }

    /// What is assumed of a nominal value.
    fn assumed_uncertainty(&self, parameter: Parameter) -> f64 {
        let is_belt_weighed = self.measurements.iter().any(|m| matches!(m.figure, Figure::BeltMass));
        parameter.assumed_uncertainty(is_belt_weighed)
    }

    /// The weights of the nominal values.
    fn weights(&self) -> DVector<f64> {
        DVector::from_iterator(self.sought.len(), self.sought.iter().map(|p| self.assumed_uncertainty(*p).powi(-2)))
    }

    /// The normal equations' matrix, which the weights keep positive definite.
    fn normal(&self, slopes: &DMatrix<f64>) -> Result<Cholesky<f64, Dyn>, CalibrateError> {
        let matrix = slopes.transpose() * slopes + DMatrix::from_diagonal(&self.weights());
        matrix.cholesky().ok_or(CalibrateError::NoMachine)
    }

    /// The machine with the least squares.
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
