//! `corehbot run`: prints a file as fast as it can be computed, and judges every step.

use crate::check::Checker;
use crate::cli::{Printer, cannot, create};
use crate::eeprom::Eeprom;
use crate::host::FileHost;
use crate::limits::Limits;
use crate::machine_file::Machine;
use crate::report;
use crate::summary::{Names, Summary};
use crate::tally::{Figures, Tally};
use crate::trace::TraceWriter;
use crate::vcd::VcdWriter;
use crate::world::{self, Host, Outcome, Sink};
use anyhow::{Context, Result};
use clap::Args;
use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use indicatif::{ProgressBar, ProgressStyle};
use std::fs::File;
use std::io::{BufWriter, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Said of a file with M92, whose steps have two sizes.
const UNITS_CHANGED: &str = "M92 changes the steps: speeds and paths are shown in the old unit and not judged";

/// What to print, and what to write of it.
#[derive(Args)]
pub(crate) struct Run {
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
    #[command(flatten)]
    printer: Printer,
}

/// Everything that can be wrong before the print begins.
pub(crate) struct Prepared {
    name: String,
    gcode: String,
    machine: Machine,
    eeprom: Option<Eeprom>,
    trace: Option<BufWriter<File>>,
    vcd: Option<VcdWriter<BufWriter<File>>>,
}

impl Prepared {
    pub fn new(args: &Run) -> Result<Self> {
        let machine = args.printer.machine()?;
        let (name, gcode) = read_gcode(&args.file)?;
        let eeprom = args.printer.eeprom()?;
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
    pub fn run(mut self, args: &Run) -> Result<bool> {
        let settings = &self.machine.settings;
        let stored = self.eeprom.as_mut().and_then(Eeprom::settings);
        let stored = stored.filter(|stored| stored.mechanism == settings.mechanism);
        let mut host = Watched { host: FileHost::new(&self.gcode), bar: ProgressBar::hidden() };
        if std::io::stderr().is_terminal() {
            host.bar = progress_bar(host.host.commands());
        }
        let limits = Limits::new(settings, stored.as_ref(), &self.gcode);
        let mut sinks = Sinks {
            trace: TraceWriter::new(self.trace, settings.into()),
            vcd: self.vcd,
            tally: Tally::new(settings, args.printer.assume_homed.unwrap_or(corehbot_rig::AT_POWER_UP).map(Mm::to_num)),
            checker: Checker::new(settings, &limits),
        };
        let start = Instant::now();
        let outcome = match &mut self.eeprom {
            Some(eeprom) => world::run_with(settings, args.printer.assume_homed, eeprom, &mut [&mut host], &mut sinks),
            None => world::run(settings, args.printer.assume_homed, &mut host, &mut sinks),
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
