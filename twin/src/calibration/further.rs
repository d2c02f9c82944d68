//! Further: the measurements that would help most next.
//!
//! A measurement with slopes j and uncertainty 1 changes the covariance C to `C - C j j^T C / (1 + j^T C j)`, whatever
//! it says. So its help is known before: the part of all variance (of the logarithms) that it removes. Variances
//! of numbers that are right within a factor of two are alike.

use super::error::CalibrateError;
use super::figure::{Direction, Figure, Measurement, Weighed};
use super::parameter::{Parameter, Unknown};
use super::search::Search;
use crate::geometry::workspace;
use crate::params::Params;
use crate::routing::{Machine, Place};
use nalgebra::DMatrix;
use serde::Serialize;

/// A measurement that would help.
#[derive(Clone, Debug, PartialEq)]
pub struct Further {
    /// The measurement.
    pub figure: Figure,
    /// Part of the remaining variance that it would remove, of 1.
    pub removes: f64,
    /// The numbers that become better known, the most changed first.
    pub improves: Vec<Improved>,
}

/// A number that would be better known.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Improved {
    /// The parameter.
    pub parameter: Parameter,
    /// The belt, from 1, where each has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub belt: Option<usize>,
    /// The number itself.
    #[serde(skip)]
    pub unknown: Unknown,
    /// Relative standard uncertainty now, of 1.
    pub now: f64,
    /// The same after the measurement.
    pub then: f64,
}

/// So many are named.
const NAMED: usize = 3;

/// A number counts as improved if its uncertainty falls below this part.
const IMPROVED: f64 = 0.9;

/// Length of a part that is plucked, of a lever, and a force, as docs/research/twin.md has them.
const PLUCKED_MM: f64 = 380.0;
const LEVER_MM: f64 = 100.0;
const FORCE_N: f64 = 20.0;

/// How far from the end of the reach a place near the end is, in mm.
const FROM_END_MM: f64 = 20.0;

/// All measurements that are possible on a machine, each by its usual method.
fn possible(machine: Machine, params: &Params) -> Vec<Figure> {
    let reach = workspace(machine, params);
    let middle = reach.centre();
    let corner = reach.at(reach.x[0] + FROM_END_MM, reach.y[0] + FROM_END_MM);
    let side = reach.at(reach.x[0] + FROM_END_MM, middle.y);
    let places: [Place; 2] = [middle, corner];
    let belts = machine.belts().len();
    let weights = [Weighed::Head, Weighed::Bar, Weighed::Gantry, Weighed::Bed].map(Figure::Weight);
    let plucks = (0..belts).map(|belt| Figure::Pluck { length_mm: PLUCKED_MM, belt });
    let both = [Direction::X, Direction::Y];
    let pushes = both.map(|along| Figure::Deflection { at: middle, along, force_n: FORCE_N });
    let beside = Figure::Deflection { at: side, along: Direction::Y, force_n: FORCE_N };
    let diagonals = [false, true].map(|rises| Figure::Diagonal { at: middle, rises, force_n: FORCE_N });
    let rings = places.into_iter().flat_map(|at| both.map(|along| Figure::Ring { at, along }));
    let yaws = [middle, side].map(|at| Figure::YawRing { at });
    let dampings = both.map(|along| Figure::Damping { at: middle, along });
    let skew = (belts > 1).then_some(Figure::Skew { at: middle });
    let slip = Figure::Slip { lever_mm: LEVER_MM };
    let all = weights.into_iter().chain([Figure::BeltMass, slip]).chain(plucks).chain(pushes).chain([beside]);
    all.chain(diagonals).chain(rings).chain(yaws).chain(dampings).chain(skew).collect()
}

/// The most helpful measurements, given the covariance of the unknowns of a machine.
///
/// # Errors
/// Nothing holds the machine.
pub(super) fn further(
    search: &Search,
    params: &Params,
    covariance: &DMatrix<f64>,
) -> Result<Vec<Further>, CalibrateError> {
    let figures = possible(search.machine, params);
    let measurement = |figure: &Figure| Measurement {
        figure: *figure,
        // Slopes do not depend on the outcome.
        measured: 1.0,
        uncertainty: figure.usual_uncertainty(),
    };
    let measurements: Vec<Measurement> = figures.iter().map(measurement).collect();
    let slopes = Search { measurements: &measurements, ..*search }.slopes_at(params)?;
    let all = covariance.trace();
    let one = |(figure, slope): (&Figure, nalgebra::RowDVector<f64>)| {
        let spreads = covariance * slope.transpose();
        let norm = 1.0 + (&slope * &spreads)[0];
        let improved = |(i, unknown): (usize, &Unknown)| {
            let now = covariance[(i, i)].sqrt();
            let then = (covariance[(i, i)] - spreads[i] * spreads[i] / norm).max(0.0).sqrt();
            Improved {
                parameter: unknown.parameter,
                belt: (unknown.parts > 1).then_some(unknown.part + 1),
                unknown: *unknown,
                now,
                then,
            }
        };
        let mut improves: Vec<Improved> = search.sought.iter().enumerate().map(improved).collect();
        improves.retain(|number| number.then < IMPROVED * number.now);
        improves.sort_by(|a, b| (a.then / a.now).total_cmp(&(b.then / b.now)));
        Further { figure: *figure, removes: spreads.norm_squared() / norm / all, improves }
    };
    let rows = slopes.row_iter().map(|row| row.into_owned());
    let mut found: Vec<Further> = figures.iter().zip(rows).map(one).collect();
    // Without any damping nothing is learned from one.
    found.retain(|further| further.removes.is_finite() && !further.improves.is_empty());
    found.sort_by(|a, b| b.removes.total_cmp(&a.removes));
    found.truncate(NAMED);
    Ok(found)
}
