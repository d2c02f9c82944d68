//! Configurations and saved answers of other firmwares, as machine files.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "support/configurations.rs"]
mod configurations;
mod klipper;
mod marlin;
#[path = "support/reports.rs"]
mod reports;
