//! The stream of moves: into the look-ahead, and out of it at the right time.

pub(in crate::machine) mod flow;
pub(in crate::machine) mod motion;
pub(in crate::machine) mod slowdown;
