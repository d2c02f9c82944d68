//! Ways: travel of each motor per millimetre of the tool, with a rigid belt.
//!
//! Spans keep their lengths if A p + B u = 0, with tool travel p and motor travel u. The smallest solution u is taken:
//! the circulation of a closed belt moves nothing else.

use super::coordinate::Coordinate;
use super::links::Links;
use crate::math::hypot;
use crate::params::Params;
use crate::routing::{Machine, Place};
use nalgebra::{DMatrix, DVector};

/// Smaller singular values count as zero: entries are -2 to 2, and the others of these machines are above 1.
const NO_WAY: f64 = 1e-6;

/// Motor travel of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Ways {
    /// Numbers of the motors, ascending.
    pub motors: Vec<u8>,
    /// Belt in mm per millimetre of x, of y and, where belts lift the tool, of z, motor by motor.
    pub rows: Vec<[f64; 3]>,
}

impl Ways {
    /// From the routing; the same for every place of the tool.
    #[must_use]
    pub fn new(machine: Machine, params: &Params) -> Self {
        let middle = Place::of_xyz([params.width_mm, params.depth_mm, params.height_mm].map(|length| length / 2.0));
        let spans = Links::spans(machine, params, middle);
        let motors = machine.motors();
        let column = |coordinate: Coordinate| {
            let index = spans.index(coordinate);
            let entry = |link: &super::links::Link| index.and_then(|i| link.row.get(i)).copied().unwrap_or(0.0);
            DVector::from_iterator(spans.links.len(), spans.links.iter().map(entry))
        };
        let turns: Vec<_> = motors.iter().map(|number| column(Coordinate::Motor(*number))).collect();
        let inverse = DMatrix::from_columns(&turns).pseudo_inverse(NO_WAY).unwrap_or_default();
        let [x, y, z] = Coordinate::TOOL.map(|axis| -(&inverse * column(axis)));
        let rows = x.iter().zip(&y).zip(&z).map(|((x, y), z)| [*x, *y, *z]).collect();
        Self { motors, rows }
    }

    /// The tool's displacement for this motor travel, nearest to all motors.
    #[must_use]
    pub fn tool(&self, turned_mm: &[f64]) -> [f64; 3] {
        let axis = |axis: usize| self.rows.iter().map(move |row| row[axis]);
        let dot = |a: usize, b: usize| axis(a).zip(axis(b)).map(|(a, b)| a * b).sum::<f64>();
        let along = [0, 1, 2].map(|a| axis(a).zip(turned_mm).map(|(way, turned)| way * turned).sum::<f64>());
        let squares = [dot(0, 0), dot(1, 1), dot(2, 2)];
        let mixed = [dot(0, 1), dot(0, 2), dot(1, 2)];
        if mixed.iter().all(|mixed| mixed.abs() < NO_WAY) {
            // Each column is projected separately. An axis that no belt moves has none.
            return [0, 1, 2].map(|i| if squares[i] < NO_WAY { 0.0 } else { along[i] / squares[i] });
        }
        let [[xx, yy, zz], [xy, xz, yz]] = [squares, mixed];
        // An axis without belts stands for itself.
        let zz = if zz < NO_WAY { 1.0 } else { zz };
        let normal = nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let solved = normal.lu().solve(&nalgebra::Vector3::from(along)).unwrap_or_default();
        [solved[0], solved[1], solved[2]]
    }

    /// The paper's bound of the tool's error for an angular error of every motor (equations 22 to 25), in mm. It is the
    /// largest over all errors that a rigid belt allows, each motor with its own radius.
    ///
    /// It is at a corner of what is allowed: all motors are off by as much as they can be, but as many as there are
    /// residuals, which follow from the others.
    #[must_use]
    pub fn greatest_error_mm(&self, machine: Machine, params: &Params, error_rad: f64) -> f64 {
        let motors = self.motors.len();
        let most: Vec<f64> = (0..motors).map(|motor| params.radius_mm(motor) * error_rad).collect();
        let residuals = machine.residuals();
        let (bits, has) = (0..1_u32 << motors, |set: u32, motor: usize| set >> motor & 1 == 1);
        let mut greatest = 0.0_f64;
        for free in bits.clone().filter(|set| set.count_ones() as usize == residuals.len()) {
            let following: Vec<usize> = (0..motors).filter(|motor| has(free, *motor)).collect();
            let of = |pattern: usize, motor: usize| {
                residuals.get(pattern).and_then(|p| p.get(motor)).copied().unwrap_or(0.0)
            };
            let own = DMatrix::from_fn(residuals.len(), residuals.len(), |i, j| {
                of(i, following.get(j).copied().unwrap_or(0))
            });
            let Some(inverse) = own.try_inverse() else { continue };
            for signs in bits.clone().filter(|signs| signs & free == 0) {
                let fixed = |motor: usize| if has(signs, motor) { 1.0 } else { -1.0 };
                let mut turned: Vec<f64> =
                    most.iter().enumerate().map(|(i, most)| if has(free, i) { 0.0 } else { most * fixed(i) }).collect();
                let rest = |pattern: &Vec<f64>| -pattern.iter().zip(&turned).map(|(p, t)| p * t).sum::<f64>();
                let follows = &inverse * DVector::from_iterator(residuals.len(), residuals.iter().map(rest));
                for (motor, mm) in following.iter().zip(follows.iter()) {
                    if let Some(turned) = turned.get_mut(*motor) {
                        *turned = *mm;
                    }
                }
                if turned.iter().zip(&most).all(|(mm, most)| mm.abs() <= most * (1.0 + NO_WAY)) {
                    let [x, y, z] = self.tool(&turned);
                    greatest = greatest.max(hypot(hypot(x, y), z));
                }
            }
        }
        greatest
    }
}

/// Residual of this motor travel in mm: the part that a rigid belt cannot follow. `None` on a machine without one; the
/// larger one where there are two.
#[must_use]
pub fn residual_mm(machine: Machine, turned_mm: &[f64]) -> Option<f64> {
    let residual = |pattern: &Vec<f64>| pattern.iter().zip(turned_mm).map(|(p, t)| p * t).sum::<f64>();
    machine.residuals().iter().map(residual).max_by(|a, b| a.abs().total_cmp(&b.abs()))
}
