//! What the questions of `corehbot twin` and `corehbot-lab` have in common: options, and readers of files.
//!
//! | file | job |
//! |---|---|
//! | [`setup`] | the machine that is asked about, the tool's place, and what may move |
//! | [`source`] | the steps of a file: a trace, or G-code that goes through the firmware |
//! | [`outside`] | types of lines by their place, where a file names none |
//! | [`play`] | steps played on a machine |
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod outside;
pub mod play;
pub mod setup;
pub mod source;
