//! `cargo xtask test`: everything that must hold before a change goes in; CI runs the same.
//!
//! The steps share their builds: programs for this computer are built once, in the dev profile, like `cargo xtask`
//! itself. Lanes of steps go on side by side (see [`lane`]).

mod cargo;
mod copies;
mod demand;
mod doc_tests;
mod exchanges;
mod halt;
mod lane;
mod package;
mod size;
mod slowest;

use crate::extent::{ALL, is_all};
use crate::verdict::{Times, Verdict};
use crate::{bench, browser, checkout, clients, cluster, compare, processor, tools, usb};
use Lane::{Cable, Emulated, First, Host, Images, Last, Outside};
use anyhow::{Context as _, Result, bail};
use std::cmp::Reverse;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// Which steps to run.
#[derive(clap::Args)]
pub struct Args {
    /// Runs only the step of this name, after the tools that it may need.
    #[arg(long, value_name = "NAME", value_parser = STEPS.map(|step| step.name))]
    only: Option<String>,
    /// Runs tests in full that otherwise try a part of their cases, such as whole sliced files.
    #[arg(long)]
    all: bool,
    /// Runs only the steps of this lane, and leaves their results in a file.
    #[arg(long, hide = true, conflicts_with = "only", requires = "results")]
    lane: Option<Lane>,
    /// The file.
    #[arg(long, hide = true)]
    results: Option<PathBuf>,
}

/// A step of the test.
struct Step {
    name: &'static str,
    lane: Lane,
    heading: &'static str,
    run: fn() -> Result<Verdict>,
}

/// When a step runs.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Lane {
    /// Before all others.
    First,
    /// On this computer's own code. Its first step builds the programs that the other lanes use.
    Host,
    /// With real hosts and browsers, in parallel with [`Lane::Host`]: they wait for much of their time.
    Outside,
    /// Steps on images; they run in parallel with both.
    Images,
    /// The longest step on images, after the others.
    Emulated,
    /// In parallel with [`Lane::Emulated`], since it waits for most of its time.
    Cable,
    /// Alone, after all others: QEMU counts instructions, but its serial line brings bytes when this computer has time.
    Last,
}

impl Lane {
    /// Its word on the command line, and the name of its files.
    const fn name(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Host => "host",
            Self::Outside => "outside",
            Self::Images => "images",
            Self::Emulated => "emulated",
            Self::Cable => "cable",
            Self::Last => "last",
        }
    }
}

/// So many of the slowest tests are named at the end.
const NAMED: usize = 10;

/// The step that brings missing tools, which the others need.
const TOOLS: &str = "tools";

/// In each lane in this order, as quick steps should fail first.
const STEPS: [Step; 20] = [
    Step { name: TOOLS, lane: First, heading: "target, lints and emulator are there", run: tools::ensure },
    Step { name: "format", lane: First, heading: "rustfmt has nothing to change", run: cargo::format },
    Step { name: "build", lane: Host, heading: "programs and tests of this computer build", run: cargo::build },
    Step { name: "lint", lane: Host, heading: "clippy finds nothing", run: cargo::lint },
    Step { name: "doc", lane: Host, heading: "documentation builds without warnings", run: cargo::document },
    Step {
        name: "package",
        lane: Host,
        heading: "a program is built on the core as it is published",
        run: package::check,
    },
    Step { name: "host", lane: Host, heading: "tests on this computer", run: cargo::test },
    // Built in a folder of its own, while this computer's programs are built in theirs.
    Step {
        name: "wasm",
        lane: Outside,
        heading: "what is below the command builds for a browser",
        run: cargo::build_page,
    },
    Step { name: "browser", lane: Outside, heading: "pages work in a headless Chromium", run: browser::check },
    Step { name: "cluster", lane: Outside, heading: "a study outlives a worker that is killed", run: cluster::check },
    // By now the other lane has built QEMU's image.
    Step { name: "clients", lane: Outside, heading: "printcore and OctoPrint print on it", run: clients::check },
    Step { name: "boards", lane: Images, heading: "core and boards are linted and build", run: cargo::build_boards },
    Step { name: "size", lane: Images, heading: "the images keep their budgets", run: size::check },
    Step { name: "copies", lane: Images, heading: "QEMU copies memory as it is written", run: copies::check },
    Step { name: "qemu", lane: Images, heading: "QEMU steps as the simulator does", run: compare::check },
    Step { name: "exchange", lane: Images, heading: "QEMU answers hosts as it is written", run: exchanges::check },
    Step { name: "halt", lane: Images, heading: "QEMU stops at M112 within a millisecond", run: halt::check },
    Step {
        name: "emulate",
        lane: Emulated,
        heading: "the images for Octopus and Nucleo step as the simulator does",
        run: cargo::emulate,
    },
    Step { name: "usb", lane: Cable, heading: "Linux prints over USB on the Octopus's image", run: usb::check },
    Step { name: "bench", lane: Last, heading: "no figure of performance has got worse", run: bench::check },
];

/// Runs the steps; one that fails does not keep the others from running.
pub fn main(args: &Args) -> Result<()> {
    if args.all && !is_all() {
        let mut again = Command::new(std::env::current_exe().context("cannot find this program's own path")?);
        again.args(std::env::args_os().skip(1)).env(ALL, "1");
        return checkout::run(again);
    }
    let mut report = Report::default();
    if let Some(only) = &args.only {
        report.run(|step| step.name == only || step.name == TOOLS);
    } else if let (Some(lane), Some(results)) = (args.lane, &args.results) {
        report.run(|step| step.lane == lane);
        if lane == Images {
            let cable = lane::begin(Cable)?;
            report.run(|step| step.lane == Emulated);
            report.read(&cable.end()?)?;
        }
        return report.write(results);
    } else {
        report.run(|step| step.lane == First);
        let (images, outside) = (lane::begin(Images)?, lane::begin(Outside)?);
        report.run(|step| step.lane == Host);
        report.read(&outside.end()?)?;
        report.read(&images.end()?)?;
        report.run(|step| step.lane == Last);
    }
    report.print();
    if report.failed > 0 { bail!("not everything is well") } else { Ok(()) }
}

