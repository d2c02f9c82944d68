//! Printing: a file to its end, judged and recorded as `corehbot run --report` does.

use crate::job::{Job, Prepared};
use crate::opening;
use anyhow::{Context as _, Result};
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_report::finished_print::Ended;
use corehbot_report::heat_log::HeatLog;
use corehbot_report::moves::Moves;
use corehbot_report::path::ToolPath;
use corehbot_report::print;
use corehbot_report::summary::Names;
use corehbot_sim::belt::BeltPlant;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::host::FileHost;
use corehbot_sim::judge::Judge;
use corehbot_sim::limits::Widening;
use corehbot_sim::lines::{Lines, survey};
use corehbot_sim::mesh_log::MeshLog;
use corehbot_sim::moves::{MadeMove, ShaperChange};
use corehbot_sim::not_gcode::check_line;
use corehbot_sim::trace::TraceWriter;
use corehbot_sim::world::{self, Desk, HeatPeriod, Host, SimBoard, Sink};
use std::io::{self, Cursor};
use std::sync::Arc;

/// Turns of the world between two words of progress: some milliseconds of a processor.
const TURNS: u32 = 1 << 13;

/// The result of a print.
pub struct Printed {
    /// The summary, as JSON.
    pub summary: String,
    /// The summary in words.
    pub words: String,
    /// The page of the report.
    pub report: Vec<u8>,
}

/// Prints a file; `tell` gets the commands answered, all commands, and the printer's time in s.
///
/// # Errors
/// It is not text, or something of the job cannot be.
pub fn print(job: &Job, gcode: Vec<u8>, tell: &mut dyn FnMut(f64, f64, f64)) -> Result<Printed> {
    let Prepared { machine, homed, belt, heat, bed, probe_accidents } = job.prepare()?;
    let settings = &machine.settings;
    let gcode: Arc<[u8]> = opening::text(gcode, job.plate).with_context(|| job.file.clone())?.into();
    let lines = || Lines::new(Box::new(Cursor::new(gcode.clone())) as Box<_>);
    let mut limits = Widening::new(settings, None);
    limits.texts(&machine.texts);
    let known = survey(&mut lines(), |number, line, command| {
        check_line(number, line, command)?;
        if !command.is_empty() {
            limits.command(command);
        }
        Ok(())
    });
    let host = FileHost::reading(lines(), known.with_context(|| job.file.clone())?);
    let limits = limits.finish();
    let begin = homed.unwrap_or(corehbot_rig::AT_POWER_UP).map(Mm::to_num);
    let mut sinks = Sinks {
        trace: TraceWriter::new(None, settings.into()),
        judge: Judge::new(settings, &limits, begin),
        path: ToolPath::new(settings, begin, Cursor::new(Vec::new())),
        moves: Moves::new(Cursor::new(Vec::new())),
        heat: HeatLog::default(),
    };
    let mut host = Watched { host, tell, turns: 0 };
    let drivers = Drivers::new();
    let mut desk = Desk::new(1);
    desk.board = SimBoard::of(&machine.texts);
    desk.mesh_log = Some(Box::new(MeshLog::new(settings)));
    (desk.belt, desk.heat, desk.bed, desk.probe_accidents) = (belt, heat, bed, probe_accidents);
    let outcome = world::run_at(&mut desk, settings, homed, NoStorage, &drivers, &mut [&mut host], &mut sinks);
    let host = host.host;
    let outcome = outcome.with_context(|| format!("{}: the simulation failed", job.file))?;
    let Sinks { trace, judge, path, moves, heat } = sinks;
    let trace = trace.finish()?;
    let (figures, findings) = judge.finish(outcome.ticks, outcome.counts);
    let names = Names {
        file: &job.file,
        machine: machine.name.as_deref().unwrap_or("CoreH-bot"),
        motors: settings.motor_names,
        fitted: settings.mechanism.fitted(),
    };
    let moves = moves.finish()?;
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
    let summary = ended.summary(&mut desk);
    let course = desk.belt.as_deref().map(BeltPlant::course);
    let (heat_waits, notes) = (host.heat_waits(), host.notes());
    let page =
        print::Page { summary: &summary, figures: &figures, heat: &heat, heat_waits, belt: course, settings, notes };
    let streams = print::Streams { path: path.finish()?, moves, gcode: Cursor::new(gcode) };
    let mut report = Vec::new();
    page.write(streams, &mut report).context("cannot write the report")?;
    Ok(Printed { summary: summary.to_json()?, words: summary.to_string(), report })
}

/// A host that tells how far it is.
struct Watched<'t> {
    host: FileHost,
    tell: &'t mut dyn FnMut(f64, f64, f64),
    turns: u32,
}

impl Host for Watched<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.host.send(out);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        self.host.interject(out);
    }

    fn clock(&mut self, tick: u64) {
        self.host.clock(tick);
        self.turns += 1;
        if self.turns.is_multiple_of(TURNS) {
            let seconds = tick as f64 / f64::from(TICKS_PER_SECOND);
            (self.tell)(self.host.answered() as f64, self.host.commands() as f64, seconds);
        }
    }

    fn sent(&self) -> Option<(u32, u16, &str)> {
        self.host.sent()
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
    trace: TraceWriter<io::Sink>,
    judge: Judge,
    path: ToolPath<Cursor<Vec<u8>>>,
    moves: Moves<Cursor<Vec<u8>>>,
    heat: HeatLog,
}

impl Sink for Sinks {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.trace.event(tick, steps, forward);
        self.judge.event(tick, steps, forward);
        self.path.event(tick, steps, forward);
    }

    fn stopped(&mut self, tick: u64) {
        self.judge.stopped(tick);
    }

    fn stand_on_mesh(&mut self, z: Option<f64>) {
        self.path.stand_on_mesh(z);
    }

    fn wants_moves(&self) -> bool {
        true
    }

    fn moved(&mut self, made: &MadeMove) {
        self.moves.add(made);
    }

    fn reshaped(&mut self, change: &ShaperChange) {
        self.moves.reshape(change);
    }

    fn heat(&mut self, period: &HeatPeriod) {
        self.heat.add(period);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(gcode: &str) -> serde_json::Value {
        let job = Job { file: "a.gcode".to_owned(), homed: Some("0,0,0".to_owned()), ..Job::default() };
        let printed = print(&job, gcode.into(), &mut |_, _, _| {}).unwrap();
        serde_json::from_str(&printed.summary).unwrap()
    }

    fn warnings(gcode: &str) -> String {
        summary(gcode)["warnings"].to_string()
    }

    /// Reproducer: no move knew its line, so each was limited by its own speed.
    #[test]
    fn a_short_move_is_limited_by_its_corners() {
        let limits = summary("G1 X5 F6000\nG1 X5.1\nG1 Y0.2\n")["by_limit"].to_string();
        assert!(limits.contains("corner"), "{limits}");
    }

    #[test]
    fn units_that_change_are_told_as_the_command_tells_them() {
        let changed = "a.gcode: M92 changes the steps: speeds and paths are shown in the old unit and not judged";
        assert!(warnings("G1 X5 F6000\nM92 X100\nG1 X8\n").contains(changed));
        assert_eq!(warnings("G1 X5 F6000\n"), "[]");
    }
}
