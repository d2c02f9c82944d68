//! Rustup: what it adds to the toolchain.

use crate::checkout::{run, sysroot};
use anyhow::{Context as _, Result};
use std::process::Command;

/// The source of the core library, which images are built with.
pub fn ensure_core_source() -> Result<()> {
    if sysroot()?.join("lib/rustlib/src/rust/library/core/Cargo.toml").exists() {
        return Ok(());
    }
    run(call(["component", "add", "rust-src"]))
        .context("the core library's source is missing; install it with: rustup component add rust-src")
}

/// A call of it.
pub fn call<const N: usize>(args: [&str; N]) -> Command {
    let mut command = Command::new("rustup");
    command.args(args);
    command
}
