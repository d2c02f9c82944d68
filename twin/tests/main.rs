//! The twin against closed forms, the paper, and itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod calibration;
mod compare;
mod compensation;
mod contour;
mod corexyz;
mod dynamics;
mod failing;
mod frame;
mod kinematics;
mod layers;
mod live;
mod misalignment;
mod resonance;
mod ripple;
mod routings;
mod statics;
