//! Status: with which exit status a command ends.
//!
//! 0: all was done, and is sound. 1: it was not. 2: nothing was begun, because the command line, a file or the settings
//! are wrong. 130: Ctrl-C (128 and the number of the signal; [`crate::stop`]).

use crate::say::note;
use anyhow::{Error, Result};
use corehbot_machine_file::printable;
use std::process::ExitCode;

/// All went well.
pub const DONE: u8 = 0;

/// The print failed, or a file is not a machine.
pub const FAILED: u8 = 1;

/// Nothing was begun; clap ends with the same status.
pub const UNUSABLE: u8 = 2;

/// Runs the prepared command of this program, and returns the exit status.
pub fn end<T>(program: &str, prepared: Result<T>, run: impl FnOnce(T) -> Result<u8>) -> ExitCode {
    match prepared.map(run) {
        Ok(Ok(status)) => ExitCode::from(status),
        Ok(Err(error)) => complain(program, &error, FAILED),
        Err(error) => complain(program, &error, UNUSABLE),
    }
}

fn complain(program: &str, error: &Error, status: u8) -> ExitCode {
    note(format_args!("{program}: {}", printable::lines(&format!("{error:#}"))));
    ExitCode::from(status)
}
