//! The step `cluster` of the test: `examples/cluster` computes a study on two worker processes, and one of them is
//! killed.

use crate::checkout::{self, root};
use crate::clients::venv::Venv;
use crate::verdict::Verdict;
use anyhow::{Context as _, Result, bail};
use std::process::Command;

/// The packages, each with its version.
const REQUIREMENTS: &str = include_str!("../../examples/cluster/requirements.txt");

/// The program of the test, a module of Python's unittest.
const TEST: &str = "examples/cluster/test_study.py";

/// Runs the tests there.
pub fn check() -> Result<Verdict> {
    let is_package = |line: &&str| !line.is_empty() && !line.starts_with('#');
    let packages: Vec<&str> = REQUIREMENTS.lines().filter(is_package).collect();
    let venv = Venv { name: "cluster", packages: &packages, options: &[] };
    venv.install().with_context(|| {
        let packages = packages.join(" ");
        format!("cannot install {packages} from PyPI, which takes python3 with venv and, the first time, a network")
    })?;
    let laboratory = checkout::build_laboratory()?;
    let mut test = Command::new(venv.python()?);
    // No compiled files in the sources.
    test.arg("-B").arg(root().join(TEST)).env("COREHBOT_LAB", laboratory);
    let output = test.output().with_context(|| format!("cannot run {}", checkout::words(&test)))?;
    // unittest writes everything to standard error.
    let words = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("{TEST}:\n{}", words.trim());
    }
    let ran = words.lines().find(|line| line.starts_with("Ran ")).unwrap_or("nothing was counted");
    Ok(Verdict::Passed(format!("{ran}; {}", packages.join(", "))))
}
