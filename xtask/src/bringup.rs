//! `cargo xtask bringup`: the first hour (`corehbot bringup`) with the image that a user flashes, at the UART of an
//! emulated board.

use crate::checkout::{self, root, run, target_dir};
use crate::emulate;
use crate::images;
use anyhow::{Context as _, Result, ensure};
use corehbot_host::stop::Stop;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The machine, if none is named: the prototype with a hotend.
const MACHINE: &str = "name = \"first hour\"\nboard = \"octopus\"\n[heaters.hotend]\nis_fitted = true\n";

/// The guide and its board.
#[derive(clap::Args)]
pub struct Args {
    /// Answers no questions: everything is as it should be.
    #[arg(long)]
    yes: bool,
    /// The machine; without it, the prototype with a hotend.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    settings: Option<PathBuf>,
    /// More options of the emulator, such as `--fault silent-driver:m4` or `--break open:hotend@0s`.
    #[arg(last = true, value_name = "OPTION")]
    more: Vec<String>,
}

/// Leads through it.
pub fn main(args: &Args) -> Result<()> {
    let here = std::env::current_dir()?;
    let folder = target_dir()?.join("bringup");
    fs::create_dir_all(&folder)?;
    let machine = match &args.settings {
        Some(path) => here.join(path),
        None => folder.join("machine.toml"),
    };
    if args.settings.is_none() {
        fs::write(&machine, MACHINE)?;
    }
    let image = images::build_image("corehbot-octopus")?;
    let mut build = emulate::cargo(["build"], &["--quiet"]);
    build.current_dir(root());
    run(build)?;
    let command = checkout::build_command()?;
    // Ctrl-C is for the guide, which then brings the board to rest. This program and the emulator outlive it.
    let _stop = Stop::at_signals()?;
    let port = folder.join("printer");
    let mut board = emulate::cargo(["run"], &["--quiet", "--"]);
    board.arg(&image).arg("--pty").arg(&port).arg("--machine").arg(&machine).args(["--speed", "max"]).args(&args.more);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut board, 0);
    let mut board = board.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().context("the emulator")?;
    let mut said = BufReader::new(board.stdout.take().context("the emulator has no output")?);
    let mut name = String::new();
    said.read_line(&mut name)?;
    let mut guide = Command::new(command);
    guide.arg("bringup").arg(&port).arg("--machine").arg(&machine).arg("--report").arg(folder.join("report.md"));
    // Its board is as fast as this computer can emulate it.
    guide.args(["--patience", "60"]);
    guide.current_dir(here).args(args.yes.then_some("--yes"));
    let guided = guide.status().context("the guide");
    let mut end = Command::new("kill");
    end.args(["-INT", &board.id().to_string()]);
    let ended = run(end);
    let mut seen = String::new();
    said.read_to_string(&mut seen)?;
    let is_sound = board.wait()?.success();
    println!("\nThe board:\n{seen}");
    ended?;
    ensure!(is_sound, "the board did what it must not do");
    ensure!(guided?.success(), "a step of the guide has not passed");
    Ok(())
}
