//! Reports: pages that show a print, or the twin's version of it, without any network; and the summary of a print.
//!
//! Everything here is computed from the data of the simulator and the twin, and written to the caller's writer. There
//! are no files, threads or clocks, so it runs in a browser too.
//!
//! | file | job |
//! |---|---|
//! | [`summary`] | the result of a print, in words and as JSON |
//! | [`finished_print`] | a print that is over: its summary from the parts of the simulator |
//! | [`fault`] | why a print failed, and what to do |
//! | [`sums`] | time and filament of a print by type of line, layer and limit |
//! | [`heat_log`] | temperatures and duties over a print |
//! | [`mesh`] | the mesh of the bed, and its effect |
//! | [`moves`] | every move with its line, its type and its times |
//! | [`record`] | all of a print: one JSON object and three streams |
//! | [`path`] | the way of the tool, exact to a step |
//! | [`mod@print`] | the page of a print |
//! | [`viewer`] | the script that shows a print |
//! | [`twin`] | the pages of the twin |
//! | [`resonance`] | the page of an accelerometer's recordings |
//! | [`svg`] | drawings and charts |
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod fault;
pub mod finished_print;
pub mod heat_log;
mod layers;
pub mod mesh;
pub mod moves;
pub mod path;
pub mod print;
pub mod record;
pub mod resonance;
pub mod summary;
pub mod sums;
pub mod svg;
pub mod twin;
mod varint;
pub mod viewer;
