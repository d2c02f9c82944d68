//! Copies, fills and comparisons of memory at each length and alignment, which the board in QEMU checks by itself.

use crate::images;
use crate::qemu::{BOARD, PROGRAM};
use crate::tools::{has_emulator, lack_of_emulator};
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, ensure};
use std::process::Command;

/// Asks the board for the check.
pub fn check() -> Result<Verdict> {
    if !has_emulator() {
        return Ok(Verdict::Skipped(lack_of_emulator()));
    }
    let image = images::build_image(BOARD)?;
    let output = Command::new(PROGRAM)
        .args(["-M", "mps2-an386", "-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native,arg=corehbot,arg=check-copies", "-kernel"])
        .arg(image)
        .output()
        .with_context(|| format!("cannot run {PROGRAM}"))?;
    let words = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the board ended with {}: {}", output.status, words.trim());
    Ok(Verdict::Passed("all lengths up to 60 bytes, at all alignments".into()))
}
