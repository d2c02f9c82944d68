//! Virtual environments of Python, one a client, with the packages that are named and no others.

use crate::checkout::target_dir;
use anyhow::{Context as _, Result, bail};
use std::path::PathBuf;
use std::process::Command;

/// A file in a complete environment, with the list of its packages.
const COMPLETE: &str = "complete";

/// Packages from PyPI, in a folder of their own.
pub struct Venv<'p> {
    pub name: &'static str,
    pub packages: &'p [&'static str],
    pub options: &'static [&'static str],
}

impl Venv<'_> {
    /// Where it is.
    pub fn folder(&self) -> Result<PathBuf> {
        Ok(target_dir()?.join("clients").join(self.name))
    }

    /// Its interpreter.
    pub fn python(&self) -> Result<PathBuf> {
        Ok(self.folder()?.join("bin/python"))
    }

    /// Makes it, if it is not there as it should be.
    pub fn install(&self) -> Result<()> {
        let folder = self.folder()?;
        let content = [self.options, self.packages].concat().join(" ");
        if std::fs::read_to_string(folder.join(COMPLETE)).is_ok_and(|made| made == content) {
            return Ok(());
        }
        println!("installing {content}");
        let mut python = Command::new("python3");
        quietly(python.args(["-m", "venv", "--clear"]).arg(&folder))?;
        let mut pip = Command::new(self.python()?);
        // A missing network should show soon. Only a few of the installed files are used, and Python compiles these on
        // use.
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-compile"]);
        pip.args(["--timeout=20", "--retries=1"]);
        quietly(pip.args(self.options).args(self.packages))?;
        std::fs::write(folder.join(COMPLETE), content).context("cannot write there")
    }
}

/// Runs a command; shows the end of its output only if it fails.
fn quietly(command: &mut Command) -> Result<()> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().with_context(|| format!("cannot run {name}"))?;
    if !output.status.success() {
        let words = [output.stdout, output.stderr].concat();
        let words = String::from_utf8_lossy(&words);
        bail!("{}", words.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no reason is given"));
    }
    Ok(())
}
