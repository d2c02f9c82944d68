//! `cargo xtask dist`: a release as one archive. It has the command for this computer with manual pages and completions
//! for shells, and the images of all boards. It also has examples, documents, licences, and a checksum of each file.
//! Its users need no compiler.
//!
//! The same commit gives the same bytes, whatever the folder and the day. Files are in order and have the commit's
//! time, and no binary contains a path of this computer. `--twice` shows it.

mod archive;
mod contents;

use crate::checkout::{self, cargo, command_output, run};
use anyhow::{Context as _, Result, ensure};
use archive::archive;
use contents::contents;
use std::path::{Path, PathBuf};

/// Where to write the archive.
#[derive(clap::Args)]
pub struct Args {
    /// The folder to write into; target/dist if left out.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Builds it in a clone in another folder too, and compares the bytes. Takes as long as two builds of everything.
    #[arg(long)]
    twice: bool,
}

/// Builds the archive.
pub fn main(args: &Args) -> Result<()> {
    ensure!(command_output(git(["status", "--porcelain"]))?.is_empty(), "there are changes that are in no commit");
    let folder = args.output.clone().map_or_else(|| checkout::target_dir().map(|dir| dir.join("dist")), Ok)?;
    let path = release(&folder)?;
    if args.twice {
        compare_with_clone(&path)?;
    }
    Ok(())
}

/// Builds everything and writes the archive.
fn release(folder: &Path) -> Result<PathBuf> {
    let name = format!("corehbot-{}", env!("CARGO_PKG_VERSION"));
    let time = command_output(git(["log", "-1", "--format=%ct"]))?.trim().parse().context("the commit has no time")?;
    let bytes = archive(&name, time, &contents()?)?;
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let path = folder.join(format!("{name}-{}.tar.gz", checkout::host()?));
    std::fs::write(&path, &bytes).with_context(|| format!("cannot write {}", path.display()))?;
    println!("archive {} ({} bytes)", path.display(), bytes.len());
    Ok(path)
}

/// Builds the archive of the same commit in another folder, and fails if its bytes are others.
fn compare_with_clone(first: &Path) -> Result<()> {
    let other = std::env::temp_dir().join(format!("corehbot-dist-{}", std::process::id()));
    let mut clone = git(["clone", "--quiet", "."]);
    clone.arg(&other);
    run(clone)?;
    let second = other.join("archive");
    let mut again = cargo(["xtask", "dist", "--output"]);
    // Nothing of this build may be used there.
    again.arg(&second).current_dir(&other).env_remove("CARGO_TARGET_DIR");
    let built = run(again);
    let is_same = built.and_then(|()| {
        let name = first.file_name().context("the archive has no name")?;
        Ok(std::fs::read(first)? == std::fs::read(second.join(name))?)
    });
    let _ = std::fs::remove_dir_all(&other);
    ensure!(is_same?, "the archive built in {} has other bytes", other.display());
    println!("the same bytes come from {}", other.display());
    Ok(())
}

fn git<const N: usize>(args: [&str; N]) -> std::process::Command {
    let mut command = std::process::Command::new("git");
    command.args(args).current_dir(checkout::root());
    command
}
