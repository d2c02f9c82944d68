//! Command line: what `corehbot` understands, and with which status it ends.
//!
//! 0: the print was done and its steps are sound. 1: it was not. 2: nothing was printed, because the command
//! line, a file or the settings are wrong.

use crate::check::Checker;
use crate::eeprom::Eeprom;
use crate::host::FileHost;
use crate::limits::Limits;
use crate::machine_file::{self, Machine};
use crate::report;
use crate::summary::{Names, Summary};
use crate::tally::{Figures, Tally};
use crate::trace::TraceWriter;
use crate::vcd::VcdWriter;
use crate::world::{self, Host, Outcome, Sink};
use anyhow::{Context, Result};
use clap::{Args, Parser, Subcommand};
use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use indicatif::{ProgressBar, ProgressStyle};
use std::fs::File;
use std::io::{BufWriter, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// The print failed.
const FAILED: u8 = 1;

/// Said of a file with M92, whose steps have two sizes.
const UNITS_CHANGED: &str = "M92 changes the steps: speeds and paths are shown in the old unit and not judged";

/// Nothing was printed; clap ends with the same status.
const UNUSABLE: u8 = 2;

/// The CoreH-bot firmware on this computer: prints G-code on a simulated machine.
#[derive(Parser)]
#[command(name = "corehbot", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Prints a G-code file and checks every step.
    Run(Run),
}

#[derive(Args)]
struct Run {
    /// G-code file, `-` for standard input.
    file: PathBuf,
    /// Writes every step event as CSV.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
    /// Writes every step event as VCD, for GTKWave and PulseView.
    #[arg(long, value_name = "T.vcd")]
    vcd: Option<PathBuf>,
    /// Writes the summary as JSON.
    #[arg(long, value_name = "S.json")]
    json: Option<PathBuf>,
    /// Writes a page with the tool path and curves of speed and load.
    #[arg(long, value_name = "R.html")]
    report: Option<PathBuf>,
    /// The machine; without it, the CoreH-bot prototype.
    #[arg(long, value_name = "M.toml")]
    settings: Option<PathBuf>,
    /// Keeps settings (M500) in this 4 KiB image of an EEPROM, which is created if it does not exist.
    #[arg(long, value_name = "E.bin")]
    storage: Option<PathBuf>,
    /// Starts as if homed, with the tool at this place in mm.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true)]
    assume_homed: Option<[Mm; 3]>,
}

/// Runs the command that the process was called with.
#[must_use]
pub fn main() -> ExitCode {
    let Cli { command: Command::Run(args) } = Cli::parse();
    match Prepared::new(&args) {
        Ok(prepared) => match prepared.run(&args) {
            Ok(true) => ExitCode::SUCCESS,
            Ok(false) => ExitCode::from(FAILED),
            Err(error) => complain(&error, FAILED),
        },
        Err(error) => complain(&error, UNUSABLE),
    }
}

fn complain(error: &anyhow::Error, status: u8) -> ExitCode {
    eprintln!("corehbot: {error:#}");
    ExitCode::from(status)
}

/// Three numbers that a machine of any size might hold; whether this one does is the firmware's to say.
fn parse_place(text: &str) -> Result<[Mm; 3], String> {
    let mut numbers = text.split(',').map(|part| match part.trim().parse::<f64>() {
        Ok(v) if v.abs() <= 5000.0 => Ok(Mm::from_num(v)),
        _ => Err(format!("`{part}` is no position in mm")),
    });
    let mut next = || numbers.next().unwrap_or_else(|| Err("three numbers are wanted: X,Y,Z".to_owned()));
    let place = [next()?, next()?, next()?];
    if numbers.next().is_some() { Err("three numbers are wanted: X,Y,Z".to_owned()) } else { Ok(place) }
}

/// Everything that can be wrong before the print begins.
struct Prepared {
    name: String,
    gcode: String,
    machine: Machine,
    eeprom: Option<Eeprom>,
    trace: Option<BufWriter<File>>,
    vcd: Option<VcdWriter<BufWriter<File>>>,
}

impl Prepared {
    fn new(args: &Run) -> Result<Self> {
        let machine = read_machine(args.settings.as_deref())?;
        let (name, gcode) = read_gcode(&args.file)?;
        let eeprom = args.storage.as_deref().map(Eeprom::open).transpose()?;
        let trace = args.trace.as_deref().map(create).transpose()?;
        let vcd = match args.vcd.as_deref() {
            Some(path) => Some(VcdWriter::new(create(path)?).with_context(|| cannot("write", path))?),
            None => None,
        };
        // These are written at the end; a typing error should show now.
        for path in [&args.json, &args.report].into_iter().flatten() {
            create(path)?;
        }
        Ok(Self { name, gcode, machine, eeprom, trace, vcd })
    }

