//! Motor drivers that are well, and that are not: what the firmware does, and that no motor runs on trust.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod failures;
mod power;
mod script;
mod trust;
mod values;
