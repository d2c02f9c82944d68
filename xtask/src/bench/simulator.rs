//! The simulator's own speed: how many times faster than the machine it prints, and where its instructions go.
//!
//! The ratio depends on the computer. The shares do not: valgrind counts the instructions of one print, thread by
//! thread, and its processor has no SHA extensions. They differ by a permille from run to run.

use crate::checkout::{cargo, command_output, root, run, target_dir};
use anyhow::{Context as _, Result, bail, ensure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The print whose instructions are counted: short, because valgrind takes fifty times as long.
const COUNTED: &str = "examples/first-print.gcode";

/// Each print is timed so often, and the best time counts: others disturb a run, and none makes it faster.
const RUNS: usize = 10;

/// A stage: its name, and parts of the names of its functions.
type Stage = (&'static str, &'static [&'static str]);

/// The stages of the sinks. Each is a function that is called once for a batch of events
/// (`cli/src/recorder_threads.rs`), or, the digest, for 64 KiB of rows.
const DIGEST: Stage = ("digest of the trace", &["TraceWriter", "flush"]);
const ROWS: Stage = ("rows of the trace", &["Writers", "write_rows"]);
const STAGES: [Stage; 2] = [("figures and checks", &["Judges", "judge"]), ("tool path", &["Judges", "follow"])];

/// Measures.
pub fn main(files: &[PathBuf]) -> Result<()> {
    run(cargo(["build", "--release", "--package", "corehbot-cli"]))?;
    let program = target_dir()?.join("release/corehbot").with_extension(std::env::consts::EXE_EXTENSION);
    let files = if files.is_empty() { examples()? } else { files.to_vec() };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!("Best of {RUNS} runs on {cores} processors:");
    println!("{:<40} {:>12} {:>10} {:>10} {:>12}", "file", "printed in s", "here in s", "ratio", "with report");
    for file in &files {
        let [printed, here] = best(&program, file, &[])?;
        let [_, reported] = best(&program, file, &["--report", "/dev/null"])?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        println!("{name:<40} {printed:>12.1} {here:>10.3} {:>10.0} {:>12.0}", printed / here, printed / reported);
    }
    print_shares(&program)
}

/// The ordinary examples.
fn examples() -> Result<Vec<PathBuf>> {
    let folder = root().join("examples");
    let entries = std::fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let mut files = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    files.retain(|file| file.extension().is_some_and(|extension| extension == "gcode"));
    files.sort();
    Ok(files)
}

/// The print's time on the machine, and the least time that it took here, in s.
fn best(program: &Path, file: &Path, args: &[&str]) -> Result<[f64; 2]> {
    let mut times = [f64::INFINITY; 2];
    for _ in 0..RUNS {
        let mut print = Command::new(program);
        print.arg("run").arg(file).args(["--json", "-"]).args(args);
        let summary: serde_json::Value = serde_json::from_str(&command_output(print)?)?;
        let [printed, here] = ["print_time_s", "wall_time_s"].map(|key| summary[key].as_f64());
        times = [printed.context("no print time")?, here.context("no time")?.min(times[1])];
    }
    Ok(times)
}

/// Counts the instructions of a print by stages.
fn print_shares(program: &Path) -> Result<()> {
    let out = target_dir()?.join("bench");
    std::fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
    let out = out.join("simulator.callgrind");
    let mut count = Command::new("valgrind");
    count.args(["--tool=callgrind", "--quiet"]).arg(format!("--callgrind-out-file={}", out.display()));
    count.arg(program).arg("run").arg(root().join(COUNTED)).args(["--json", "-", "--report", "/dev/null"]);
    let output = count.output();
    let output = output.context("valgrind counts the instructions: apt-get install valgrind")?;
    ensure!(output.status.success(), "valgrind failed: {}", String::from_utf8_lossy(&output.stderr).trim());
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let events = summary["events"].as_f64().context("no events")?;
    let calls = Calls::read(&std::fs::read_to_string(&out).with_context(|| format!("no {}", out.display()))?)?;
    let (digest, rows) = (calls.of(DIGEST)?, calls.of(ROWS)?);
    // The rows call the digest, but for the last chunk, which `finish` calls.
    let mut stages = vec![(DIGEST.0, digest), (ROWS.0, rows.saturating_sub(digest))];
    for stage in STAGES {
        stages.push((stage.0, calls.of(stage)?));
    }
    let rest = calls.total - stages.iter().map(|(_, count)| count).sum::<u64>();
    stages.push(("firmware, machine, host, report", rest));
    println!("\nInstructions of {COUNTED} with a report, {events} events:");
    for (name, count) in stages {
        let (share, each) = (100.0 * count as f64 / calls.total as f64, count as f64 / events);
        println!("{name:<40} {share:>6.1} % {each:>8.1} an event");
    }
    println!("{:<40} {:>6.1} % {:>8.1} an event", "all", 100.0, calls.total as f64 / events);
    Ok(())
}

/// Instructions in the calls of each function, from a file of callgrind.
#[derive(Default)]
struct Calls {
    total: u64,
    /// By the function's name: with all that it called.
    inclusive: BTreeMap<String, u64>,
}

impl Calls {
    /// Format: <https://valgrind.org/docs/manual/cl-format.html>. A name is written once, with a number in brackets
    /// that stands for it later. The line after `calls=` has the cost of these calls.
    fn read(text: &str) -> Result<Self> {
        let (mut calls, mut names) = (Self::default(), BTreeMap::new());
        let (mut callee, mut is_call) = ("", false);
        for line in text.lines() {
            if let Some(name) = line.strip_prefix("fn=").or_else(|| line.strip_prefix("cfn=")) {
                let (number, name) = name.split_once(' ').unwrap_or((name, ""));
                let name = if name.is_empty() { *names.get(number).unwrap_or(&"") } else { name };
                names.insert(number, name);
                if line.starts_with('c') {
                    callee = name;
                }
            } else if let Some(total) = line.strip_prefix("totals:") {
                calls.total = total.trim().parse()?;
            } else if std::mem::replace(&mut is_call, line.starts_with("calls=")) {
                let cost = line.split_whitespace().nth(1).with_context(|| format!("a call without a cost: {line}"))?;
                *calls.inclusive.entry(callee.to_owned()).or_default() += cost.parse::<u64>()?;
            }
        }
        ensure!(calls.total > 0, "callgrind has counted nothing");
        Ok(calls)
    }

    /// The instructions of a stage.
    fn of(&self, (stage, parts): Stage) -> Result<u64> {
        let own = self.inclusive.iter().filter(|(name, _)| parts.iter().all(|part| name.contains(part)));
        let counts: Vec<_> = own.map(|(_, count)| *count).collect();
        match counts[..] {
            [] => bail!("{stage}: no function of this name was called"),
            _ => Ok(counts.iter().sum()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_of_calls_are_added_by_the_callee() {
        let text = "version: 1\nevents: Ir\n\nfn=(1) main\n10 5\ncfn=(2) <a::Judges>::judge\ncalls=3 20\n11 300\n+1 7\n\
                    cfn=(3) <a::Writers>::write_rows\ncalls=1 30\n* 40\n\nfn=(2)\n20 300\n\nfn=(4) other\n1 1\ncfn=(2)\n\
                    calls=1 20\n-1 50\n\ntotals: 703\n";
        let calls = Calls::read(text).unwrap();
        assert_eq!(calls.total, 703);
        assert_eq!(calls.of(STAGES[0]).unwrap(), 350);
        assert_eq!(calls.of(ROWS).unwrap(), 40);
        assert!(calls.of(STAGES[1]).is_err());
    }
}
