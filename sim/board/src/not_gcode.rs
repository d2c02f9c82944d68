//! Not G-code: lines that no printer can take.

use crate::lines::LONGEST_LINE;
use anyhow::{Result, ensure};

/// Refuses a line, with its number, of which `command` is what comes before a comment.
///
/// # Errors
/// It is not text, or no line.
pub fn check_line(number: u32, line: &str, command: &str) -> Result<()> {
    ensure!(!line.contains('\0'), "line {number} contains a zero byte: this is not text");
    ensure!(command.len() < LONGEST_LINE, "line {number} is longer than a MiB: this is not G-code");
    Ok(())
}
