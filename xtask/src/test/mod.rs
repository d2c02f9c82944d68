//! `cargo xtask test`: everything that must hold before a change goes in; CI runs the same.
//!
//! The steps share what they build: host tests use the dev profile, everything else the release profile in
//! which `cargo xtask` itself is built.

mod cargo;
mod compare;
mod demand;
mod diff;
mod exchanges;
mod halt;
mod size;
mod tools;

pub use compare::{check_file, sliced_file};
pub use tools::{has_emulator, lack_of_emulator};

use crate::{bench, clients};
use anyhow::{Result, bail};
use std::time::{Duration, Instant};

/// Which steps to run.
#[derive(clap::Args)]
pub struct Args {
    /// Runs only the step of this name.
    #[arg(long, value_name = "NAME", value_parser = STEPS.map(|step| step.name))]
    only: Option<String>,
}

/// A step of the test.
struct Step {
    name: &'static str,
    heading: &'static str,
    run: fn() -> Result<Verdict>,
}

/// What a step found. A step that cannot even be carried out is an error, which counts as one failure.
pub enum Verdict {
    /// All is well.
    Passed(String),
    /// So many tests passed and failed.
    Tested { passed: u32, failed: u32, remark: String },
    /// It could not be done here, and why.
    Skipped(String),
}

/// In this order, as later steps need the tools of the first, and quick steps should fail first.
const STEPS: [Step; 13] = [
    Step { name: "tools", heading: "target, lints and emulator are there", run: tools::ensure },
    Step { name: "format", heading: "rustfmt has nothing to change", run: cargo::format },
    Step { name: "lint", heading: "clippy finds nothing, host and boards", run: cargo::lint },
    Step { name: "doc", heading: "documentation builds without warnings", run: cargo::document },
    Step { name: "host", heading: "tests on this computer", run: cargo::test },
    Step { name: "boards", heading: "core and boards build for the target", run: cargo::build_boards },
    Step { name: "size", heading: "the images keep their budgets", run: size::check },
    Step { name: "qemu", heading: "QEMU steps as the simulator does", run: compare::check },
    Step { name: "exchange", heading: "QEMU answers hosts as it is written", run: exchanges::check },
    Step { name: "halt", heading: "QEMU stops at M112 within a millisecond", run: halt::check },
    Step { name: "bench", heading: "no figure of performance has got worse", run: bench::check },
    Step { name: "emulate", heading: "the image for the Octopus steps as the simulator does", run: cargo::emulate },
    Step { name: "clients", heading: "printcore and OctoPrint print on it", run: clients::check },
];

/// Runs the steps; one that fails does not keep the others from running.
pub fn main(args: &Args) -> Result<()> {
    let mut report = Report::default();
    for step in STEPS.iter().filter(|step| args.only.as_deref().is_none_or(|only| only == step.name)) {
        println!("\n== {}: {}", step.name, step.heading);
        let begin = Instant::now();
        let verdict = (step.run)();
        report.add(step.name, verdict, begin.elapsed());
    }
    report.print();
    if report.failed > 0 { bail!("not everything is well") } else { Ok(()) }
}

/// The table at the end. Each test counts, and so does each step that is no collection of tests.
#[derive(Default)]
struct Report {
    rows: Vec<String>,
    passed: u32,
    failed: u32,
}

impl Report {
    fn add(&mut self, name: &str, verdict: Result<Verdict>, time: Duration) {
        let (word, passed, failed, remark) = match verdict {
            Ok(Verdict::Passed(remark)) => ("ok", 1, 0, remark),
            Ok(Verdict::Tested { passed, failed: 0, remark }) => ("ok", passed, 0, remark),
            Ok(Verdict::Tested { passed, failed, remark }) => ("FAILED", passed, failed, remark),
            Ok(Verdict::Skipped(reason)) => ("SKIPPED", 0, 0, reason),
            Err(error) => ("FAILED", 0, 1, format!("{error:#}")),
        };
        if failed > 0 {
            println!("FAILED: {remark}");
        }
        self.passed += passed;
        self.failed += failed;
        let remark = remark.lines().next().unwrap_or_default();
        self.rows.push(format!("{name:<8} {word:<8} {:>6.1} s  {remark}", time.as_secs_f64()));
    }

    fn print(&self) {
        println!("\n== result");
        for row in &self.rows {
            println!("{}", row.trim_end());
        }
        println!("{} passed, {} failed", self.passed, self.failed);
    }
}
