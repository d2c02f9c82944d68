//! The `corehbot` command: what a person or a program asks for on the command line, and the files, terminals, serial
//! lines, signals and threads that it takes.
//!
//! What it prints on is `corehbot-sim`; machine files are `corehbot-machine-file`, pages and summaries
//! `corehbot-report`, and the belt `corehbot-twin`. These need no system, and check for a browser
//! (`cargo xtask test --only wasm`); whatever needs one stands here. Other tools of the project use its outputs, its
//! signals and its serial line.
//!
//! ```text
//!  cli ──> report ──> sim ──> machine-file ──> core
//!                └──> twin <──┘ └──> rig ───────────^
//! ```
//! An arrow says who uses whom; `tests/layers.rs` of this crate holds it, and that no files of a crate use each other
//! in a circle.
#![forbid(unsafe_code)]

pub mod cli;
mod config;
pub mod heat_args;
pub mod image;
pub mod input;
pub mod output;
pub mod plant_args;
mod printer;
mod run;
#[cfg(unix)]
pub mod serve;
mod status;
pub mod stop;
mod twin;
mod watched;
