//! The stream of moves: the waits of commands for room in the look-ahead, and for the machine to rest.
//!
//! A command that moves calls `plan` (in [`plan`]), one that needs the machine at rest `finish` (in [`rest`]). The
//! look-ahead itself belongs to [`motion`](super::motion).

mod plan;
mod rest;
