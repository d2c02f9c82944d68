//! Host simulator: a whole CoreH-bot on a desk without a desk.
//!
//! [`world`] plays firmware and mechanism against each other in simulated time; a [`world::Host`] feeds it and every
//! step event goes to a [`world::Sink`]. The sinks here write traces, add up figures and check the steps against
//! physics. It needs no threads, clock or temporary files, so it runs in a browser too. `corehbot-report` turns its
//! figures into pages, and the command is `corehbot-cli`.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod accelerometer;
pub mod accident;
mod any_storage;
pub mod axis_sums;
pub mod bed_plant;
pub mod belt;
pub mod check;
pub mod counts;
pub mod drivers;
pub mod eeprom;
mod ends;
pub mod file_line;
pub mod heat_plant;
pub mod host;
pub mod judge;
pub mod limits;
pub mod lines;
pub mod mesh_log;
pub mod moves;
pub mod not_gcode;
mod odometer;
pub mod options;
mod ports;
mod queue_log;
pub mod reach;
pub mod sampler;
pub mod script;
pub mod series;
pub mod slicer;
pub mod tally;
pub mod tmc2209;
pub mod trace;
pub mod user_actions;
pub mod vcd;
pub mod wiring_mistakes;
pub mod world;
