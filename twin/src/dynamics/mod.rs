//! Dynamics: how everything moves between two steps of the motors.
//!
//! A motor's step is an instant: it changes where the motor stands (or, with rotors, where its field pulls to), and the free
//! length of the segments. Between steps all of that is constant, and
//!
//! ```text
//! m q'' = - sum of row T - friction - field,     T = T0 + k (e + beta e'), never below 0
//! ```
//!
//! | file | what |
//! |---|---|
//! | [`plant`] | forces and masses |
//! | `bears` | what belts, motors and guides take |
//! | [`outside`] | power, phases, and what pushes or rubs |
//! | [`state`] | where everything is, and the classical Runge-Kutta step that moves it |

mod bears;
pub mod outside;
pub mod plant;
pub mod state;
