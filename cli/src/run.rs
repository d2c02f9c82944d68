//! `corehbot run`: prints a file as fast as it can be computed, and judges every step.

use crate::digest::RingSha256;
use crate::recorder_threads::{Done, Judges, Out, Relay, Scratch, Writers};
use anyhow::{Context, Result, bail};
use clap::Args;
use corehbot::port::NoStorage;
use corehbot::units::Mm;
use corehbot_host::accident_args::AccidentArgs;
use corehbot_host::bed_args::BedArgs;
use corehbot_host::heat_args::HeatArgs;
use corehbot_host::input::{GcodeFile, Plate};
use corehbot_host::output::Outputs;
use corehbot_host::plant_args::PlantArgs;
use corehbot_host::printer::Printer;
use corehbot_host::progress::Watched;
use corehbot_host::say::note;
use corehbot_host::status::{DONE, FAILED};
use corehbot_host::stop::Stop;
use corehbot_machine_file::Machine;
use corehbot_machine_file::printable;
use corehbot_report::finished_print::Ended;
use corehbot_report::moves::{Moves, StoredMoves};
use corehbot_report::path::{Stored, ToolPath};
use corehbot_report::print;
use corehbot_report::summary::{Names, Summary};
use corehbot_rig::bed::BedPlant;
use corehbot_sim::accident::Accident;
use corehbot_sim::belt::BeltPlant;
use corehbot_sim::check::Findings;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::host::FileHost;
use corehbot_sim::judge::Judge;
use corehbot_sim::limits::{Limits, Widening};
use corehbot_sim::mesh_log::MeshLog;
use corehbot_sim::tally::Figures;
use corehbot_sim::trace::{Finished, TraceWriter};
use corehbot_sim::vcd::VcdWriter;
use corehbot_sim::world::{self, Desk, Outcome, SimBoard};
use std::fs::File;
use std::io::{Seek as _, Write};
use std::path::PathBuf;
use std::time::Instant;

/// The file to print, and the outputs.
#[derive(Args)]
pub(crate) struct Run {
    /// G-code file, plain or packed (.bgcode, .gcode.gz, sliced .3mf); `-` for standard input.
    file: PathBuf,
    #[command(flatten)]
    plate: Plate,
    /// Writes every step event as CSV; `-` is standard output, for any one of these.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
    /// Writes every step event as VCD, for GTKWave and PulseView.
    #[arg(long, value_name = "T.vcd")]
    vcd: Option<PathBuf>,
    /// Writes the summary as JSON.
    #[arg(long, value_name = "S.json")]
    json: Option<PathBuf>,
    /// Writes a page with the tool path and curves of speed, load and heat.
    #[arg(long, value_name = "R.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    plant: PlantArgs,
    #[command(flatten)]
    accidents: AccidentArgs,
    #[command(flatten)]
    heat: HeatArgs,
    #[command(flatten)]
    bed: BedArgs,
    #[command(flatten)]
    printer: Printer,
}

/// Everything that can be wrong before the print begins.
pub(crate) struct Prepared {
    name: String,
    host: FileHost,
    /// The file once more, for the report.
    gcode: Option<File>,
    limits: Limits,
    machine: Machine,
    belt: Option<Box<BeltPlant>>,
    heat: HeatSetup,
    bed: Option<Box<BedPlant>>,
    probe_accidents: Vec<Accident>,
    eeprom: Option<Eeprom>,
    stop: Stop,
    outputs: Outputs,
    trace: Option<Out>,
    vcd: Option<VcdWriter<Out>>,
    json: Option<Out>,
    report: Option<Out>,
}

impl Prepared {
    pub fn new(args: &Run) -> Result<Self> {
        let machine = args.printer.machine()?;
        let breaks = args.accidents.read(&machine.settings, args.plant.has_belts())?;
        let belt = args.plant.belt(&machine, args.printer.assume_homed, &breaks)?;
        let (heat, probe_accidents) = (args.heat.setup(&machine.settings, breaks.heat)?, breaks.probe);
        let bed = args.bed.plant(&machine.settings)?;
        // Until standard input has been read, Ctrl-C ends the process: there is nothing yet to be left in order.
        let mut file = GcodeFile::open(&args.file, args.plate)?;
        let stop = Stop::at_signals()?;
        let mut eeprom = args.printer.eeprom()?;
        let mut outputs =
            Outputs::new(args.printer.files().chain([args.file.as_path()]).chain(args.heat.file()), stop.clone());
        let mut open = |path: &Option<PathBuf>| path.as_deref().map(|path| outputs.open(path)).transpose();
        let (trace, vcd, json, report) = (open(&args.trace)?, open(&args.vcd)?, open(&args.json)?, open(&args.report)?);
        let settings = &machine.settings;
        let vcd = vcd.map(|out| VcdWriter::new(out, &settings.motor_names)).transpose();
        let vcd = vcd.context("cannot write the VCD file")?;
        let stored = eeprom.as_mut().and_then(Eeprom::settings);
        let stored = stored.filter(|stored| stored.mechanism == settings.mechanism);
        let mut limits = Widening::new(settings, stored.as_ref());
        limits.texts(&machine.texts);
        let survey = file.survey(|command| {
            if stop.is_set() {
                bail!("interrupted before the print began");
            }
            limits.command(command);
            Ok(())
        })?;
        let name = file.name.clone();
        let gcode = report.is_some().then(|| file.again()).transpose()?;
        let host = FileHost::reading(file.into_lines()?, survey);
        let limits = limits.finish();
        Ok(Self {
            name,
            host,
            gcode,
            limits,
            machine,
            belt,
            heat,
            bed,
            probe_accidents,
            eeprom,
            stop,
            outputs,
            trace,
            vcd,
            json,
            report,
        })
    }

