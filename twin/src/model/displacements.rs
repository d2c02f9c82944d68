//! Displacements: the system by which the CoreH-bot paper counts degrees of freedom (equations 4 to 7).
//!
//! Every block, pulley and piece of belt has its own displacements, and each constraint is an equation: 60 in 62
//! unknowns for the CoreH-bot. One equation follows from the others, so there are three degrees of freedom, not two: x,
//! y, and the belt's circulation.
//!
//! The piece of belt between two pulleys moves along its axis. If it travels with the axis, dl = dP + s r dtheta; if
//! against it, dl = dP - s r dtheta. The paper's second example of equation 6 has the wrong sign for an angle that is
//! positive counter-clockwise: pulley 2 lies on the outside, and dl1 = dy2 - r2 dtheta2.

use crate::geometry::layout;
use crate::params::Params;
use crate::routing::{Block, Machine, Place, Stop};
use nalgebra::DMatrix;

/// Displacements of frame, bar and head.
const BLOCKS: usize = 6;

/// Displacements and angle of a pulley.
const A_PULLEY: usize = 3;

/// The coefficients of a machine with closed belts only, one row per equation. Columns are dx and dy of frame, bar and
/// head, dx, dy and r dtheta of each pulley, and the displacement of each piece of belt.
#[must_use]
pub fn displacements(machine: Machine, params: &Params) -> DMatrix<f64> {
    let middle = Place::flat(params.width_mm / 2.0, params.depth_mm / 2.0);
    let stops = machine.stops();
    let segments = layout(machine, params, middle).segments;
    let unknowns = BLOCKS + A_PULLEY * stops.len() + segments.len();
    let mut equations: Vec<Vec<(usize, f64)>> = blocks();
    for (index, stop) in stops.iter().enumerate() {
        let block = 2 * block_index(stop);
        let pulley = BLOCKS + A_PULLEY * index;
        equations.extend([0, 1].map(|axis| vec![(pulley + axis, 1.0), (block + axis, -1.0)]));
    }
    for (piece, segment) in segments.iter().enumerate() {
        let node = BLOCKS + A_PULLEY * stops.len() + piece;
        let axis = usize::from(segment.heading[0].abs() < segment.heading[1].abs());
        let with_axis = segment.heading.get(axis).map_or(0.0, |h| h.signum());
        for index in [segment.from, segment.to] {
            let sign = stops.get(index).map_or(0.0, |stop| stop.sign());
            let pulley = BLOCKS + A_PULLEY * index;
            equations.push(vec![(node, 1.0), (pulley + axis, -1.0), (pulley + 2, -with_axis * sign)]);
        }
    }
    let mut matrix = DMatrix::zeros(equations.len(), unknowns);
    for (row, equation) in equations.iter().enumerate() {
        for (column, coefficient) in equation {
            matrix[(row, *column)] = *coefficient;
        }
    }
    matrix
}

/// Equation 4: the frame is fixed, the bar moves along y, the head along the bar.
fn blocks() -> Vec<Vec<(usize, f64)>> {
    vec![vec![(0, 1.0)], vec![(1, 1.0)], vec![(0, 1.0), (2, -1.0)], vec![(3, 1.0), (5, -1.0)]]
}

fn block_index(stop: &Stop) -> usize {
    match stop.block() {
        Block::Frame => 0,
        Block::Bar => 1,
        Block::Head => 2,
    }
}
