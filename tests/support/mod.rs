//! Shared parts of the protocol's tests.
#![allow(dead_code, clippy::unwrap_used, reason = "each test uses a part, and fails by panicking")]

pub mod bodies;
pub mod hosts;
pub mod machine;
pub mod octoprint;
pub mod print;
