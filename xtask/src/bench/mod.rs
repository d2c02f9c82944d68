//! `cargo xtask bench`: what the firmware takes, instruction by instruction.
//!
//! The firmware prints a few jobs in QEMU while a plugin counts every instruction, where it was and who was running.
//! What the counts come down to, and what they are worth, is in docs/performance.md.

mod check;
mod code;
mod contexts;
mod cycles;
mod figures;
mod host;
mod jobs;
mod plugin;
mod profile;
mod report;
mod rooms;

use crate::checkout;
use crate::qemu::BOARD;
use anyhow::{Context as _, Result};
use code::Code;
use jobs::Job;
use plugin::Plugin;
use profile::Profile;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What to measure.
#[derive(clap::Args)]
pub struct Args {
    /// Writes the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Fails if a figure is more than 3 % worse than the committed one.
    #[arg(long)]
    check: bool,
    /// Runs this job alone and shows where its instructions go.
    #[arg(long, value_name = "JOB", conflicts_with_all = ["json", "check"])]
    profile: Option<Job>,
}

/// Measures.
pub fn main(args: &Args) -> Result<()> {
    let image = checkout::build_image(BOARD)?;
    let elf = std::fs::read(&image).with_context(|| format!("cannot open {}", image.display()))?;
    let code = Code::read(&elf)?;
    let folder = checkout::target_dir()?.join("bench");
    let plugin = Plugin::prepare(&code, &folder)?;
    let measure =
        |job: Job| Profile::of(job, &image, &code, &plugin, &folder).with_context(|| format!("the job {job} failed"));
    if let Some(job) = args.profile {
        return report::print_profile(job, &measure(job)?, &code);
    }
    let profiles: BTreeMap<_, _> = Job::ALL.into_iter().map(|job| Ok((job, measure(job)?))).collect::<Result<_>>()?;
    let figures = figures::figures(&profiles)?;
    report::print_figures(&figures);
    if let Some(path) = &args.json {
        check::write(&figures, path)?;
    }
    if args.check {
        check::compare(&figures, &checkout::root().join(check::BASELINE))?;
    }
    Ok(())
}
