//! `cargo xtask mutants`: faults are put into the core, one at a time, and its tests must notice.
//!
//! The work is cargo-mutants'. All rooms take many hours, so a part of the mutants can be asked for (`--shard 0/20` is every
//! twentieth); whoever changes a room runs that room.

mod survivors;

use crate::checkout::{cargo, root, run, target_dir};
use anyhow::{Context as _, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use survivors::Survivors;

/// The version that the list of survivors was made with; another one makes other mutants.
const VERSION: &str = "27.1.0";

/// This part of the mutants of a room must be noticed.
const GOAL: f64 = 0.9;

/// A room, and the tests that look at it. The simulator's tests look at all rooms but take too long.
struct Room {
    name: &'static str,
    tests: &'static [&'static str],
}

const ROOMS: [Room; 6] = [
    Room { name: "protocol", tests: &["line_noise", "line_protocol", "line_receiver", "line_silence", "replies"] },
    Room { name: "gcode", tests: &["gcode"] },
    Room { name: "motion", tests: &["motion", "stepper", "queue_orders", "mechanisms"] },
    Room { name: "driver", tests: &["driver"] },
    Room { name: "storage", tests: &["storage"] },
    Room { name: "settings", tests: &["setting_ranges", "storage", "mechanisms"] },
];

/// What to try.
#[derive(clap::Args)]
pub struct Args {
    /// Only this room.
    #[arg(long, value_name = "NAME", value_parser = ROOMS.map(|room| room.name))]
    room: Option<String>,
    /// Only a part: 0/20 is the first, the 21st and so on.
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// So many at a time.
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: u32,
}

/// Puts the faults in and tells what was noticed.
pub fn main(args: &Args) -> Result<()> {
    install()?;
    let known = Survivors::known()?;
    let mut rows = Vec::new();
    let mut is_reached = true;
    for room in ROOMS.iter().filter(|room| args.room.as_deref().is_none_or(|only| only == room.name)) {
        let output = try_room(room, args)?;
        let count = |name: &str| lines(&output, name).map(|lines| lines.len());
        let missed = lines(&output, "missed")?;
        let (noticed, unviable) = (count("caught")? + count("timeout")?, count("unviable")?);
        let all = noticed + missed.len();
        let part = if all == 0 { 1.0 } else { noticed as f64 / all as f64 };
        is_reached &= part >= GOAL;
        rows.push(format!("{:<9} {all:>5} {:>6.1} % {:>6} {unviable:>9}", room.name, 100.0 * part, missed.len()));
        for mutant in missed {
            rows.push(match known.reason(&mutant) {
                Some(reason) => format!("  {mutant}: {reason}"),
                None => format!("  {mutant}: NEW"),
            });
        }
    }
    println!("\nroom     tried  noticed  missed  unviable");
    rows.iter().for_each(|row| println!("{row}"));
    if is_reached { Ok(()) } else { bail!("less than {} % were noticed", 100.0 * GOAL) }
}

/// Tries the mutants of a room, and says where the outcomes are.
fn try_room(room: &Room, args: &Args) -> Result<PathBuf> {
    let output = target_dir()?.join("mutants").join(room.name);
    std::fs::create_dir_all(&output).with_context(|| format!("cannot make {}", output.display()))?;
    let mut command = cargo(["mutants", "--package=corehbot", "--test-package=corehbot", "--minimum-test-timeout=60"]);
    command.arg(format!("--file=src/{}/**", room.name)).arg("--output").arg(&output);
    command.arg(format!("--jobs={}", args.jobs));
    if let Some(shard) = &args.shard {
        command.args(["--sharding=round-robin", "--shard", shard]);
    }
    command.args(["--", "--lib"]);
    room.tests.iter().for_each(|test| _ = command.args(["--test", test]));
    // Nobody looks at these programs with a debugger.
    command.env("CARGO_PROFILE_DEV_DEBUG", "0");
    let status = command.status().context("cannot run cargo mutants")?;
    // 2 and 3: some were missed, or took too long.
    if matches!(status.code(), Some(0 | 2 | 3)) {
        Ok(output.join("mutants.out"))
    } else {
        bail!("cargo mutants: {status}")
    }
}

/// The lines of one of the lists that cargo-mutants leaves.
fn lines(output: &Path, name: &str) -> Result<Vec<String>> {
    let path = output.join(name).with_extension("txt");
    let text = std::fs::read_to_string(&path).with_context(|| format!("cannot open {}", path.display()))?;
    Ok(text.lines().map(str::to_owned).collect())
}

/// Fetches cargo-mutants, if it is not there in this version.
fn install() -> Result<()> {
    let mut command = Command::new("cargo");
    let found = command.args(["mutants", "--version"]).stderr(Stdio::null()).output();
    if found.is_ok_and(|found| String::from_utf8_lossy(&found.stdout).trim().ends_with(VERSION)) {
        return Ok(());
    }
    let mut command = cargo(["install", "cargo-mutants", "--locked", "--version", VERSION]);
    command.current_dir(root());
    run(command).with_context(|| format!("cargo-mutants is missing: cargo install cargo-mutants --version {VERSION}"))
}
