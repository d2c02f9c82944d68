//! Dynamics: motion between two steps of the motors.
//!
//! A motor's step is an instant. It changes the motor's position (or, with rotors, the rest position of its field) and
//! the free lengths of the segments. Between steps these are constant, and
//!
//! ```text
//! m q'' = - sum of row T - friction - field,     T = T0 + k (e + beta e'), never below 0
//! ```
//!
//! | file | content |
//! |---|---|
//! | [`plant`] | forces and masses |
//! | `field` | the pull of a motor on its rotor |
//! | `failing` | broken cords, and pulleys that slip |
//! | [`friction`] | of guides, brakes and obstacles |
//! | `frame` | a soft frame on the ground |
//! | `bears` | loads of belts, motors, guides and frame |
//! | [`external_forces`] | power, phases, pushes and friction |
//! | [`state`] | positions and speeds, and the classical Runge-Kutta step |

pub mod external_forces;
pub(crate) mod failing;
mod field;
mod frame;
pub mod friction;
mod part_loads;
pub mod plant;
pub mod state;
