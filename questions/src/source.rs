//! Source: the steps of a file, which is a trace, or G-code that goes through the firmware first.

use crate::outside::name_by_place;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot::motors::{Motor, MotorName, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_host::input::{GcodeFile, Plate};
use corehbot_host::output::STANDARD;
use corehbot_host::printer::Printer;
use corehbot_host::progress::Watched;
use corehbot_host::stop::Stop;
use corehbot_sim::host::FileHost;
use corehbot_sim::moves::{MadeMove, ShaperChange};
use corehbot_sim::slicer::{self, Role};
use corehbot_sim::world::{self, Sink};
use corehbot_twin::steps::{Begins, Column, LineType, Planned, StepTrace, csv};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// First bytes of a trace.
const TRACE: &[u8] = b"# corehbot-trace";

/// Steps, and where the tool was before, in G-code's coordinates.
pub struct Source {
    /// The steps.
    pub steps: StepTrace,
    /// The place before.
    pub begin: [f64; 3],
}

impl Source {
    /// Reads a trace, or runs a G-code file.
    ///
    /// # Errors
    /// The file is neither, no motor steps in it, or the print failed.
    pub fn read(file: &Path, plate: Plate, printer: &Printer, stop: &Stop) -> Result<Self> {
        let begin = printer.assume_homed.unwrap_or(corehbot_rig::AT_POWER_UP);
        let steps = match Self::trace(file)? {
            Some(trace) => trace,
            None => print(file, plate, printer, stop)?,
        };
        ensure!(
            !steps.events.is_empty(),
            "{}: no motor steps in it; expected G-code that moves, or a step trace (corehbot run --trace)",
            file.display()
        );
        Ok(Self { steps, begin: begin.map(|mm| mm.to_num()) })
    }

    /// Reads a trace; `None` if the file is something else.
    ///
    /// # Errors
    /// It cannot be read, or is a trace with a mistake.
    pub fn trace(file: &Path) -> Result<Option<StepTrace>> {
        let read = |trace| csv::read(trace).with_context(|| file.display().to_string());
        trace_of(file)?.map(read).transpose()
    }
}

/// The file, if it is a trace.
fn trace_of(file: &Path) -> Result<Option<impl BufRead>> {
    if file == Path::new(STANDARD) {
        return Ok(None);
    }
    let mut reader = BufReader::new(File::open(file).with_context(|| format!("cannot open {}", file.display()))?);
    // An unreadable input, such as a directory, is not a trace; reading it as G-code reports the error.
    let is_trace = reader.fill_buf().is_ok_and(|bytes| bytes.starts_with(TRACE));
    Ok(is_trace.then_some(reader))
}

/// The firmware's steps for a G-code file.
fn print(path: &Path, plate: Plate, printer: &Printer, stop: &Stop) -> Result<StepTrace> {
    let machine = printer.machine()?;
    let mut eeprom = printer.eeprom()?;
    let mut file = GcodeFile::open(path, plate)?;
    let survey = file.survey(|_| if stop.is_set() { bail!("interrupted") } else { Ok(()) })?;
    let name = file.name.clone();
    let mut host = Watched::new(FileHost::reading(file.into_lines()?, survey), stop);
    let mut log = Log::new(&machine.settings);
    let outcome = match &mut eeprom {
        Some(eeprom) => world::run_with(&machine.settings, printer.assume_homed, eeprom, &mut [&mut host], &mut log),
        None => world::run(&machine.settings, printer.assume_homed, &mut host, &mut log),
    };
    let host = host.finish();
    let outcome = outcome.with_context(|| format!("{name}: the simulation failed"))?;
    if stop.is_set() {
        bail!("{name}: interrupted after {} of {} commands", host.answered(), host.commands());
    }
    if let Some(failure) = host.failure() {
        bail!("{name}: the print failed: {failure}");
    }
    if outcome.halted {
        bail!("{name}: the print failed: an emergency stop holds");
    }
    let Log { mut steps, rises, .. } = log;
    steps.line_types = host.notes().types().iter().map(line_type).collect();
    name_by_place(&mut steps.plan, &rises, &mut steps.line_types);
    Ok(steps)
}

fn line_type(named: &slicer::LineType) -> LineType {
    LineType { name: named.name.clone(), is_printed: !matches!(named.role, Role::Travel | Role::Purge) }
}

/// The firmware's steps for G-code that begins at a place, as if homed there.
///
/// # Errors
/// The print failed.
pub fn steps_of(gcode: &str, settings: &Settings, begin: [Mm; 3]) -> Result<StepTrace> {
    let mut host = FileHost::new(gcode);
    let mut log = Log::new(settings);
    let outcome = world::run(settings, Some(begin), &mut host, &mut log).context("the simulation failed")?;
    if let Some(failure) = host.failure() {
        bail!("the print failed: {failure}");
    }
    ensure!(!outcome.halted, "the print failed: an emergency stop holds");
    Ok(log.steps)
}

fn step_mm(settings: &Settings) -> f64 {
    1.0 / settings.axes.x.steps_per_mm.to_num::<f64>()
}

/// The motors over x, y and z.
fn columns(settings: &Settings) -> Vec<Column> {
    let (mechanism, axes) = (settings.mechanism, &settings.axes);
    let fitted = mechanism.fitted();
    let steps_per_mm = [&axes.x, &axes.y, &axes.z].map(|axis| axis.steps_per_mm.to_num::<f64>());
    let column = |((motor, [x, y, z, _]), name): ((Motor, [i8; 4]), MotorName)| {
        let row = if fitted.has(motor) { [x, y, z] } else { [0; 3] };
        // All axes of a motor have steps of one size.
        let steps = mechanism.axis_of(motor).and_then(|axis| steps_per_mm.get(axis));
        let axis_step = steps.map_or(1.0, |steps| steps_per_mm[0] / steps);
        Column { name: name.to_string(), row, axis_step }
    };
    mechanism.motors().zip(settings.motor_names).take_while(|(_, name)| !name.is_none()).map(column).collect()
}

/// Keeps the steps and the planned moves.
pub struct Log {
    /// The steps.
    pub steps: StepTrace,
    /// The way of each planned move along z in mm.
    rises: Vec<f64>,
    /// Since when a shaper delays x and y by so many ticks, in the mean.
    late: Vec<(u64, [u64; 2])>,
    /// Whether a switch may have ended the last move.
    was_watched: bool,
}

impl Log {
    /// Of a machine with these settings.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let steps = StepTrace::new(columns(settings), step_mm(settings));
        Self { steps, rises: Vec::new(), late: vec![(0, [0; 2])], was_watched: false }
    }

    /// The mean delay of the axis that is delayed more.
    fn late_at(&self, tick: u64) -> u64 {
        let change = self.late.iter().rev().find(|(from, _)| *from <= tick);
        change.map_or(0, |(_, [x, y])| *x.max(y))
    }
}

impl Sink for Log {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.steps.add(tick, steps.0, forward.0);
    }

    fn wants_moves(&self) -> bool {
        true
    }

    fn moved(&mut self, made: &MadeMove) {
        let late = self.late_at(made.begin);
        let [x, y, z, ..] = made.way;
        self.rises.push(z);
        let begins = match (made.is_apart, self.was_watched) {
            (true, true) => Begins::AtTheMotors,
            (true, false) => Begins::NearTheEnd,
            (false, _) => Begins::AtTheEnd,
        };
        // A move begins with its first copy.
        let ticks = [made.begin, made.end() + late];
        self.steps.plan.push(Planned {
            ticks,
            way_mm: [x, y],
            begins,
            is_touch: made.is_watched,
            line_type: made.source.kind,
        });
        self.was_watched = made.is_watched;
    }

    fn reshaped(&mut self, change: &ShaperChange) {
        let late = change.taps.iter().map(|tap| f64::from(tap.weight) * f64::from(tap.delay) / 256.0).sum::<f64>();
        let mut all = self.late.last().map_or([0; 2], |(_, late)| *late);
        if let Some(axis) = all.get_mut(change.axis) {
            *axis = late as u64;
        }
        self.late.push((change.tick, all));
    }
}
