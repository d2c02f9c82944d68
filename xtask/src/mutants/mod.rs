//! `cargo xtask mutants`: faults are put into the core, one at a time, and its tests must notice.
//!
//! cargo-mutants does the work. All rooms take hours, so a part of the mutants can be selected (`--shard 0/20` is every
//! twentieth); a change of a room needs a run of that room.

mod excerpt;
mod survivors;

use crate::checkout::{cargo, root, run, target_dir};
use anyhow::{Context as _, Result, bail};
use std::collections::BTreeSet;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use survivors::Survivors;

/// The version that the list of survivors was made with; another one makes other mutants.
const VERSION: &str = "27.1.0";

/// This part of the mutants of a room must be noticed.
const GOAL: f64 = 0.9;

/// A room, and the tests that check it. The simulator's tests check all rooms but take too long.
struct Room {
    name: &'static str,
    /// Tests that notice most within a second or two, in addition to the unit tests.
    quick: &'static [&'static str],
    tests: &'static [&'static str],
}

const ROOMS: [Room; 6] = [
    Room {
        name: "protocol",
        quick: &[],
        tests: &["line_noise", "line_properties", "line_protocol", "line_receiver", "line_silence", "replies"],
    },
    Room { name: "gcode", quick: &[], tests: &["gcode"] },
    Room { name: "motion", quick: &["golden_steps"], tests: &["motion", "stepper", "queue_orders", "mechanisms"] },
    Room { name: "driver", quick: &[], tests: &["driver"] },
    Room { name: "storage", quick: &[], tests: &["storage"] },
    Room { name: "settings", quick: &[], tests: &["setting_ranges", "storage", "mechanisms"] },
];

/// The mutants to try.
#[derive(clap::Args)]
pub struct Args {
    /// Only this room.
    #[arg(long, value_name = "NAME", value_parser = ROOMS.map(|room| room.name))]
    room: Option<String>,
    /// Only a part: 0/20 is the first, the 21st and so on.
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// Number of parallel jobs.
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: u32,
}

