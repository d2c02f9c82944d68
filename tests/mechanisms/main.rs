//! Mechanisms as data: forward and inverse in whole numbers, the motor motions that are not allowed, and why motors of
//! a group step in the same instant.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

#[path = "../support/belt_equations.rs"]
mod belt_equations;
#[path = "../motion/line.rs"]
#[allow(dead_code, reason = "other tests need the rest of it")]
mod line;
mod machines;
mod prototype;
mod residuals;
mod rows;
mod stepping;
mod zigzag;
