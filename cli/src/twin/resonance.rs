//! `twin resonance`: frequencies over the reach.

use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::values::number;
use corehbot_questions::setup::{FileArgs, MachineArgs, ModelArg, parse_grid};
use corehbot_report::twin as page;
use corehbot_twin::geometry::workspace;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::resonance::Resonance as Answer;
use corehbot_twin::shaping::wall::Print;
use std::path::PathBuf;

/// `twin resonance`.
#[derive(Args)]
pub(crate) struct Resonance {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    machine: MachineArgs,
    /// Columns and rows of places over the reach.
    #[arg(long, value_name = "NxM", value_parser = parse_grid, default_value = "7x7")]
    grid: [usize; 2],
    /// Parts that may move besides the tool.
    #[arg(long, value_enum, default_value = "rotors")]
    model: ModelArg,
    /// Writes a page with maps of the frequencies, shapers and the lines that set them.
    #[arg(long, value_name = "R.html")]
    report: Option<PathBuf>,
    /// Acceleration of the walls that shapers are ranked by, in mm/s^2.
    #[arg(long, value_name = "MM_S2", allow_negative_numbers = true, value_parser = number(100.0, 100_000.0), default_value = "5000")]
    acceleration: f64,
    /// Speed of these walls, in mm/s.
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true, value_parser = number(5.0, 1000.0), default_value = "100")]
    speed: f64,
    #[command(flatten)]
    json: Json,
}

impl Resonance {
    pub(super) fn answer(&self) -> Result<u8> {
        let (machine, params) = self.machine.read(&self.file.read()?)?;
        self.json.check(self.file.files(), &self.report)?;
        let tool = workspace(machine, &params).centre();
        let freedom = self.model.freedom();
        let [columns, rows] = self.grid;
        let print = Print { acceleration_mm_s2: self.acceleration, speed_mm_s: self.speed, ..Print::default() };
        let answer = Answer::new(&Setup { machine, params, tool, freedom }, columns, rows)?.ranked_by_tool(&print);
        self.json.give_with(&answer, self.file.files(), |outputs| {
            let Some(path) = &self.report else { return Ok(()) };
            page::write_resonance(&mut outputs.open(path)?, (machine, self.model.name()), &answer)
        })
    }
}