/// Inserts the faults and reports which were noticed.
pub fn main(args: &Args) -> Result<()> {
    install()?;
    let _alone = alone()?;
    let known = Survivors::known()?;
    let mut rows = Vec::new();
    let mut is_reached = true;
    for room in ROOMS.iter().filter(|room| args.room.as_deref().is_none_or(|only| only == room.name)) {
        let Outcome { noticed, missed, unviable } = try_room(room, args)?;
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

/// Makes sure that no other process tries mutants here, as long as the file is held. Cargo takes excerpts for the same
/// crate wherever they lie, so tests built from another excerpt would run.
fn alone() -> Result<File> {
    let folder = target_dir()?.join("mutants");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let path = folder.join("lock");
    let file = File::create(&path).with_context(|| format!("cannot make {}", path.display()))?;
    file.try_lock().with_context(|| format!("mutants are being tried: {} is held", path.display()))?;
    Ok(file)
}

/// The results of mutants. A mutant that makes the tests run for ever counts as noticed.
struct Outcome {
    noticed: usize,
    missed: Vec<String>,
    unviable: usize,
}

/// Tries the mutants of a room, first with the tests that take a second. Mutants that these miss are then tried with
/// all tests that check the room.
fn try_room(room: &Room, args: &Args) -> Result<Outcome> {
    let folder = target_dir()?.join("mutants").join(room.name);
    let unit_folder = folder.join("unit");
    let mut unit = mutants(room, room.quick, args, &unit_folder)?;
    unit.arg(format!("--file=src/{}/**", room.name));
    unit.args(["--minimum-test-timeout=5", "--cargo-arg=--lib"]);
    unit.args(programs(room.quick));
    if let Some(shard) = &args.shard {
        unit.args(["--sharding=round-robin", "--shard", shard]);
    }
    // The tests take a second to build without optimisation, and a second to run.
    unit.env("CARGO_PROFILE_DEV_OPT_LEVEL", "0");
    let first = outcome(unit, &unit_folder)?;
    if first.missed.is_empty() {
        return Ok(first);
    }
    let all_folder = folder.join("all");
    let mut all = mutants(room, room.tests, args, &all_folder)?;
    let wanted = folder.join("missed.toml");
    std::fs::write(&wanted, only(&first.missed)?).with_context(|| format!("cannot write {}", wanted.display()))?;
    // The pattern does not exclude mutants that delete a field: already noticed ones do not count here. They are few in
    // these files.
    files(&first.missed).into_iter().for_each(|file| _ = all.arg(format!("--file={file}")));
    all.arg("--config").arg(&wanted).arg("--minimum-test-timeout=60");
    all.args(programs(room.tests));
    let second = outcome(all, &all_folder)?;
    let missed: Vec<_> = first.missed.iter().filter(|mutant| second.missed.contains(mutant)).cloned().collect();
    let noticed = first.noticed + first.missed.len() - missed.len();
    Ok(Outcome { noticed, missed, unviable: first.unviable })
}

/// cargo-mutants, for a room in an excerpt of the core. `--cargo-arg` selects the tests to build and run: arguments
/// after `--` count only when tests run, and all tests would be built for each mutant.
fn mutants(room: &Room, tests: &[&str], args: &Args, folder: &Path) -> Result<Command> {
    let core = folder.join("core");
    excerpt::write(&core, room.name, tests)?;
    let mut command = cargo(["mutants"]);
    command.arg("--dir").arg(core).arg("--output").arg(folder);
    if args.jobs == 1 {
        // The excerpt is a copy already. Its dependencies are built once for all rooms.
        command.arg("--in-place").env("CARGO_TARGET_DIR", target_dir()?.join("mutants").join("target"));
    } else {
        // Git does not know the build folder.
        command.arg("--gitignore=false").arg(format!("--jobs={}", args.jobs));
    }
    // These programs need no debugger. With this many codegen units, the most that the compiler makes of itself, only
    // the unit with the fault is rebuilt: 1 s instead of 2.
    command.env("CARGO_PROFILE_DEV_DEBUG", "0");
    command.arg("--cargo-arg=--config=profile.dev.package.corehbot.codegen-units=256");
    Ok(command)
}

/// The arguments for the programs of these tests. An excerpt has no others, so the programs run as a whole.
fn programs(tests: &[&str]) -> Vec<String> {
    excerpt::programs(tests).iter().map(|program| format!("--cargo-arg=--test={program}")).collect()
}

/// The files in which these mutants are: `src/motion/trajectory/shaper.rs:54:52: replace ...`.
fn files(mutants: &[String]) -> BTreeSet<&str> {
    mutants.iter().filter_map(|mutant| mutant.split(':').next()).collect()
}

/// Settings of cargo-mutants with which it tries these mutants and no others.
fn only(mutants: &[String]) -> Result<String> {
    let exactly = |mutant: &String| {
        let mut pattern = String::from("^");
        for letter in mutant.chars() {
            if r"\.+*?()|[]{}^$".contains(letter) {
                pattern.push('\\');
            }
            pattern.push(letter);
        }
        pattern + "$"
    };
    // A list of strings looks the same in JSON and in TOML.
    let patterns = serde_json::to_string(&mutants.iter().map(exactly).collect::<Vec<_>>())?;
    Ok(format!("examine_re = {patterns}\n"))
}

/// Runs cargo-mutants and reads its result.
fn outcome(mut command: Command, output: &Path) -> Result<Outcome> {
    std::fs::create_dir_all(output).with_context(|| format!("cannot make {}", output.display()))?;
    let status = command.status().context("cannot run cargo mutants")?;
    // 2 and 3: some were missed, or took too long.
    if !matches!(status.code(), Some(0 | 2 | 3)) {
        bail!("cargo mutants: {status}");
    }
    let lists = output.join("mutants.out");
    let count = |name: &str| lines(&lists, name).map(|lines| lines.len());
    let missed = lines(&lists, "missed")?;
    Ok(Outcome { noticed: count("caught")? + count("timeout")?, missed, unviable: count("unviable")? })
}

/// The lines of one of the lists that cargo-mutants leaves.
fn lines(output: &Path, name: &str) -> Result<Vec<String>> {
    let path = output.join(name).with_extension("txt");
    let text = std::fs::read_to_string(&path).with_context(|| format!("cannot open {}", path.display()))?;
    Ok(text.lines().map(str::to_owned).collect())
}

/// Fetches cargo-mutants, if it is not there in this version.
fn install() -> Result<()> {
    let found = cargo(["mutants", "--version"]).stderr(Stdio::null()).output();
    if found.is_ok_and(|found| String::from_utf8_lossy(&found.stdout).trim().ends_with(VERSION)) {
        return Ok(());
    }
    let mut command = cargo(["install", "cargo-mutants", "--locked", "--version", VERSION]);
    command.current_dir(root());
    run(command).with_context(|| format!("cargo-mutants is missing: cargo install cargo-mutants --version {VERSION}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mutants_are_asked_for_by_their_exact_names() {
        let settings = only(&["src/a.rs:1:2: replace f -> (u8, [&'a T]) with +=".to_owned()]).unwrap();
        assert_eq!(
            settings,
            "examine_re = [\"^src/a\\\\.rs:1:2: replace f -> \\\\(u8, \\\\[&'a T\\\\]\\\\) with \\\\+=$\"]\n"
        );
    }
}
