//! This computer, for programs that print, serve or compute: files, terminals, serial lines, signals and progress.
//!
//! The command, the emulator, the laboratory and `cargo xtask` use it, and none of them builds another one for it.
//! What is below needs no operating system.
//!
//! | file | job |
//! |---|---|
//! | [`stop`], [`status`] | Ctrl-C, and the exit status |
//! | [`say`], [`progress`] | lines for the caller; a bar on a terminal |
//! | [`input`], [`printer`] | G-code files of any kind; the machine that options name |
//! | [`output`], [`answer`] | outputs that are whole or not there; tables and JSON |
//! | [`serial`] | lines to boards, and pseudo-terminals for hosts |
//! | [`image`] | the machine in an image's bytes |
//! | [`bed_args`], [`heat_args`], [`plant_args`] | the simulated machine that options ask for |
//! | [`accident_args`] | what breaks in it |
//! | [`values`], [`examples`] | readers of words on the command line; examples in its help |
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod accident_args;
pub mod answer;
pub mod bed_args;
pub mod examples;
pub mod heat_args;
pub mod image;
pub mod input;
pub mod output;
pub mod plant_args;
pub mod printer;
pub mod progress;
pub mod say;
#[cfg(unix)]
pub mod serial;
pub mod status;
pub mod stop;
pub mod values;
