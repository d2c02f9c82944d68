//! A belt-driven CoreXY as Yin et al. model it: how far it rounds the corners of a square, and which parameters matter.
//!
//! M. Yin, Y. Chen, K.-H. Lee, D. K. C. Fu, Z. T. H. Tse, K.-W. Kwok, "Dynamic Modeling and Characterization of the
//! Core-XY Cartesian Motion System". Equation numbers here are from that paper. Some equations are misprinted there;
//! `docs/research/twin-yin.md` has the corrections. This room derives all of them from the potential energy,
//! equation 6.
//!
//! Units in this room are SI (m, kg, s, N), as in the paper; names of values in mm say so.
//!
//! ```text
//! parameters ─▶ belt (springs) ─▶ model (full or 4 DoF) ─▶ system (steppers or DC motors) ─▶ integrator ─▶ corner
//!                                                                    path (the square) ──────────┘
//! ```
//!
//! `damping` predicts how an axis behaves as a whole, `fit` finds the trends in results. [`figure`] computes figures 3
//! to 5 of the paper again, [`state_space`] has the matrices of equation 9.
//!
//! Figures depend on the input alone: time steps are fixed, chosen from the parameters, and there are no random
//! numbers.
mod belt;
mod corner;
mod damping;
mod error;
pub mod figure;
pub mod fit;
mod integrator;
mod model;
mod parameters;
mod path;
mod run;
pub mod state_space;
mod system;
#[cfg(test)]
mod tests;

pub use damping::{Axis, axes};
pub use error::Error;
pub use integrator::hold;
pub use model::Model;
pub use parameters::{DcMotor, NOMINAL, Parameters};
pub use path::{Command, Direction};
pub use run::{Case, Corners, FACTORS, GAINS, SPEEDS, run, run_on, scaled, trajectory};
pub use system::{Drive, State, System};
