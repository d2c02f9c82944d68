//! Balance: the equilibrium under a force on the tool, or after motors have turned.
//!
//! The stiffness is divided into free and held coordinates: `K_ff q_f = F - K_fh q_h`. A motor held by its field is
//! free and pulled towards its commanded position. [`condensed`] is the same for a force on few coordinates: the
//! remaining stiffness when all others have deflected (Schur's complement; Guyan, AIAA Journal 3, 1965).

use super::NotHeld;
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, ElasticPart};
use crate::params::Params;
use nalgebra::{DMatrix, DVector};

/// A machine at rest under load, in changes from the machine at rest without.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// Displacement of each coordinate of the links.
    pub moved: Vec<f64>,
    /// Change of each link's tension, in N.
    pub tensions_n: Vec<f64>,
    /// Torque that each motor (ascending numbers) adds, counter-clockwise, in mN m.
    pub torques_mnm: Vec<f64>,
}

impl Balance {
    /// Displacement of a coordinate.
    #[must_use]
    pub fn of(&self, elastic: &Elastic, coordinate: Coordinate) -> f64 {
        elastic.links.index(coordinate).and_then(|i| self.moved.get(i)).copied().unwrap_or(0.0)
    }
}

/// Equilibrium with this force on the tool along x, y and z in N, and these motor movements in mm of belt.
///
/// # Errors
/// Nothing holds the machine.
pub fn balance(
    elastic: &Elastic,
    params: &Params,
    force_n: [f64; 3],
    sent_mm: &[(u8, f64)],
) -> Result<Balance, NotHeld> {
    let count = elastic.parts.len();
    let mut force = DVector::<f64>::zeros(count);
    let mut moved = DVector::<f64>::zeros(count);
    for (coordinate, f) in Coordinate::TOOL.into_iter().zip(force_n) {
        if let Some(at) = elastic.links.index(coordinate) {
            force[at] += f;
        }
    }
    for (number, sent) in sent_mm {
        let Some(at) = elastic.links.index(Coordinate::Motor(*number)) else { continue };
        match elastic.parts.get(at) {
            Some(ElasticPart::Held) => moved[at] = *sent,
            _ => force[at] += elastic.held_by.get(at).copied().unwrap_or(0.0) * sent,
        }
    }
    for (at, way) in settled(elastic, &(force - &elastic.stiffness * &moved))?.iter().enumerate() {
        moved[at] += way;
    }
    let moved: Vec<f64> = moved.iter().copied().collect();
    let tensions_n: Vec<f64> =
        elastic.links.links.iter().map(|link| link.stiffness(params) * link.stretch(&moved)).collect();
    let torques_mnm = torques(elastic, params, &tensions_n);
    Ok(Balance { moved, tensions_n, torques_mnm })
}

/// Displacement of each coordinate where the way of each link has become this much longer, in mm. Held motors stay.
///
/// # Errors
/// Nothing holds the machine.
pub fn settle(elastic: &Elastic, params: &Params, stretched_mm: &[f64]) -> Result<Vec<f64>, NotHeld> {
    let count = elastic.parts.len();
    let mut pull = DVector::<f64>::zeros(count);
    for (link, stretched) in elastic.links.links.iter().zip(stretched_mm) {
        pull -= DVector::from_column_slice(&link.row) * (link.stiffness(params) * stretched);
    }
    Ok(settled(elastic, &pull)?.iter().copied().collect())
}

/// Displacements of all coordinates under this force on each, in N (N mm on the yaw); held ones stay.
///
/// # Errors
/// Nothing holds the machine.
pub fn settled(elastic: &Elastic, force: &DVector<f64>) -> Result<DVector<f64>, NotHeld> {
    let free: Vec<usize> =
        (0..elastic.parts.len()).filter(|i| elastic.parts.get(*i) != Some(&ElasticPart::Held)).collect();
    let pull = DVector::from_iterator(free.len(), free.iter().map(|i| force[*i]));
    let gives = submatrix(&elastic.stiffness, &free, &free).cholesky().ok_or(NotHeld)?.solve(&pull);
    let mut moved = DVector::zeros(elastic.parts.len());
    for (at, way) in free.iter().zip(gives.iter()) {
        moved[*at] = *way;
    }
    Ok(moved)
}

/// Torque that motors must add against the belt, in mN m.
fn torques(elastic: &Elastic, params: &Params, tensions_n: &[f64]) -> Vec<f64> {
    let torque = |number: u8| {
        let at = elastic.links.index(Coordinate::Motor(number))?;
        let pulls = elastic.links.links.iter().zip(tensions_n);
        let force: f64 = pulls.map(|(link, tension)| link.row.get(at).copied().unwrap_or(0.0) * tension).sum();
        Some(force * params.radius_mm(elastic.machine.index_of(number)))
    };
    elastic.machine.motors().into_iter().map(|number| torque(number).unwrap_or(0.0)).collect()
}

/// Stiffness at the `kept` coordinates when all others that are not held deflect.
///
/// # Errors
/// Nothing holds the others.
pub fn condensed(elastic: &Elastic, kept: &[usize]) -> Result<DMatrix<f64>, NotHeld> {
    let gives = |i: &usize| elastic.parts.get(*i) != Some(&ElasticPart::Held) && !kept.contains(i);
    let others: Vec<usize> = (0..elastic.parts.len()).filter(gives).collect();
    let own = submatrix(&elastic.stiffness, kept, kept);
    if others.is_empty() {
        return Ok(own);
    }
    let between = submatrix(&elastic.stiffness, &others, kept);
    let solved = submatrix(&elastic.stiffness, &others, &others).cholesky().ok_or(NotHeld)?.solve(&between);
    Ok(own - between.transpose() * solved)
}

/// Some rows and columns of a matrix.
pub(super) fn submatrix(matrix: &DMatrix<f64>, rows: &[usize], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), columns.len(), |i, j| match (rows.get(i), columns.get(j)) {
        (Some(row), Some(column)) => matrix[(*row, *column)],
        _ => 0.0,
    })
}
