//! The `corehbot` command: its command line, and the files, terminals, serial lines, signals and threads that it uses.
//!
//! It prints on `corehbot-sim`; machine files are `corehbot-machine-file`, pages and summaries `corehbot-report`, and
//! the belt `corehbot-twin`. These need no operating system, and check for a browser (`cargo xtask test --only wasm`);
//! code that needs one stands here. Other tools of the project use its outputs, its signals and its serial line.
//!
//! ```text
//!  cli ──> report ──> sim ──> machine-file ──> core
//!  │       │     └──> twin <──┘ └──> rig ───────────^
//!  │       └──> resonance ^
//!  └──> gcode-file ──> machine-file
//! ```
//! An arrow means "uses". `tests/layers.rs` of this crate checks the arrows, and that no files of a crate use each
//! other in a circle.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod answer;
pub mod bed_args;
#[cfg(unix)]
mod bringup;
pub mod cli;
mod config;
mod digest;
mod examples;
pub mod heat_args;
pub mod image;
pub mod input;
pub mod output;
pub mod plant_args;
mod printer;
mod resonance;
mod run;
mod say;
#[cfg(unix)]
pub mod serve;
mod sinks;
mod status;
pub mod stop;
mod twin;
mod values;
mod watched;