    /// Prints, and says with which status it ended.
    pub fn run(self, args: &Run) -> Result<u8> {
        let Self { name, host, limits, machine, belt, heat, bed, probe_accidents, .. } = self;
        let Self { mut eeprom, stop, outputs, trace, vcd, json, report, gcode, .. } = self;
        let settings = &machine.settings;
        let mut host = Watched::new(host, &stop);
        let begin = args.printer.assume_homed.unwrap_or(corehbot_rig::AT_POWER_UP).map(Mm::to_num);
        let scratch = || report.is_some().then(tempfile::tempfile).transpose();
        // Without a page their sums count.
        let path = scratch().context("cannot keep the tool path in a temporary file")?;
        let moves = scratch().context("cannot keep the moves in a temporary file")?;
        let trace = TraceWriter::with_digest(trace, settings.into(), RingSha256::default());
        let writers = Writers { trace, vcd };
        let judges = Judges {
            judge: Judge::new(settings, &limits, begin),
            path: path.map(|file| ToolPath::new(settings, begin, file)),
        };
        let mut sinks = Relay::begin(writers, judges, Moves::new(Scratch(moves)))?;
        let start = Instant::now();
        let (homed, drivers) = (args.printer.assume_homed, Drivers::new());
        let mut desk = Desk::new(1);
        desk.board = SimBoard::of(&machine.texts);
        desk.mesh_log = Some(Box::new(MeshLog::new(settings)));
        (desk.belt, desk.heat, desk.bed, desk.probe_accidents) = (belt, heat, bed, probe_accidents);
        let outcome = match &mut eeprom {
            Some(eeprom) => world::run_at(&mut desk, settings, homed, eeprom, &drivers, &mut [&mut host], &mut sinks),
            None => world::run_at(&mut desk, settings, homed, NoStorage, &drivers, &mut [&mut host], &mut sinks),
        };
        let host = host.finish();
        let mut done = sinks.finish()?;
        let outcome = outcome.with_context(|| format!("{name}: the simulation failed"))?;
        let names = Names {
            file: &name,
            machine: machine.name.as_deref().unwrap_or("CoreH-bot"),
            motors: settings.motor_names,
            fitted: settings.mechanism.fitted(),
        };
        let heat = std::mem::take(&mut done.heat);
        let Results { trace, figures, findings, path, mut moves } = Results::new(done, &outcome)?;
        let ended = Ended {
            names,
            settings,
            limits: &limits,
            host: &host,
            outcome: &outcome,
            figures: &figures,
            findings: &findings,
            moves: &moves,
            trace_sha256: &trace.sha256,
        };
        let mut summary = ended.summary(&mut desk);
        let interrupted = stop.status();
        if interrupted.is_some() {
            let (answered, commands) = (host.answered(), host.commands());
            summary.ok = false;
            summary.failure = Some(format!("{name}: interrupted after {answered} of {commands} commands"));
        }
        summary.wall_time_s = start.elapsed().as_secs_f64();
        if let Some(json) = json {
            write_all(json, &summary.to_json()?).context("cannot write the JSON")?;
        }
        if let (Some(mut report), Some(path), Some(file), Some(mut gcode)) = (report, path, moves.file.0.take(), gcode)
        {
            let (heat_waits, notes) = (host.heat_waits(), host.notes());
            let belt = desk.belt.as_deref().map(BeltPlant::course);
            let page =
                print::Page { summary: &summary, figures: &figures, heat: &heat, heat_waits, belt, settings, notes };
            gcode.rewind().with_context(|| name.clone())?;
            let moves = moves.in_file(file);
            page.write(print::Streams { path, moves, gcode }, &mut report).context("cannot write the report")?;
        }
        say(&summary, outputs.is_standard_taken())?;
        if let Some(status) = interrupted {
            for partial in outputs.leave() {
                note(format_args!(
                    "corehbot: what there is of it is in {}",
                    printable::line(&partial.to_string_lossy())
                ));
            }
            return Ok(status);
        }
        outputs.keep()?;
        Ok(if summary.ok { DONE } else { FAILED })
    }
}

fn write_all(mut out: Out, text: &str) -> Result<()> {
    out.write_all(text.as_bytes())?;
    Ok(out.flush()?)
}

/// Prints the summary, where there is no output of another kind.
fn say(summary: &Summary, is_standard_taken: bool) -> Result<()> {
    let written =
        if is_standard_taken { write!(std::io::stderr(), "{summary}") } else { write!(std::io::stdout(), "{summary}") };
    match written {
        // The reader has read enough.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => written.context("cannot write the summary"),
    }
}

/// All that the sinks have found.
struct Results {
    trace: Finished,
    figures: Figures,
    findings: Findings,
    path: Option<Stored<File>>,
    moves: StoredMoves<Scratch>,
}

impl Results {
    fn new(done: Done<Out>, outcome: &Outcome) -> Result<Self> {
        let Done { writers: Writers { trace, vcd }, judges: Judges { judge, path }, moves, .. } = done;
        if let Some(vcd) = vcd {
            vcd.finish().context("cannot write the VCD file")?;
        }
        let trace = trace.finish().context("cannot write the trace")?;
        let (figures, findings) = judge.finish(outcome.ticks, outcome.counts);
        let path = path.map(ToolPath::finish).transpose().context("cannot keep the tool path")?;
        let moves = moves.finish().context("cannot keep the moves")?;
        Ok(Self { trace, figures, findings, path, moves })
    }
}
