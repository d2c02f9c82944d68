//! `cargo xtask mutants`: faults are put into the core, one at a time, and its tests must notice.
//!
//! All mutants are built at once, into a copy of the checkout. A program of tests runs one of them: the switch
//! reads its number from the environment.

mod copy;
mod rewrite;
mod sites;
mod survivors;
mod trial;
mod values;

use crate::checkout::target_dir;
use anyhow::{Context as _, Result, bail};
use copy::{Copy, Mutant};
use std::fs::File;
use std::path::PathBuf;
use std::time::Instant;
use survivors::Survivors;
use trial::Program;

/// At most this part of the mutants of a room may survive.
const GOAL: f64 = 0.06;

/// A room, and the tests that check it in addition to its unit tests.
struct Room {
    name: &'static str,
    /// Modules of the core's tests.
    core: &'static [&'static str],
    /// Modules of the simulator's tests. They build longer than all others.
    simulator: &'static [&'static str],
}

const ROOMS: [Room; 12] = [
    Room { name: "kinematics", core: &["mechanisms", "setting_ranges"], simulator: &[] },
    Room { name: "surface", core: &["surface", "storage"], simulator: &[] },
    Room { name: "status", core: &["stepper", "faults", "motion", "driver"], simulator: &[] },
    Room { name: "fault", core: &["faults", "thermal"], simulator: &[] },
    Room { name: "storage", core: &["storage", "setting_ranges"], simulator: &[] },
    Room { name: "thermal", core: &["thermal", "faults"], simulator: &[] },
    Room {
        name: "protocol",
        core: &["line_noise", "line_properties", "line_protocol", "line_receiver", "line_silence", "replies"],
        simulator: &[],
    },
    Room { name: "gcode", core: &["gcode"], simulator: &[] },
    Room { name: "motion", core: &["golden_steps", "motion", "stepper", "mechanisms"], simulator: &[] },
    Room { name: "driver", core: &["driver"], simulator: &[] },
    Room { name: "settings", core: &["setting_ranges", "setting_rows", "storage", "mechanisms"], simulator: &[] },
    Room { name: "machine", core: &[], simulator: &["commands", "console", "paused", "pauses", "bed", "heat"] },
];

/// The mutants to try.
#[derive(clap::Args)]
pub struct Args {
    /// Only this room; it may be given several times.
    #[arg(long, value_name = "NAME", value_parser = ROOMS.map(|room| room.name))]
    room: Vec<String>,
    /// Only a part: 0/20 is the first, the 21st and so on.
    #[arg(long, value_name = "K/N", value_parser = shard)]
    shard: Option<(usize, usize)>,
    /// Number of parallel jobs.
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
}

fn shard(text: &str) -> Result<(usize, usize)> {
    let (part, parts) = text.split_once('/').context("not K/N")?;
    let (part, parts) = (part.parse()?, parts.parse()?);
    if part < parts { Ok((part, parts)) } else { bail!("{part} is not below {parts}") }
}

/// Inserts the faults and reports which were noticed.
pub fn main(args: &Args) -> Result<()> {
    let _alone = alone()?;
    let known = Survivors::known()?;
    let is_wanted = |room: &&Room| args.room.is_empty() || args.room.iter().any(|name| name == room.name);
    let rooms: Vec<&Room> = ROOMS.iter().filter(is_wanted).collect();
    let (copy, programs) = build(&rooms)?;
    let mut is_reached = true;
    println!("room       tried unviable caught survivors          seconds");
    for room in rooms {
        let start = Instant::now();
        let Outcome { tried, survivors, unviable } = try_room(room, &copy, &programs, args)?;
        let (caught, part) = (tried - survivors.len(), survivors.len() as f64 / tried.max(1) as f64);
        is_reached &= part <= GOAL;
        println!(
            "{:<10} {tried:>5} {unviable:>8} {caught:>6} {:>9} {:>6.1} % {:>7}",
            room.name,
            survivors.len(),
            100.0 * part,
            start.elapsed().as_secs(),
        );
        for mutant in survivors {
            println!("  {mutant}: {}", known.reason(&mutant).unwrap_or("NEW"));
        }
    }
    if is_reached { Ok(()) } else { bail!("more than {} % survived", 100.0 * GOAL) }
}

/// Makes sure that no other process changes the copy, as long as the file is held.
fn alone() -> Result<File> {
    let folder = target_dir()?.join("mutants");
    std::fs::create_dir_all(folder.join("copy")).with_context(|| format!("cannot make {}", folder.display()))?;
    let path = folder.join("lock");
    let file = File::create(&path).with_context(|| format!("cannot make {}", path.display()))?;
    file.try_lock().with_context(|| format!("mutants are being tried: {} is held", path.display()))?;
    Ok(file)
}

/// The results of the mutants of a room.
struct Outcome {
    tried: usize,
    survivors: Vec<String>,
    unviable: usize,
}

/// The begins of the names of the tests that check a room.
type Wanted = fn(&Room) -> Vec<String>;

/// A program of the core's or of the simulator's tests.
struct Built {
    path: PathBuf,
    folder: PathBuf,
    wanted: Wanted,
}

/// Builds all mutants of these rooms and the programs that test them.
fn build(rooms: &[&Room]) -> Result<(Copy, Vec<Built>)> {
    eprintln!("builds the mutants");
    let mut copy = Copy::of(&rooms.iter().map(|room| room.name).collect::<Vec<_>>())?;
    copy.leave_out_unviable()?;
    let programs: [(_, _, _, Wanted); 3] = [
        ("corehbot", "--lib", "", |room| names(&[room.name])),
        ("corehbot", "--test=core_tests", "", |room| names(room.core)),
        ("corehbot-sim", "--test=simulator", "sim/board", |room| names(room.simulator)),
    ];
    let mut built = Vec::new();
    for (package, program, folder, wanted) in programs {
        if rooms.iter().any(|room| !wanted(room).is_empty()) {
            built.push(Built { path: copy.build(package, program)?, folder: copy.folder().join(folder), wanted });
        }
    }
    Ok((copy, built))
}

fn names(modules: &[&str]) -> Vec<String> {
    modules.iter().map(|module| format!("{module}::")).collect()
}

/// Tries the mutants of a room.
fn try_room(room: &Room, copy: &Copy, built: &[Built], args: &Args) -> Result<Outcome> {
    let program = |built: &Built| Program {
        path: built.path.clone(),
        folder: built.folder.clone(),
        wanted: (built.wanted)(room),
    };
    let programs: Vec<Program> = built.iter().map(program).collect();
    let (mut mutants, unviable) = copy.mutants(room.name);
    if let Some((part, parts)) = args.shard {
        mutants =
            mutants.into_iter().enumerate().filter(|(n, _)| n % parts == part).map(|(_, mutant)| mutant).collect();
    }
    let (tests, others) = trial::tests(&programs, copy.folder(), args.jobs)?;
    others.iter().for_each(|test| eprintln!("  left out, as it takes long or fails in the copy: {test}"));
    eprintln!("{}: {} tests, {} mutants", room.name, tests.len(), mutants.len());
    let survivors = trial::survivors(&mutants, &tests, args.jobs)?;
    let name = |mutant: &&Mutant| mutant.name.clone();
    Ok(Outcome { tried: mutants.len(), survivors: survivors.iter().map(name).collect(), unviable })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_below_the_parts() {
        assert_eq!(shard("0/20").unwrap(), (0, 20));
        assert!(["1", "2/2", "0/0", "a/b"].iter().all(|text| shard(text).is_err()));
    }
}
