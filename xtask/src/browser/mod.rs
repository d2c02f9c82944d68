//! The step `browser` of the test: pages in a headless Chromium, driven by Selenium through WebDriver.
//!
//! Each trial is a Python program in `xtask/browser`, which gets the path of `corehbot` and says in a line what it has
//! measured. A Rust client of WebDriver would be built of 150 crates on each clean computer; Selenium installs in
//! seconds, as the clients of the step `clients` do.

mod program;

use crate::bundle;
use crate::checkout::{self, root, target_dir};
use crate::clients::venv::Venv;
use crate::page;
use crate::processor;
use crate::verdict::Verdict;
use anyhow::{Context as _, Result};
use program::Programs;
use std::process::Command;

/// The client of WebDriver, and what compares pictures.
const CLIENT: Venv<'static> = Venv { name: "browser", packages: &["selenium==4.51.0", "pillow==13.0.0"], options: &[] };

/// axe-core, which looks for what keeps people from using a page. Its package for Python has the script; the library
/// that the package would bring with it is for another client.
const AXE: Venv<'static> = Venv { name: "axe", packages: &["axe-playwright-python==0.1.8"], options: &["--no-deps"] };

/// Where the trials are.
const FOLDER: &str = "xtask/browser";

/// The trials, in this order.
const TRIALS: [&str; 9] = [
    "golden.py",
    "colours.py",
    "viewer.py",
    "finding.py",
    "access.py",
    "twin_pages.py",
    "page_use.py",
    "page_keeps.py",
    "page_hashes.py",
];

/// Runs all trials.
pub fn check() -> Result<Verdict> {
    let programs = match Programs::find_or_install()? {
        Ok(programs) => programs,
        Err(lack) => return Ok(Verdict::Skipped(lack)),
    };
    for venv in [&CLIENT, &AXE] {
        venv.install().with_context(|| {
            let packages = venv.packages.join(" ");
            format!("cannot install {packages} from PyPI, which takes python3 with venv and, the first time, a network")
        })?;
    }
    let corehbot = checkout::build_command()?;
    // Its pages are looked at too; trials find it next to the command.
    checkout::build_laboratory()?;
    let page = page::write(None)?;
    // Pictures that differ from their models stay here.
    let pictures = target_dir()?.join("browser");
    std::fs::create_dir_all(&pictures).with_context(|| format!("cannot make {}", pictures.display()))?;
    let (mut failures, mut times) = (Vec::new(), Vec::new());
    for trial in TRIALS {
        let mut command = Command::new(CLIENT.python()?);
        // No compiled files in the sources.
        command.arg("-B").arg(root().join(FOLDER).join(trial)).arg(&corehbot);
        command.env("PICTURES", &pictures).env("PAGE", &page).env("AXE", AXE.folder()?);
        programs.tell(&mut command);
        let (output, taken) = processor::timed(|| command.output());
        let output = output.with_context(|| format!("cannot run {}", checkout::words(&command)))?;
        times.push((trial.to_owned(), taken));
        let words = if output.status.success() { &output.stdout } else { &output.stderr };
        let words = String::from_utf8_lossy(words);
        if output.status.success() {
            println!("{trial}: {} ({:.1} CPU-s)", words.trim(), taken.as_secs_f64());
        } else {
            println!("{trial}: FAILED: {}", words.trim());
            failures.push(trial);
        }
    }
    // Debian's npm depends on 67 packages, too many to install for this. The report's own test compares hashes anyway.
    let mut done = TRIALS.len();
    if bundle::has_npm() {
        done += 1;
        match bundle::check() {
            Ok(words) => println!("bundle: {words}"),
            Err(error) => {
                println!("bundle: FAILED: {error:#}");
                failures.push("bundle");
            }
        }
    } else {
        println!("bundle: not compared: {}", bundle::lack_of_npm());
    }
    let failed = u32::try_from(failures.len())?;
    let passed = u32::try_from(done)? - failed;
    let remark = if failed > 0 { format!("fail: {}", failures.join(", ")) } else { programs.version };
    Ok(Verdict::Tested { passed, failed, remark, times })
}