/// Time of a step.
#[derive(Clone, Copy, Default)]
struct Time {
    wall: Duration,
    /// Of all processors together, where the system tells it.
    processor: Option<Duration>,
}

impl std::fmt::Display for Time {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:>6.1} s", self.wall.as_secs_f64())?;
        self.processor.map_or(Ok(()), |time| write!(f, " {:>6.1} CPU-s", time.as_secs_f64()))
    }
}

/// The table at the end. Each test counts, and so does each step without tests of its own.
#[derive(Default)]
struct Report {
    rows: Vec<String>,
    times: Times,
    passed: u32,
    failed: u32,
}

impl Report {
    /// Runs some of the steps.
    fn run(&mut self, is_wanted: impl Fn(&Step) -> bool) {
        for step in STEPS.iter().filter(|step| is_wanted(step)) {
            println!("\n== {}: {}", step.name, step.heading);
            let (begin, taken) = (Instant::now(), processor::taken());
            let verdict = (step.run)();
            let time =
                Time { wall: begin.elapsed(), processor: processor::taken().zip(taken).map(|(now, then)| now - then) };
            self.add(step.name, verdict, time);
        }
    }

    /// Leaves the results in a file: how many passed and failed, the rows, and behind a tab the slowest tests.
    fn write(&self, path: &Path) -> Result<()> {
        let counts = format!("{} {}", self.passed, self.failed);
        let times: Vec<_> = self.slowest().map(|(name, taken)| format!("{}\t{name}", taken.as_millis())).collect();
        let text = [&[counts][..], &self.rows, &times].concat().join("\n");
        std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
    }

    /// Takes in the results that another process has left.
    fn read(&mut self, text: &str) -> Result<()> {
        let (counts, rows) = text.split_once('\n').context("no results of the images")?;
        let (passed, failed) = counts.split_once(' ').context("no counts of the images")?;
        self.passed += passed.parse::<u32>()?;
        self.failed += failed.parse::<u32>()?;
        for line in rows.lines() {
            match line.split_once('\t') {
                Some((taken, name)) => self.times.push((name.to_owned(), Duration::from_millis(taken.parse()?))),
                None => self.rows.push(line.to_owned()),
            }
        }
        Ok(())
    }

    fn add(&mut self, name: &str, verdict: Result<Verdict>, time: Time) {
        let (word, passed, failed, remark) = match verdict {
            Ok(Verdict::Passed(remark)) => ("ok", 1, 0, remark),
            Ok(Verdict::Tested { passed, failed, remark, times }) => {
                self.times.extend(times);
                (if failed == 0 { "ok" } else { "FAILED" }, passed, failed, remark)
            }
            Ok(Verdict::Skipped(reason)) => ("SKIPPED", 0, 0, reason),
            Err(error) => ("FAILED", 0, 1, format!("{error:#}")),
        };
        if failed > 0 {
            println!("FAILED: {remark}");
        }
        self.passed += passed;
        self.failed += failed;
        let remark = remark.lines().next().unwrap_or_default();
        self.rows.push(format!("{name:<8} {word:<8} {time}  {remark}"));
    }

    /// The slowest of all tests.
    fn slowest(&self) -> impl Iterator<Item = &(String, Duration)> {
        let mut all: Vec<_> = self.times.iter().collect();
        all.sort_by_key(|(_, taken)| Reverse(*taken));
        all.into_iter().take(NAMED)
    }

    fn print(&self) {
        let slowest: Vec<_> = self.slowest().collect();
        if !slowest.is_empty() {
            println!("\n== the slowest tests");
        }
        slowest.iter().for_each(|(name, taken)| println!("{:>6.1} CPU-s  {name}", taken.as_secs_f64()));
        println!("\n== result");
        for row in &self.rows {
            println!("{}", row.trim_end());
        }
        if let Some(taken) = processor::taken() {
            println!("the processors took {:.0} s", taken.as_secs_f64());
        }
        println!("{} passed, {} failed", self.passed, self.failed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_go_from_one_process_to_the_other() {
        let mut images = Report::default();
        let times = (1..=20).map(|second| (format!("a_{second}"), Duration::from_secs(second))).collect();
        let verdict = Verdict::Tested { passed: 5, failed: 1, remark: "one differs".into(), times };
        images.add("qemu", Ok(verdict), Time::default());
        images.add("size", Ok(Verdict::Passed(String::new())), Time::default());
        let path = std::env::temp_dir().join(format!("corehbot-results-{}", std::process::id()));
        images.write(&path).unwrap();
        let times = vec![("b".to_owned(), Duration::from_millis(19_500))];
        let mut all = Report { passed: 10, times, ..Report::default() };
        all.read(&std::fs::read_to_string(&path).unwrap()).unwrap();
        std::fs::remove_file(path).unwrap();
        let slowest: Vec<_> = all.slowest().map(|(name, _)| name.as_str()).collect();
        assert_eq!((slowest.len(), &slowest[..4]), (NAMED, &["a_20", "b", "a_19", "a_18"][..]));
        assert_eq!((all.passed, all.failed, all.rows), (16, 1, images.rows));
        assert!(Report::default().read("").is_err());
    }
}
