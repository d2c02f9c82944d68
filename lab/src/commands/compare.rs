//! `corehbot-lab compare`: three mechanisms side by side.

use crate::pages::COMPARE;
use crate::queries::compare::{COMPARED, Compare as Area};
use anyhow::{Context as _, Result};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::input::Plate;
use corehbot_host::printer::Printer;
use corehbot_host::progress::Progress;
use corehbot_host::say::note;
use corehbot_host::stop::Stop;
use corehbot_questions::play::{RunModel, played};
use corehbot_questions::setup::parse_grid;
use corehbot_questions::setup::{ModelArg, has_room};
use corehbot_questions::source::Source;
use corehbot_report::twin::fill;
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::Params;
use corehbot_twin::routing::Machine;
use corehbot_twin::run::report::Report;
use serde::Serialize;
use std::path::PathBuf;

/// Weights of the three runs: 6.4, 5.1 and 5.2 s of `first-print.gcode` with rotors, measured on one core.
const WEIGHTS: [f64; COMPARED.len()] = [1.25, 1.0, 1.0];

/// `corehbot-lab compare`.
#[derive(Args)]
pub(crate) struct Compare {
    /// G-code or a step trace that each of them plays, in its own G-code coordinates.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    #[command(flatten)]
    plate: Plate,
    /// Columns and rows of places over the area that all of them reach.
    #[arg(long, value_name = "NxM", value_parser = parse_grid, default_value = "7x7")]
    grid: [usize; 2],
    /// The force in N that moves the tool aside.
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value = "5", value_parser = parse_force)]
    force: f64,
    /// Parts that may move besides the tool, over the area.
    #[arg(long, value_enum, default_value = "full")]
    model: ModelArg,
    /// Parts that move besides the tool, on the file.
    #[arg(long, value_enum, default_value = "rotors")]
    run_model: RunModel,
    #[command(flatten)]
    printer: Printer,
    /// Writes a page with the figures side by side.
    #[arg(long, value_name = "R.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

/// The page's data.
#[derive(Serialize)]
struct Data<'a> {
    file: String,
    names: [&'static str; 3],
    answer: &'a Answer,
}

/// Figures of the area, and of the file.
#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    area: Area,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    runs: Vec<Report>,
}

impl Compare {
    pub(crate) fn answer(&self) -> Result<u8> {
        let params = self.params()?;
        let files = || self.printer.files().chain(self.file.as_deref());
        self.json.check(files(), &self.report)?;
        let stop = Stop::at_signals()?;
        let area = Area::new(&params, self.model.freedom(), None, self.grid, self.force)?;
        let runs = self.runs(&Progress::new(WEIGHTS), &stop);
        if let Some(status) = stop.status() {
            note(format_args!("corehbot: interrupted"));
            return Ok(status);
        }
        let answer = Answer { area, runs: runs? };
        self.json.give_with(&answer, files(), |outputs| {
            let Some(path) = &self.report else { return Ok(()) };
            let file = self.file.as_ref().map_or(String::new(), |file| file.display().to_string());
            let data = Data { file, names: COMPARED.map(Machine::name), answer: &answer };
            fill(&mut outputs.open(path)?, COMPARE, &data).context("cannot write the report")
        })
    }

    /// The numbers of the machine file, for all machines.
    fn params(&self) -> Result<Params> {
        let params = self.printer.machine()?.twin.params;
        has_room(&COMPARED, &params)?;
        Ok(params)
    }

    fn runs(&self, progress: &Progress, stop: &Stop) -> Result<Vec<Report>> {
        let Some(file) = &self.file else { return Ok(Vec::new()) };
        let params = self.params()?;
        let source = Source::read(file, self.plate, &self.printer, stop)?;
        let run = |(index, machine): (usize, Machine)| {
            let start = workspace(machine, &params).of_gcode(source.begin);
            progress
                .piece(index, stop, |go_on| {
                    played(machine, &params, start, self.run_model, (&source.steps, None), go_on)
                })
                .map(|(report, _)| report)
                .with_context(|| format!("{}, {}", file.display(), machine.name()))
        };
        COMPARED.into_iter().enumerate().map(run).collect()
    }
}

fn parse_force(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v: &f64| *v > 0.0 && v.is_finite());
    legal.ok_or_else(|| format!("`{text}` is not a force above 0"))
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.area)?;
        let Some(first) = self.runs.first() else { return Ok(()) };
        writeln!(f, "the file, {:.1} s", first.duration_s)?;
        let mut row = |what: &str, figure: fn(&Report) -> String| {
            let figures: Vec<String> = self.runs.iter().map(|run| format!("{:>18}", figure(run))).collect();
            writeln!(f, "  {what:<34}{}", figures.concat())
        };
        row("contour error, mm", |run| format!("{:.4}", run.contour.max_mm))?;
        row("  RMS, mm", |run| format!("{:.4}", run.contour.rms_mm))?;
        row("  inside of corners, mm", |run| format!("{:.4}", run.contour.rounding_max_mm))?;
        row("  outside of corners, mm", |run| format!("{:.4}", run.contour.overshoot_max_mm))?;
        row("motor torque, mN m", |run| {
            format!("{:.1}", run.motors.iter().map(|motor| motor.torque_max_mnm).fold(0.0, f64::max))
        })?;
        row("slips", |run| run.motors.iter().map(|motor| motor.slips).sum::<u32>().to_string())?;
        row("yaw torque, N m", |run| format!("{:.3}", run.yaw_torque_nm))?;
        row("torque on the frame, N m", |run| format!("{:.4}", run.frame_torque_nm))?;
        if self.runs.iter().any(|run| run.frame_mm.is_some()) {
            let moved = |run: &Report| run.frame_mm.map_or(String::new(), |[x, y]| format!("{x:.4} / {y:.4}"));
            row("frame moves in x / y, mm", moved)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;

    #[derive(clap::Parser)]
    struct Words {
        #[command(flatten)]
        compare: Compare,
    }

    /// Reproducer: the time left was that of one machine.
    #[test]
    fn progress_on_a_file_is_that_of_all_machines() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/tiny.gcode");
        let compare = Words::parse_from(["compare", file, "--assume-homed", "100,100,0"]).compare;
        let progress = Progress::new(WEIGHTS);
        let runs = compare.runs(&progress, &Stop::default()).unwrap();
        assert_eq!(runs.len(), WEIGHTS.len());
        assert!((progress.done() - 1.0).abs() < 1e-9, "{}", progress.done());
    }
}
