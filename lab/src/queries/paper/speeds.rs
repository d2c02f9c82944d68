//! Speeds: the motors' and the tool's, by the paper's equations 2 and 9.
//!
//! The paper differentiates its equations for places. Here equation 9 comes from the whole system of displacements
//! (equations 4 to 7), which holds for speeds as well: its solution for a given tool and a given pulley 13 has the
//! motors.

use corehbot_twin::model::displacements::displacements;
use corehbot_twin::model::ways::Ways;
use corehbot_twin::params::Params;
use corehbot_twin::routing::Machine;
use nalgebra::{DMatrix, DVector};

/// Numbers of the driven pulleys of a CoreH-bot.
pub const MOTORS: [usize; 4] = [1, 4, 8, 11];

/// The pulley on the head by whose speed the paper counts how fast the belt runs round.
const ON_HEAD: usize = 13;

/// Columns of the head's x and y in the system.
const HEAD: [usize; 2] = [4, 5];

/// Smaller singular values count as zero: the system has one equation that follows from the others.
const DEPENDENT: f64 = 1e-9;

/// A motion of the head, with the belt running round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Speed of pulley 13 in rad/s, counter-clockwise.
    pub pulley_rad_per_s: f64,
    /// Speed of the head in mm/s.
    pub head_mm_per_s: [f64; 2],
}

impl Motion {
    /// Equation 9 as printed: M times the motion, in rad/s, for pulleys of one radius.
    #[must_use]
    pub fn printed(self, radius_mm: f64) -> [f64; 4] {
        let [x, y] = self.head_mm_per_s;
        [[-1.0, -1.0], [-1.0, -3.0], [1.0, -3.0], [1.0, -1.0]]
            .map(|[of_x, of_y]| -self.pulley_rad_per_s + (of_x * x + of_y * y) / radius_mm)
    }

    /// The motors' speeds in rad/s by the system of displacements; not a number if it has no solution.
    #[must_use]
    pub fn of_motors(self, params: &Params) -> [f64; 4] {
        let radius_mm = params.pulley_radius_mm;
        // dx, dy and r dtheta of each pulley stand behind the three blocks' dx and dy.
        let turn = |pulley: usize| 6 + 3 * (pulley - 1) + 2;
        let [x, y] = self.head_mm_per_s;
        let given = [(HEAD[0], x), (HEAD[1], y), (turn(ON_HEAD), radius_mm * self.pulley_rad_per_s)];
        let system = displacements(Machine::CoreHBot, params);
        let (equations, unknowns) = system.shape();
        let mut rows = DMatrix::zeros(equations + given.len(), unknowns);
        rows.view_mut((0, 0), (equations, unknowns)).copy_from(&system);
        let mut right = DVector::zeros(equations + given.len());
        for (row, (column, value)) in (equations..).zip(given) {
            rows[(row, column)] = 1.0;
            right[row] = value;
        }
        let solved = rows.svd(true, true).solve(&right, DEPENDENT);
        MOTORS.map(|motor| {
            solved.as_ref().ok().and_then(|all| all.get(turn(motor))).map_or(f64::NAN, |mm| mm / radius_mm)
        })
    }
}

/// Speed of the tool in mm/s by the routing of a machine with two motors (equation 2), for the motors' speeds in rad/s.
#[must_use]
pub fn of_tool(machine: Machine, params: &Params, motors_rad_per_s: [f64; 2]) -> [f64; 2] {
    let belts = motors_rad_per_s.map(|speed| params.pulley_radius_mm * speed);
    let [x, y, _] = Ways::new(machine, params).tool(&belts);
    [x, y]
}
