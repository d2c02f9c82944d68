//! `twin limits`: how hard the machine can be driven.

use super::answer::Json;
use super::setup::{MachineArgs, ModelArg};
use anyhow::Result;
use clap::Args;
use corehbot_twin::geometry::workspace;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::limits::Limits as Answer;

/// `twin limits`.
#[derive(Args)]
pub(crate) struct Limits {
    #[command(flatten)]
    machine: MachineArgs,
    /// The error in mm that ringing may make.
    #[arg(long, value_name = "MM", value_parser = parse_error, default_value = "0.025")]
    error: f64,
    /// The part of the holding torque that may be used, of 1.
    #[arg(long, value_name = "PART", value_parser = parse_part, default_value = "0.5")]
    torque: f64,
    /// What may move besides the tool.
    #[arg(long, value_enum, default_value = "rotors")]
    model: ModelArg,
    #[command(flatten)]
    json: Json,
}

impl Limits {
    pub(super) fn answer(&self) -> Result<u8> {
        let (machine, params) = self.machine.read()?;
        let tool = workspace(machine, &params).centre();
        let setup = Setup { machine, params, tool, freedom: self.model.freedom() };
        self.json.give(&Answer::new(&setup, self.error, self.torque)?, self.machine.files())
    }
}

fn parse_error(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| *v > 0.0 && *v <= 10.0);
    legal.ok_or_else(|| format!("`{text}` is no error above 0 and up to 10 mm"))
}

fn parse_part(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| *v > 0.0 && *v <= 1.0);
    legal.ok_or_else(|| format!("`{text}` is no part above 0 and up to 1"))
}
