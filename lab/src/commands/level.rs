//! `corehbot-lab level`: racking and levelling of a CoreXYZ by its belts.

use crate::drawings::corexyz;
use crate::queries::level::{Ask, Level as Answer};
use anyhow::{Result, ensure};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::answer::drawn;
use corehbot_questions::setup::{FileArgs, MachineArgs, parse_pair, parse_positive};
use corehbot_twin::geometry::workspace;
use corehbot_twin::routing::Machine;
use std::path::PathBuf;

/// `corehbot-lab level`.
#[derive(Args)]
pub(crate) struct Level {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    machine: MachineArgs,
    /// The tool's place, in mm from motor 1's axis, at half its height; the middle of its reach without it.
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    /// How much belt is taken up or let out, in mm.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.1, value_parser = parse_positive)]
    take_up: f64,
    /// The stiffness of a spring idler in each belt, in N/mm; without it there are none. Springs count for levelling
    /// and preload only, where a belt slips over its motor, and not for turned motors and motion.
    #[arg(long, value_name = "N_PER_MM", allow_negative_numbers = true, value_parser = parse_positive)]
    spring: Option<f64>,
    /// The acceleration of the tool in the cases of motion, in m/s2.
    #[arg(long, value_name = "M_PER_S2", allow_negative_numbers = true, default_value_t = 5.0, value_parser = parse_positive)]
    acceleration: f64,
    /// Writes the tilted gantries as a drawing; `-` is standard output.
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl Level {
    pub(crate) fn answer(&self) -> Result<u8> {
        let file = self.file.read()?;
        let (machine, params) = if self.machine.is_given() || self.file.is_given() {
            self.machine.read(&file)?
        } else {
            (Machine::CoreXyz, file.twin.params)
        };
        let reach = workspace(machine, &params);
        let tool = self.at.map_or_else(|| reach.centre(), |[x, y]| reach.at(x, y));
        ensure!(reach.has(tool), "({:.1}, {:.1}) is outside what the tool reaches: {reach}", tool.x, tool.y);
        let ask = Ask { taken_mm: self.take_up, spring_n_per_mm: self.spring, acceleration: self.acceleration };
        let answer = Answer::new(machine, &params, tool, ask)?;
        self.json.give_with(&answer, self.file.files(), |outputs| {
            drawn(outputs, self.svg.as_deref(), || corexyz::level(&answer))
        })
    }
}
