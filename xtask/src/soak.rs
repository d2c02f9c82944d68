//! `cargo xtask soak`: hours of simulated printing, and weeks of machine use. No guard may alarm, no switch may burn
//! anything, and no step may be lost. It also cuts the power while a machine is stored, and aligns belt motors. `cargo
//! xtask test` runs the same tests for a short time.

use crate::checkout::{cargo, run};
use crate::emulate;
use crate::images::build_image;
use anyhow::Result;
use clap::ValueEnum;

/// How long.
#[derive(clap::Args)]
pub struct Args {
    /// The parts to run; without them, everything.
    #[arg(value_enum)]
    parts: Vec<Part>,
    /// Simulated hours of prints with heat, each on a machine of its own.
    #[arg(long, value_name = "N", default_value_t = 100)]
    hours: u32,
    /// Simulated hours of machines that are used, two days each, and of accidents in such lives: one seed for each day.
    #[arg(long, value_name = "N", default_value_t = 672)]
    life_hours: u32,
    /// Simulated hours of motion, split over the wraps of all counters.
    #[arg(long, value_name = "N", default_value_t = 72)]
    motion_hours: u32,
    /// Segments of 1 to 20 um, half of them reversals.
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    segments: u32,
    /// Power cuts while a machine is stored on the emulated Octopus.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..))]
    cuts: u32,
    /// Number of machines with belt motors to align, and of machines with motors held until they skip.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..))]
    seeds: u32,
}

/// The parts of a soak.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
enum Part {
    Heat,
    Motion,
    Segments,
    Cuts,
    Belt,
}

/// Studies of the belt: alignment by load and by phases, skips, trust in a place, parts that break.
const BELT: [&str; 6] = [
    "aligned_motors",
    "a_machine_that_was_aligned_once",
    "a_single_skip",
    "a_place_that_is_said",
    "a_place_is_trusted",
    "parts_that_break",
];

/// Runs the long forms.
pub fn main(args: &Args) -> Result<()> {
    let parts = if args.parts.is_empty() { Part::value_variants() } else { &args.parts };
    for part in parts {
        match part {
            Part::Heat => {
                run(test(
                    "corehbot",
                    "core_tests",
                    &["faults::quiet", "f10", "loose::healthy", "loose::low"],
                    "HOURS",
                    args.hours,
                ))?;
                run(test("corehbot-sim", "simulator", &["heat_lives::"], "HOURS", args.life_hours))?;
            }
            Part::Motion => run(test("corehbot-sim", "simulator", &["soak::"], "HOURS", args.motion_hours))?,
            Part::Segments => run(test("corehbot-sim", "simulator", &["absurd::f52"], "SEGMENTS", args.segments))?,
            Part::Cuts => cuts(args.cuts)?,
            Part::Belt => run(test("corehbot-sim", "simulator", &BELT, "SEEDS", args.seeds))?,
        }
    }
    Ok(())
}

/// The tests of these names, so much longer.
fn test(package: &str, file: &str, names: &[&str], what: &str, amount: u32) -> std::process::Command {
    let (package, file) = (format!("--package={package}"), format!("--test={file}"));
    let mut test = cargo(["test", "--release", &package, &file, "--", "--nocapture"]);
    test.args(names).env(format!("COREHBOT_SOAK_{what}"), amount.to_string());
    test
}

fn cuts(number: u32) -> Result<()> {
    let mut cuts = emulate::cargo(["test"], &["--test=images"]);
    cuts.args(["--", "--nocapture", "machines::a_power_cut"]);
    cuts.env("COREHBOT_ELF", build_image(emulate::Board::Octopus.package())?)
        .env("COREHBOT_SOAK_CUTS", number.to_string());
    run(cuts)
}
