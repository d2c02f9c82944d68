//! The twin against closed forms, the paper, and itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod calibration;
mod contour;
mod dynamics;
mod failing;
mod grids;
mod kinematics;
mod layers;
mod live;
mod resonance;
mod ripple;
mod routings;
mod statics;
