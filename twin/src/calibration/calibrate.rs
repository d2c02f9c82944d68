//! Calibrate: the numbers with which the model measures as the machine did.
//!
//! Unknown are the logarithms of parameters, as all are above 0 and their uncertainties are parts of them. With r the
//! differences of the figures' logarithms over their uncertainties and J what each parameter does to them, a round goes by
//! `-(J^T J)^-1 J^T r` (Gauss and Newton). The inverse is taken by eigenvectors of `J^T J`: the root of an eigenvalue says how
//! many uncertainties a change along its vector makes, so a small one is a combination that the figures do not tell. At the
//! end `(J^T J)^-1` is the covariance of the logarithms (Aster, Borchers and Thurber, Parameter Estimation and Inverse
//! Problems, chapter on nonlinear regression).

use super::figure::Measurement;
use super::parameter::Parameter;
use crate::params::Params;
use crate::routing::Machine;
use crate::solve::NotHeld;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::Serialize;

/// A machine that measures as it was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// All its numbers.
    pub params: Params,
    /// Those that were told.
    pub estimates: Vec<Estimate>,
    /// Those on which the figures hardly depend: they are what they were.
    pub not_told: Vec<Parameter>,
    /// What is left of each measurement's difference, in their order.
    pub misfits: Vec<Misfit>,
}

/// A number that was told.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Which.
    pub parameter: Parameter,
    /// What it is.
    pub value: f64,
    /// Its standard uncertainty as a part of it, of 1, from those of the measurements.
    pub uncertainty: f64,
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
    /// Changing these parameters together changes no figure by more than its uncertainty.
    Undetermined(Vec<Parameter>),
    /// No machine within a hundredfold of the one that the search began with measures like this.
    NoMachine,
    /// Nothing holds the machine.
    NotHeld(NotHeld),
}

impl std::fmt::Display for CalibrateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Nothing => f.write_str("nothing was measured that depends on a parameter that is sought"),
            Self::Undetermined(parameters) => {
                let keys: Vec<&str> = parameters.iter().map(|parameter| parameter.key()).collect();
                let part = 100.0 * MOST_UNCERTAIN;
                write!(f, "these measurements do not determine {}: ", keys.join(" and "))?;
                let together = if keys.len() > 1 { "together " } else { "" };
                write!(f, "{part:.0} % {together}would change the figures by less than their uncertainties; ")?;
                f.write_str("measure something else that depends on it, or name one in `fixed`")
            }
            Self::NoMachine => f.write_str("no machine within a hundredfold of the nominal numbers measures like this"),
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

/// A combination that would be known to this part only (as a logarithm) is not told by the measurements.
const MOST_UNCERTAIN: f64 = 0.5;

/// A parameter that has at least this part in such a combination is named.
const NAMED: f64 = 0.05;

/// Rounds of the search; it ends in a few.
const ROUNDS: usize = 60;

/// A parameter is changed by this part to see what follows; the error of central differences goes with its square.
const PROBE: f64 = 1e-4;

/// A parameter changes by no more than this factor in a round (as a logarithm).
const LONGEST_STEP: f64 = 0.7;

/// Nor by more than a hundredfold in all (as a logarithm).
const FURTHEST: f64 = 4.605;

/// Eigenvalues below this part of the greatest are rounding.
const ROUNDING: f64 = 1e-12;

/// The search ends where it changes nothing by this (as a logarithm).
const CLOSE: f64 = 1e-9;

/// Begins at `params` and seeks all parameters that measurements depend on, but for the `fixed` ones.
///
/// # Errors
/// The measurements do not determine the parameters, or no machine measures like this.
pub fn calibrate(
    machine: Machine,
    params: &Params,
    measurements: &[Measurement],
    fixed: &[Parameter],
) -> Result<Calibrated, CalibrateError> {
    let sought: Vec<Parameter> = Parameter::ALL.into_iter().filter(|parameter| !fixed.contains(parameter)).collect();
    let search = Search { machine, measurements };
    let slopes = search.slopes(params, &sought)?;
    let is_told = |column: usize| slopes.column(column).norm() > 1.0 / MOST_UNCERTAIN;
    let (told, not_told): (Vec<_>, Vec<_>) = sought.iter().enumerate().partition(|(column, _)| is_told(*column));
    let [told, not_told] = [told, not_told].map(|some| some.into_iter().map(|(_, p)| *p).collect::<Vec<_>>());
    if told.is_empty() {
        return Err(CalibrateError::Nothing);
    }
    let (params, is_found) = search.run(params, &told)?;
    let inverse = Inverse::new(&search.slopes(&params, &told)?);
    let undetermined = inverse.undetermined();
    if !undetermined.is_empty() {
        let named = undetermined.into_iter().filter_map(|i| told.get(i)).copied();
        return Err(CalibrateError::Undetermined(named.collect()));
    }
    if !is_found {
        return Err(CalibrateError::NoMachine);
    }
    let estimate = |(i, parameter): (usize, &Parameter)| Estimate {
        parameter: *parameter,
        value: parameter.of(&params),
        uncertainty: inverse.variance(i).sqrt(),
    };
    let estimates = told.iter().enumerate().map(estimate).collect();
    let left = search.differences(&params)?;
    let misfit = |(m, r): (&Measurement, &f64)| Misfit { part: (r * m.uncertainty).exp_m1(), uncertainties: *r };
    let misfits = measurements.iter().zip(left.iter()).map(misfit).collect();
    Ok(Calibrated { params, estimates, not_told, misfits })
}

