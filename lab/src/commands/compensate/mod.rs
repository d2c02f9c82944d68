//! `corehbot-lab compensate`: compensates G-code, or a step trace, for the tool's lag in advance.

mod gcode;
mod measure;
mod sections;

use crate::compensation::{Compensated, compensate};
use anyhow::{Context as _, Result, ensure};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::input::{self, Plate};
use corehbot_host::printer::Printer;
use corehbot_host::say::note;
use corehbot_host::stop::Stop;
use corehbot_questions::play::RunModel;
use corehbot_questions::setup::MachineArgs;
use corehbot_questions::source::Source;
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::steps::{StepTrace, csv};
use gcode::Played;
use measure::Measured;
use serde::Serialize;
use std::io::{BufRead as _, Write as _};
use std::path::{Path, PathBuf};

/// `corehbot-lab compensate`.
#[derive(Args)]
pub(crate) struct Compensate {
    /// G-code, or a step trace (corehbot run --trace).
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    plate: Plate,
    /// Where the compensated G-code goes, or trace if the file is one.
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    printer: Printer,
    /// Over how many ms (standard deviation of a Gaussian) the path is smoothed before its acceleration is taken.
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = parse_width, default_value = "1")]
    smooth: f64,
    /// Plays both on the machine with rotors, with the believed values and with belts and fields 20 % off, and reports
    /// the remaining error.
    #[arg(long)]
    measure: bool,
    /// Parts that move besides the tool in the measurement.
    #[arg(long, value_enum, default_value = "rotors", requires = "measure")]
    run_model: RunModel,
    #[command(flatten)]
    json: Json,
}

/// The result.
#[derive(Serialize)]
struct Answer {
    /// The most that the tool is sent ahead, along x and y.
    ahead_um: [f64; 2],
    /// Instants of steps before and after.
    events: [usize; 2],
    /// Moves of the G-code that was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    chords: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    measured: Option<Measured>,
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([x, y], [before, after]) = (self.ahead_um, self.events);
        writeln!(f, "The tool is sent ahead by {x:.1} um in x and {y:.1} um in y at most.")?;
        if let Some(chords) = self.chords {
            writeln!(f, "{chords} moves were written.")?;
        }
        writeln!(f, "{before} instants of steps became {after}.")?;
        self.measured.iter().try_for_each(|measured| write!(f, "{measured}"))
    }
}

/// A compensated file: its text, its steps, their number with homing, and the greatest lead.
struct Done {
    text: Vec<u8>,
    steps: StepTrace,
    events: usize,
    ahead_mm: [f64; 2],
    chords: Option<usize>,
}

/// The input to compensate.
enum Given {
    Trace(StepTrace),
    Gcode(Box<Played>),
}

impl Given {
    const fn steps(&self) -> &StepTrace {
        match self {
            Self::Trace(steps) => steps,
            Self::Gcode(played) => &played.steps,
        }
    }
}

impl Compensate {
    pub(crate) fn answer(&self) -> Result<u8> {
        let (machine, params) = self.machine.read(&self.printer.machine()?)?;
        ensure!(!machine.lifts(), "the tool's lag is known in x and y only: belts that lift it are not compensated");
        let inputs = || self.printer.files().chain([self.file.as_path()]);
        self.json.check(inputs(), [&self.output])?;
        let stop = Stop::at_signals()?;
        let told = self.told(machine, &params, &stop).with_context(|| self.file.display().to_string());
        if let Some(status) = stop.status() {
            note(format_args!("corehbot: interrupted"));
            return Ok(status);
        }
        let (answer, text) = told?;
        self.json.give_with(&answer, inputs(), |outputs| {
            let mut out = outputs.open(&self.output)?;
            out.write_all(&text).and_then(|()| out.flush()).context("cannot write what was compensated")
        })
    }

    fn told(&self, machine: Machine, params: &Params, stop: &Stop) -> Result<(Answer, Vec<u8>)> {
        let given = match Source::trace(&self.file)? {
            Some(trace) => Given::Trace(trace),
            None => Given::Gcode(Box::new(Played::new(&input::read(&self.file, self.plate)?, &self.printer, stop)?)),
        };
        let start = self.start(machine, params);
        let done = self.done(&given, (machine, params), start, stop)?;
        let measured = if self.measure {
            let bent = |believed: &Params| Ok(self.done(&given, (machine, believed), start, stop)?.steps);
            let (meant, begin) = match &given {
                Given::Trace(steps) => (steps.clone(), start),
                Given::Gcode(played) => played.after_homing(&played.steps, played.ends(), start),
            };
            Some(Measured::new((machine, params, self.run_model), begin, &meant, &done.steps, bent, stop)?)
        } else {
            None
        };
        let events = [given.steps().events.len(), done.events];
        let ahead_um = done.ahead_mm.map(|mm| 1000.0 * mm);
        Ok((Answer { ahead_um, events, chords: done.chords, measured }, done.text))
    }

    fn done(&self, given: &Given, machine: (Machine, &Params), start: Place, stop: &Stop) -> Result<Done> {
        let width_s = self.smooth / 1000.0;
        match given {
            Given::Trace(trace) => {
                let compensated = compensate(machine.0, machine.1, start, trace, width_s)?;
                let mut text = head(&self.file)?.into_bytes();
                csv::write_rows(&compensated.steps, &mut text)?;
                let Compensated { steps, ahead_mm } = compensated;
                Ok(Done { text, events: steps.events.len(), steps, ahead_mm, chords: None })
            }
            Given::Gcode(played) => {
                let compensated = played.compensated(machine, start, width_s)?;
                let (steps, ends) = gcode::run(&compensated.text, &self.printer, stop)?;
                let events = steps.events.len();
                // Homing is as it was.
                let (steps, _) = played.after_homing(&steps, &ends, start);
                let gcode::Compensated { text, ahead_mm, chords } = compensated;
                Ok(Done { text: text.into_bytes(), steps, events, ahead_mm, chords: Some(chords) })
            }
        }
    }

    fn start(&self, machine: Machine, params: &Params) -> Place {
        let begin = self.printer.assume_homed.unwrap_or(corehbot_rig::AT_POWER_UP).map(|mm| mm.to_num::<f64>());
        workspace(machine, params).of_gcode(begin)
    }
}

/// Comments of a trace and the names of the motors, as they are.
fn head(file: &Path) -> Result<String> {
    let file = std::fs::File::open(file).with_context(|| format!("cannot open {}", file.display()))?;
    let mut head = String::new();
    for line in std::io::BufReader::new(file).lines() {
        let line = line?;
        head.extend([&line, "\n"]);
        if !line.starts_with('#') {
            break;
        }
    }
    Ok(head)
}

fn parse_width(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| (0.3..=20.0).contains(v));
    legal.ok_or_else(|| format!("`{text}` is not a width from 0.3 to 20 ms"))
}