    /// Prints, and says whether all went well.
    fn run(mut self, args: &Run) -> Result<bool> {
        let settings = &self.machine.settings;
        let stored = self.eeprom.as_mut().and_then(Eeprom::settings);
        let mut host = Watched { host: FileHost::new(&self.gcode), bar: ProgressBar::hidden() };
        if std::io::stderr().is_terminal() {
            host.bar = progress_bar(host.host.commands());
        }
        let limits = Limits::new(settings, stored.as_ref(), &self.gcode);
        let mut sinks = Sinks {
            trace: TraceWriter::new(self.trace, settings.into()),
            vcd: self.vcd,
            tally: Tally::new(settings, args.assume_homed.unwrap_or(corehbot_rig::AT_POWER_UP).map(Mm::to_num)),
            checker: Checker::new(&limits),
        };
        let start = Instant::now();
        let outcome = match &mut self.eeprom {
            Some(eeprom) => world::run_with(settings, args.assume_homed, eeprom, &mut [&mut host], &mut sinks),
            None => world::run(settings, args.assume_homed, &mut host, &mut sinks),
        };
        host.bar.finish_and_clear();
        let outcome = outcome.with_context(|| format!("{}: the simulation failed", self.name))?;
        let names = Names { file: &self.name, machine: self.machine.name.as_deref().unwrap_or("CoreH-bot") };
        let (mut summary, figures) = sinks.finish(names, &host.host, &outcome)?;
        if !limits.is_judged {
            summary.warnings.push(format!("{}: {UNITS_CHANGED}", self.name));
            summary.warnings_total += 1;
        }
        summary.wall_time_s = start.elapsed().as_secs_f64();
        write_results(args, &summary, &figures, settings)?;
        Ok(summary.ok)
    }
}

fn read_machine(path: Option<&Path>) -> Result<Machine> {
    let Some(path) = path else {
        return Ok(Machine { name: Some("CoreH-bot prototype".to_owned()), settings: Settings::prototype() });
    };
    let text = std::fs::read_to_string(path).with_context(|| cannot("open", path))?;
    let mut machine = machine_file::parse(&text).with_context(|| format!("{}", path.display()))?;
    machine.name = machine.name.or_else(|| path.file_stem().map(|s| s.to_string_lossy().into_owned()));
    Ok(machine)
}

/// The file's name for messages, and its text; what is no UTF-8 can only stand in comments.
fn read_gcode(path: &Path) -> Result<(String, String)> {
    let mut bytes = Vec::new();
    let name = if path == Path::new("-") {
        std::io::stdin().read_to_end(&mut bytes).context("cannot read standard input")?;
        "stdin".to_owned()
    } else {
        bytes = std::fs::read(path).with_context(|| cannot("open", path))?;
        path.display().to_string()
    };
    Ok((name, String::from_utf8_lossy(&bytes).into_owned()))
}

fn create(path: &Path) -> Result<BufWriter<File>> {
    File::create(path).map(BufWriter::new).with_context(|| cannot("create", path))
}

fn cannot(what: &str, path: &Path) -> String {
    format!("cannot {what} {}", path.display())
}

fn write_results(args: &Run, summary: &Summary, figures: &Figures, settings: &Settings) -> Result<()> {
    if let Some(path) = &args.json {
        std::fs::write(path, summary.to_json()?).with_context(|| cannot("write", path))?;
    }
    if let Some(path) = &args.report {
        let page = report::render(summary, figures, settings)?;
        std::fs::write(path, page).with_context(|| cannot("write", path))?;
    }
    match write!(std::io::stdout(), "{summary}") {
        // Whoever read it has read enough.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => written.context("cannot write to standard output"),
    }
}

fn progress_bar(commands: u64) -> ProgressBar {
    let bar = ProgressBar::new(commands);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} commands, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// A host whose progress is shown.
struct Watched {
    host: FileHost,
    bar: ProgressBar,
}

impl Host for Watched {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.host.send(out);
        let answered = self.host.answered();
        // A position a command would cost more than the command.
        if answered.is_multiple_of(64) {
            self.bar.set_position(answered);
        }
    }

    fn hear(&mut self, line: &str) {
        self.host.hear(line);
    }

    fn is_done(&self) -> bool {
        self.host.is_done()
    }
}

/// All that listen to the steps.
struct Sinks {
    trace: TraceWriter<BufWriter<File>>,
    vcd: Option<VcdWriter<BufWriter<File>>>,
    tally: Tally,
    checker: Checker,
}

impl Sink for Sinks {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.trace.event(tick, steps, forward);
        self.tally.event(tick, steps, forward);
        self.checker.event(tick, steps, forward);
        if let Some(vcd) = &mut self.vcd {
            vcd.event(tick, steps, forward);
        }
    }
}

impl Sinks {
    fn finish(self, names: Names<'_>, host: &FileHost, outcome: &Outcome) -> Result<(Summary, Figures)> {
        if let Some(vcd) = self.vcd {
            vcd.finish().context("cannot write the VCD file")?;
        }
        let trace = self.trace.finish().context("cannot write the trace")?;
        let figures = self.tally.finish(outcome.ticks);
        let findings = self.checker.finish(Some(outcome.counts));
        Ok((Summary::new(names, host, outcome, &figures, &findings, trace.sha256), figures))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_three_numbers() {
        assert_eq!(parse_place("1,-2.5, 0").unwrap(), [1.0, -2.5, 0.0].map(Mm::from_num));
        for bad in ["", "1,2", "1,2,3,4", "1,2,z", "1,2,nan", "1,2,1e9"] {
            assert!(parse_place(bad).is_err(), "{bad}");
        }
    }
}
