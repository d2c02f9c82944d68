//! Lines for who has called the command; a reader may have gone, as `| head` does.

use anyhow::{Context as _, Result};
use std::fmt::Display;
use std::io::{self, Write as _};

/// Says a line on standard output.
///
/// # Errors
/// It cannot be written.
pub fn say(line: impl Display) -> Result<()> {
    writeln!(io::stdout().lock(), "{line}").context("cannot write to standard output")
}

/// Says a line on standard error. If its reader has gone, nobody is left to be told.
pub fn note(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Prints a line at once; a closed pipe is ignored.
///
/// # Errors
/// If it cannot be written.
pub fn println(line: std::fmt::Arguments<'_>) -> Result<()> {
    let mut out = io::stdout();
    match writeln!(out, "{line}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written.context("cannot write to standard output"),
    }
}
