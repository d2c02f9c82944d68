//! Recordings of plants that are known, and the analyses of them.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod dampings;
#[path = "../../tests/support/extent.rs"]
mod extent;
mod motors;
mod plant;
mod plants;
mod stdata;
mod suggestion;
