//! `twin compensate`: a step trace whose motors go ahead by what the tool would lag behind.

use super::answer::Json;
use super::setup::MachineArgs;
use super::source::Source;
use crate::cli::parse_place;
use anyhow::{Context as _, Result, bail};
use clap::Args;
use corehbot::units::Mm;
use corehbot_twin::compensation::compensate;
use corehbot_twin::geometry::workspace;
use corehbot_twin::routing::Place;
use corehbot_twin::steps::csv;
use serde::Serialize;
use std::io::{BufRead as _, Write as _};
use std::path::PathBuf;

/// `twin compensate`.
#[derive(Args)]
pub(crate) struct Compensate {
    /// A step trace (corehbot run --trace).
    #[arg(value_name = "TRACE.csv")]
    file: PathBuf,
    /// Where the compensated trace goes.
    #[arg(short, long, value_name = "OUT.csv")]
    output: PathBuf,
    #[command(flatten)]
    machine: MachineArgs,
    /// Where the firmware began, in G-code's coordinates, as `run` has it; without it, where the simulator switches it on.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true)]
    assume_homed: Option<[Mm; 3]>,
    /// Over how many ms (standard deviation of a Gaussian) the path is smoothed before its acceleration is taken.
    #[arg(long, value_name = "MS", value_parser = parse_width, default_value = "1")]
    smooth: f64,
    #[command(flatten)]
    json: Json,
}

/// What was done.
#[derive(Serialize)]
struct Answer {
    /// The most that the tool is sent ahead, along x and y.
    ahead_um: [f64; 2],
    /// Instants of steps before and after.
    events: [usize; 2],
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([x, y], [before, after]) = (self.ahead_um, self.events);
        writeln!(f, "The tool is sent ahead by {x:.1} um in x and {y:.1} um in y at most.")?;
        writeln!(f, "{before} instants of steps became {after}.")
    }
}

impl Compensate {
    pub(super) fn answer(&self) -> Result<u8> {
        let file = self.file.display().to_string();
        let (machine, params) = self.machine.read()?;
        let Some(trace) = Source::trace(&self.file)? else {
            bail!("{file} is no step trace; `corehbot run FILE --trace T.csv` makes one");
        };
        let [x, y, _] = self.assume_homed.unwrap_or(corehbot_rig::AT_POWER_UP).map(|mm| mm.to_num::<f64>());
        let origin = workspace(machine, &params).origin();
        let start = Place { x: origin.x + x, y: origin.y + y };
        let compensated =
            compensate(machine, &params, start, &trace, self.smooth / 1000.0).with_context(|| file.clone())?;
        let answer = Answer {
            ahead_um: compensated.ahead_mm.map(|mm| 1000.0 * mm),
            events: [trace.events.len(), compensated.steps.events.len()],
        };
        let head = self.head()?;
        self.json.give_with(&answer, self.machine.files().chain([self.file.as_path()]), |outputs| {
            let mut out = outputs.open(&self.output)?;
            let mut write = || -> std::io::Result<()> {
                out.write_all(head.as_bytes())?;
                csv::write_rows(&compensated.steps, &mut out)?;
                out.flush()
            };
            write().context("cannot write the trace")
        })
    }

    /// Comments and the names of the motors, as they are.
    fn head(&self) -> Result<String> {
        let file = std::fs::File::open(&self.file).with_context(|| format!("cannot open {}", self.file.display()))?;
        let mut lines = std::io::BufReader::new(file).lines();
        let mut head = String::new();
        loop {
            let Some(line) = lines.next().transpose()? else { return Ok(head) };
            head.push_str(&line);
            head.push('\n');
            if !line.starts_with('#') {
                return Ok(head);
            }
        }
    }
}

fn parse_width(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| (0.3..=20.0).contains(v));
    legal.ok_or_else(|| format!("`{text}` is no width from 0.3 to 20 ms"))
}
