//! Host simulator: a whole CoreH-bot on a desk without a desk.
//!
//! [`world`] plays firmware and mechanism against each other in simulated time; a [`world::Host`] feeds it
//! and every step event goes to a [`world::Sink`]. The sinks here write traces, add up figures and hold the
//! steps to physics; the other files turn that into what a person or a program wants to read.
#![forbid(unsafe_code)]

pub mod belt;
pub mod check;
pub mod cli;
mod config;
pub mod drivers;
pub mod eeprom;
pub mod heat_log;
pub mod heat_plant;
pub mod host;
pub mod image;
pub mod input;
pub mod limits;
pub mod machine_file;
mod odometer;
pub mod output;
pub mod path;
mod ports;
pub mod printable;
pub mod report;
mod run;
pub mod sampler;
pub mod script;
pub mod series;
#[cfg(unix)]
pub mod serve;
mod short;
pub mod stop;
pub mod summary;
pub mod tally;
pub mod tmc2209;
pub mod trace;
mod twin;
pub mod vcd;
mod watched;
pub mod world;
