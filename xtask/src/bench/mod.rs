//! `cargo xtask bench`: the cost of the firmware, instruction by instruction.
//!
//! The firmware prints a few jobs in QEMU while a plugin counts every instruction, with its place and its context.
//! docs/explanation/performance.md describes the results and their accuracy.

mod access;
mod check;
mod contexts;
mod cycles;
mod figures;
mod host;
mod jobs;
mod last_resort;
mod octopus;
mod plugin;
mod profile;
mod report;
mod rooms;
mod simulator;
mod waits;

use crate::build;
use crate::checkout;
use crate::image_code::Code;
use crate::images;
use crate::qemu::BOARD;
use crate::tools;
use crate::verdict::Verdict;
use anyhow::{Context as _, Result};
use figures::Figure;
use jobs::Job;
use octopus::PlainStep;
use plugin::Plugin;
use profile::Profile;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The board with the step interrupt that is counted too.
const OCTOPUS: &str = "corehbot-octopus";

/// Options of the measurement.
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
    /// Measures the simulator on this computer instead: how many times faster than the machine it prints these files,
    /// or the examples, and where its instructions go.
    #[arg(long, value_name = "FILE", num_args = 0.., conflicts_with_all = ["json", "check", "profile"])]
    host: Option<Vec<PathBuf>>,
}

/// Measures.
pub fn main(args: &Args) -> Result<()> {
    if let Some(files) = &args.host {
        return simulator::main(files);
    }
    let bench = Bench::prepare()?;
    if let Some(job) = args.profile {
        return report::print_profile(job, &bench.measure(job)?, &bench.code()?);
    }
    let figures = bench.figures()?;
    report::print_figures(&figures);
    if let Some(path) = &args.json {
        check::write(&figures, path)?;
    }
    if args.check {
        check::compare(&figures, &checkout::root().join(check::BASELINE))?;
    }
    Ok(())
}

/// As a step of the test: no figure is worse than the committed one.
pub fn check() -> Result<Verdict> {
    if !tools::has_emulator() {
        return Ok(Verdict::Skipped(tools::lack_of_emulator()));
    }
    let compiler = checkout::version_of_compiler()?;
    if !compiler.starts_with(check::COMPILER) {
        return Ok(Verdict::Skipped(format!("the figures were made by {}, and this is {compiler}", check::COMPILER)));
    }
    let (bench, baseline) = (Bench::prepare()?, checkout::root().join(check::BASELINE));
    let mut figures = bench.figures()?;
    if let Err(complaint) = check::compare(&figures, &baseline) {
        // Figures that depend on the host change when other programs take its time; a real loss shows twice.
        println!("{complaint}; measured once more");
        figures = bench.figures()?;
        check::compare(&figures, &baseline)?;
    }
    Ok(Verdict::Passed(format!("{} figures", figures.iter().filter(|figure| figure.is_steady).count())))
}

/// The inputs of a measurement.
struct Bench {
    image: PathBuf,
    elf: Vec<u8>,
    octopus: PlainStep,
    last_resort: usize,
    counted: last_resort::Counts,
    plugin: Plugin,
    folder: PathBuf,
}

impl Bench {
    fn prepare() -> Result<Self> {
        let image = images::build_image(BOARD)?;
        let elf = std::fs::read(&image).with_context(|| format!("cannot open {}", image.display()))?;
        let octopus = images::build_image(OCTOPUS)?;
        let octopus = std::fs::read(&octopus).with_context(|| format!("cannot open {}", octopus.display()))?;
        let last_resort = build::last_resort(&octopus)?;
        let folder = checkout::target_dir()?.join("bench");
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        let counted = last_resort::measure(&octopus, &folder)?;
        let octopus = PlainStep::of(&Code::read(&octopus)?)?;
        let plugin = Plugin::prepare(&Code::read(&elf)?, &octopus, &folder)?;
        Ok(Self { image, elf, octopus, last_resort, counted, plugin, folder })
    }

    fn code(&self) -> Result<Code<'_>> {
        Code::read(&self.elf)
    }

    fn measure(&self, job: Job) -> Result<Profile> {
        Profile::of(job, &self.image, &self.code()?, &self.plugin, &self.folder)
            .with_context(|| format!("the job {job} failed"))
    }

    fn figures(&self) -> Result<Vec<Figure>> {
        let profiles: BTreeMap<_, _> =
            Job::ALL.into_iter().map(|job| Ok((job, self.measure(job)?))).collect::<Result<_>>()?;
        let mut figures = figures::figures(&profiles, &self.octopus, &self.code()?)?;
        figures.extend(figures::of_last_resort(self.last_resort, self.counted));
        Ok(figures)
    }
}
