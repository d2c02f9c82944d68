//! `cargo xtask picture`: the picture in the README, which is the report of a print as a headless Chromium draws it.

use crate::checkout::{cargo, root, run, target_dir};
use anyhow::{Context as _, Result, ensure};
use std::fs;
use std::process::Command;

/// The most that a picture may weigh in the repository, in bytes.
const MOST_BYTES: u64 = 150_000;

/// Runs the print, draws its page, and writes docs/pictures/report.png.
pub fn main() -> Result<()> {
    let page = target_dir()?.join("report.html");
    let mut print = cargo(["run", "--quiet", "--release", "-p", "corehbot-cli", "--", "run"]);
    print.arg(root().join("examples/first-print.gcode")).arg("--report").arg(&page);
    run(print)?;
    let picture = root().join("docs/pictures/report.png");
    let mut browser = Command::new("chromium");
    // A container has no sandbox, and no graphics; the page is ours. The picture is taken after so many ms: lines are drawn
    // over several frames.
    browser.args(["--headless", "--no-sandbox", "--hide-scrollbars", "--window-size=1000,680"]);
    browser.args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--timeout=15000"]);
    browser.arg(format!("--screenshot={}", picture.display()));
    browser.arg(format!("file://{}", page.display()));
    run(browser).context("a headless browser draws the page: apt-get install chromium")?;
    let size = fs::metadata(&picture)?.len();
    ensure!(size <= MOST_BYTES, "{}: {size} bytes, {MOST_BYTES} at most", picture.display());
    println!("{}: {size} bytes", picture.display());
    Ok(())
}
