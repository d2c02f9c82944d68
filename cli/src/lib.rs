//! The `corehbot` command: its command line, and the work of each command.
//!
//! It prints on `corehbot-sim`; machine files are `corehbot-machine-file`, pages and summaries `corehbot-report`, and
//! the belt `corehbot-twin`. These need no operating system, and check for a browser (`cargo xtask test --only wasm`).
//! Files, terminals, serial lines and signals are `corehbot-host`, which other programs of the project use too.
//!
//! ```text
//!  cli ──> report ──> sim ──> machine-file ──> core
//!  │       │     └──> twin <──┘ └──> rig ───────────^
//!  │       └──> resonance ^
//!  └──> host ──> sim, gcode-file ──> machine-file
//! ```
//! An arrow means "uses". `tests/layers.rs` of this crate checks the arrows, and that no files of a crate use each
//! other in a circle.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

#[cfg(unix)]
mod bringup;
pub mod cli;
mod config;
mod digest;
mod examples;
mod image;
mod recorder_threads;
mod resonance;
mod run;
#[cfg(unix)]
mod serve;
mod twin;
