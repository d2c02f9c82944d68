//! What several tests of the protocol stand on.
#![allow(dead_code, clippy::unwrap_used, reason = "each test uses a part, and fails by panicking")]

pub mod bodies;
pub mod hosts;
pub mod machine;
pub mod octoprint;
pub mod print;
