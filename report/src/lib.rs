//! Reports: pages that show a print, or what the belt's twin made of it, without any network; and the summary of a
//! print.
//!
//! Everything here is computed from what the simulator and the twin give, and written to whatever the caller hands in:
//! no files, threads or clocks, so it runs in a browser too.
//!
//! | file | what |
//! |---|---|
//! | [`printable`] | texts of others that must not command a terminal |
//! | [`summary`] | what a print came to, in words and as JSON |
//! | [`heat_log`] | temperatures and duties over a print |
//! | [`path`] | the way of the tool, exact to a step |
//! | [`print`] | the page of a print |
//! | [`twin`] | the pages of the twin |
#![forbid(unsafe_code)]

pub mod heat_log;
pub mod path;
pub mod print;
pub mod printable;
pub mod summary;
pub mod twin;
