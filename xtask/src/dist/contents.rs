//! The contents of the archive.

use super::archive::File;
use super::git;
use crate::build::{self, Board};
use crate::checkout::{self, cargo, command_output, run};
use crate::page;
use anyhow::{Context as _, Result, ensure};
use std::path::Path;
use std::process::Command;

/// The profile of the command: like `release`, without the data for debuggers.
const PROFILE: &str = "dist";

/// Files taken from the checkout unchanged: for people who print, not for people who build.
const PLAIN: [&str; 7] =
    ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT", "docs", "examples", "boards/*/README.md"];

/// Builds the binaries, and gathers all files.
pub(super) fn contents() -> Result<Vec<File>> {
    let mut files = plain()?;
    let command = command()?;
    let name = command.file_name().context("the command has no name")?.to_string_lossy().into_owned();
    files.push(File { path: name, bytes: read(&command)?, is_program: true });
    files.extend(manual()?);
    for board in Board::all() {
        let bytes = read(&build::image(board)?.binary)?;
        files.push(File { path: format!("images/{}.bin", board.key()), bytes, is_program: false });
    }
    for file in page::files()? {
        files.push(File { path: format!("page/{}", file.name), bytes: file.bytes, is_program: false });
    }
    for file in &files {
        ensure_nothing_of_here(file)?;
    }
    Ok(files)
}

/// Files of the checkout, by git, which knows which belong to it.
fn plain() -> Result<Vec<File>> {
    let mut list = git(["ls-files", "--"]);
    list.args(PLAIN);
    let list = command_output(list)?;
    let files = list.lines().map(|path| {
        let bytes = read(&checkout::root().join(path))?;
        Ok(File { path: path.to_owned(), bytes, is_program: false })
    });
    files.collect()
}

/// Builds the command.
fn command() -> Result<std::path::PathBuf> {
    let mut build = cargo(["build", "--package", "corehbot-cli", "--bin", "corehbot", "--profile", PROFILE]);
    // The target is named so that build scripts do not get the flags.
    let host = checkout::host()?;
    build.args(["--target", &host]).env(checkout::FLAGS, checkout::path_flags()?);
    run(build)?;
    let folder = checkout::target_dir()?.join(host).join(PROFILE);
    Ok(folder.join("corehbot").with_extension(std::env::consts::EXE_EXTENSION))
}

/// The folders that the manual consists of.
const MANUAL: [&str; 2] = ["completions", "man"];

/// Manual pages, and what shells complete. Their program is built with the dependencies that xtask has already.
fn manual() -> Result<Vec<File>> {
    run(cargo(["build", "--package", "corehbot-manual", "--package", "xtask"]))?;
    let target = checkout::target_dir()?;
    let folder = target.join("manual");
    // A command that is no longer there leaves no page.
    let _ = std::fs::remove_dir_all(&folder);
    let mut write = Command::new(target.join("debug/corehbot-manual").with_extension(std::env::consts::EXE_EXTENSION));
    write.arg(&folder);
    run(write)?;
    let mut files = Vec::new();
    for part in MANUAL {
        for entry in std::fs::read_dir(folder.join(part)).context("there is no manual")? {
            let path = entry?.path();
            let name = path.file_name().context("a page has no name")?.to_string_lossy();
            files.push(File { path: format!("{part}/{name}"), bytes: read(&path)?, is_program: false });
        }
    }
    Ok(files)
}

/// A binary must not contain its build folder: it would differ elsewhere.
fn ensure_nothing_of_here(file: &File) -> Result<()> {
    for path in [checkout::root().to_owned(), checkout::cargo_home()?] {
        let path = path.to_string_lossy();
        let is_in = file.bytes.windows(path.len()).any(|bytes| bytes == path.as_bytes());
        ensure!(!is_in, "{} names {path}", file.path);
    }
    Ok(())
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("cannot open {}", path.display()))
}
