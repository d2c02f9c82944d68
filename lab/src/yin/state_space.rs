//! State space, equation 9 of the paper: the linear part of a model, without Coulomb friction, as matrices.
//!
//! chi' = A chi + B u, psi = C chi, with chi = (x, x', y, y', phi3, phi3', ...), u = (phi1, phi2) and psi = (x, y).
//! With DC motors phi1, phi1', phi2, phi2' stand after y', and u = (V1, V2). Places are in m and angles in rad, as in
//! the paper.

use super::belt::{X, Y, pulley};
use super::model::Model;
use super::parameters::Parameters;
use super::system::{Row, System};
use nalgebra::DMatrix;
use serde::Serialize;
use std::fmt;

/// The motors' side of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Angles of the motors, rad: steppers.
    Angles,
    /// Voltages, V: DC motors without a controller (equations 10 and 16).
    Volts,
}

/// Matrices in m, rad, s and V, and the poles.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateSpace {
    /// Names of the states, in order.
    pub states: Vec<String>,
    /// Names of the inputs.
    pub inputs: [&'static str; 2],
    /// A, row by row.
    #[serde(rename = "A")]
    pub a: Vec<Vec<f64>>,
    /// B, row by row.
    #[serde(rename = "B")]
    pub b: Vec<[f64; 2]>,
    /// C, row by row.
    #[serde(rename = "C")]
    pub c: [Vec<f64>; 2],
    /// Eigenvalues of A, real and imaginary part in 1/s, the slowest first.
    pub poles_per_s: Vec<[f64; 2]>,
}

impl StateSpace {
    /// The matrices of a model.
    #[must_use]
    pub fn new(model: Model, rig: &Parameters, input: Input) -> StateSpace {
        let system = match input {
            Input::Angles => System::stepper(model, rig),
            Input::Volts => System::dc(model, rig),
        };
        let r = rig.pulley_radius;
        // What one unit of a coordinate is in m.
        let unit = |coordinate: usize| if coordinate == X || coordinate == Y { 1.0 } else { r };
        let travel = if input == Input::Angles { r } else { 1.0 };
        let rows = &system.rows;
        let size = 2 * rows.len();
        let (mut a, mut b) = (DMatrix::<f64>::zeros(size, size), vec![[0.0; 2]; size]);
        for (i, row) in rows.iter().enumerate() {
            let place = |coordinate: usize| 2 * rows.iter().take_while(|other| other.coordinate != coordinate).count();
            a[(2 * i, 2 * i + 1)] = 1.0;
            a[(2 * i + 1, 2 * i + 1)] = -row.viscous / row.mass;
            for &(other, k) in &row.springs {
                a[(2 * i + 1, place(other))] = -k * unit(other) / (row.mass * unit(row.coordinate));
            }
            if let Some(line) = b.get_mut(2 * i + 1) {
                *line = row.drive.map(|force| force * travel / (row.mass * unit(row.coordinate)));
            }
        }
        let mut poles: Vec<[f64; 2]> = a.complex_eigenvalues().iter().map(|pole| [pole.re, pole.im]).collect();
        poles.sort_by(|p, q| q[0].total_cmp(&p[0]).then(q[1].total_cmp(&p[1])));
        let one = |state: usize| (0..size).map(|i| if i == state { 1.0 } else { 0.0 }).collect();
        StateSpace {
            states: rows.iter().flat_map(names).collect(),
            inputs: if input == Input::Angles { ["phi1_rad", "phi2_rad"] } else { ["V1_V", "V2_V"] },
            a: a.row_iter().map(|row| row.iter().copied().collect()).collect(),
            b,
            // x and y are the first two coordinates of every model.
            c: [one(0), one(2)],
            poles_per_s: poles,
        }
    }
}

/// A coordinate and its derivative.
fn names(row: &Row) -> [String; 2] {
    match row.coordinate {
        X => ["x_m".to_owned(), "x'_m_s".to_owned()],
        Y => ["y_m".to_owned(), "y'_m_s".to_owned()],
        other => {
            let number = other - pulley(0);
            [format!("phi{number}_rad"), format!("phi{number}'_rad_s")]
        }
    }
}

impl fmt::Display for StateSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { states, inputs: [one, two], poles_per_s, .. } = self;
        writeln!(
            f,
            "equation 9: {} states ({}), inputs {one} and {two}, outputs x and y",
            states.len(),
            states.join(" ")
        )?;
        writeln!(f, "poles in 1/s, the slowest first (--json has A, B and C too)")?;
        for [real, imaginary] in poles_per_s {
            if *imaginary == 0.0 {
                writeln!(f, "{real:12.2}")?;
            } else if *imaginary > 0.0 {
                writeln!(f, "{real:12.2} +- {imaginary:.2} i")?;
            }
        }
        Ok(())
    }
}
