//! `cargo xtask soak`: hours of simulated printing in which no guard may alarm, no switch may burn anything, and no step may be
//! lost, and power cuts while a machine is stored. `cargo xtask test` runs the same tests for a short time.

use crate::checkout::{build_image, cargo, run};
use crate::emulate;
use anyhow::Result;

/// How long.
#[derive(clap::Args)]
pub struct Args {
    /// Simulated hours of prints with heat, each on a machine of its own.
    #[arg(long, value_name = "N", default_value_t = 100)]
    hours: u32,
    /// Simulated hours of motion, split over the wraps of all counters.
    #[arg(long, value_name = "N", default_value_t = 72)]
    motion_hours: u32,
    /// Segments of 1 to 20 um, half of them reversals.
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    segments: u32,
    /// Power cuts while a machine is stored on the emulated Octopus.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..))]
    cuts: u32,
}

/// Runs the long forms.
pub fn main(args: &Args) -> Result<()> {
    let mut heat =
        cargo(["test", "--release", "--package=corehbot", "--test=faults", "--", "--nocapture", "quiet", "f10"]);
    heat.env("COREHBOT_SOAK_HOURS", args.hours.to_string());
    run(heat)?;
    let mut motion = cargo(["test", "--release", "--package=corehbot-sim", "--test=soak", "--", "--nocapture"]);
    motion.env("COREHBOT_SOAK_HOURS", args.motion_hours.to_string());
    run(motion)?;
    let mut segments =
        cargo(["test", "--release", "--package=corehbot-sim", "--test=absurd", "--", "--nocapture", "f52"]);
    segments.env("COREHBOT_SOAK_SEGMENTS", args.segments.to_string());
    run(segments)?;
    let mut cuts = emulate::cargo(["test"], &["--release", "--ignore-rust-version", "--test=machines"]);
    cuts.args(["--", "--nocapture", "a_power_cut"]);
    cuts.env("COREHBOT_ELF", build_image(emulate::Board::Octopus.package())?)
        .env("COREHBOT_SOAK_CUTS", args.cuts.to_string());
    run(cuts)
}
