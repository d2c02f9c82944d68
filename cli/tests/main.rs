//! The `corehbot` command as a user sees it: input, output and exit status; and the arrows between its crates.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod bringup;
mod command;
mod config;
mod files;
mod layers;
mod printer;
mod report;
mod resonance;
mod serve;
mod twin;
mod wrong_files;
