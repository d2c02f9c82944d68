//! Torque: a motor's torque at a speed, and the torque that a move needs.
//!
//! | file | content |
//! |---|---|
//! | [`pull_out`] | pull-out torque of a motor, limited by current and supply |
//! | [`demand`] | torque of each motor for a speed and an acceleration of the tool, anywhere in the reach |

pub mod demand;
pub mod pull_out;