/// What is looked for: a machine of this kind that measures like this.
struct Search<'m> {
    machine: Machine,
    measurements: &'m [Measurement],
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
    fn slopes(&self, params: &Params, parameters: &[Parameter]) -> Result<DMatrix<f64>, NotHeld> {
        let mut slopes = DMatrix::zeros(self.measurements.len(), parameters.len());
        for (column, parameter) in parameters.iter().enumerate() {
            let probed = |by: f64| self.differences(&parameter.with(parameter.of(params) * by.exp(), params));
            slopes.set_column(column, &((probed(PROBE)? - probed(-PROBE)?) / (2.0 * PROBE)));
        }
        Ok(slopes)
    }

    /// The machine with the least squares, and whether the search ended there.
    fn run(&self, params: &Params, parameters: &[Parameter]) -> Result<(Params, bool), NotHeld> {
        let mut found = params.clone();
        for _ in 0..ROUNDS {
            let slopes = self.slopes(&found, parameters)?;
            let step = Inverse::new(&slopes).times(&(slopes.transpose() * self.differences(&found)?));
            let mut furthest = 0.0_f64;
            for (parameter, step) in parameters.iter().zip(step.iter()) {
                let gone = (parameter.of(&found) / parameter.of(params)).ln();
                let goes = gone - step.clamp(-LONGEST_STEP, LONGEST_STEP);
                if goes.abs() > FURTHEST {
                    return Ok((found, false));
                }
                furthest = furthest.max(step.abs());
                found = parameter.with(parameter.of(params) * goes.exp(), &found);
            }
            if furthest < CLOSE {
                return Ok((found, true));
            }
        }
        Ok((found, false))
    }
}

/// The inverse of `J^T J` where it has one.
struct Inverse(SymmetricEigen<f64, nalgebra::Dyn>);

impl Inverse {
    fn new(slopes: &DMatrix<f64>) -> Self {
        Self((slopes.transpose() * slopes).symmetric_eigen())
    }

    /// Eigenvalues and vectors without those that are rounding.
    fn parts(&self) -> impl Iterator<Item = (f64, DVector<f64>)> {
        let least = ROUNDING * self.0.eigenvalues.max();
        let all = self.0.eigenvalues.iter().zip(self.0.eigenvectors.column_iter());
        all.filter(move |(value, _)| **value > least).map(|(value, vector)| (*value, vector.into_owned()))
    }

    fn times(&self, vector: &DVector<f64>) -> DVector<f64> {
        let zero = DVector::zeros(vector.len());
        self.parts().fold(zero, |sum, (value, along)| sum + &along * (along.dot(vector) / value))
    }

    /// The variance of a parameter's logarithm.
    fn variance(&self, parameter: usize) -> f64 {
        self.parts().map(|(value, along)| along.get(parameter).map_or(0.0, |a| a * a) / value).sum()
    }

    /// The parameters of which combinations are not told.
    fn undetermined(&self) -> Vec<usize> {
        let least = MOST_UNCERTAIN.powi(-2);
        let all = self.0.eigenvalues.iter().zip(self.0.eigenvectors.column_iter());
        let weak: Vec<_> = all.filter(|(value, _)| **value < least).map(|(_, vector)| vector).collect();
        let has_part = |i: &usize| weak.iter().any(|vector| vector.get(*i).is_some_and(|part| part.abs() > NAMED));
        (0..self.0.eigenvalues.len()).filter(has_part).collect()
    }
}
