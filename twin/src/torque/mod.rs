//! Torque: what a motor has at a speed, and what a move asks of it.
//!
//! | file | what |
//! |---|---|
//! | [`pull_out`] | the greatest torque of a motor at a speed, as current and supply allow |
//! | [`demand`] | the torque of each motor for a speed and an acceleration of the tool, anywhere in the reach |

pub mod demand;
pub mod pull_out;
