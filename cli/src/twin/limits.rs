//! `twin limits`: how hard the machine can be driven.

use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_questions::setup::{FileArgs, MachineArgs, ModelArg};
use corehbot_twin::geometry::workspace;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::limits::Limits;
use corehbot_twin::queries::torque::TorqueLimits;
use serde::Serialize;

/// `twin limits`.
#[derive(Args)]
pub(crate) struct LimitsArgs {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    machine: MachineArgs,
    /// The error in mm that ringing may make.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = parse_error, default_value = "0.025")]
    error: f64,
    /// The part of the holding torque that may be used, of 1.
    #[arg(long, value_name = "PART", allow_negative_numbers = true, value_parser = parse_part, default_value = "0.5")]
    torque: f64,
    /// The part of its torque at each speed that a motor keeps, of 1: an alternative to --torque.
    #[arg(long, value_name = "PART", allow_negative_numbers = true, value_parser = parse_margin, conflicts_with = "torque")]
    margin: Option<f64>,
    /// The belt speed in mm/s for which settings are suggested.
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true, value_parser = parse_speed, default_value = "300")]
    speed: f64,
    /// Parts that may move besides the tool.
    #[arg(long, value_enum, default_value = "rotors")]
    model: ModelArg,
    #[command(flatten)]
    json: Json,
}

/// Of ringing and slack, and of torque at speed.
#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    limits: Limits,
    torque_at_speed: TorqueLimits,
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.limits, self.torque_at_speed)
    }
}

impl LimitsArgs {
    pub(super) fn answer(&self) -> Result<u8> {
        let (machine, params) = self.machine.read(&self.file.read()?)?;
        let tool = workspace(machine, &params).centre();
        let setup = Setup { machine, params, tool, freedom: self.model.freedom() };
        let margin = self.margin.unwrap_or(1.0 - self.torque);
        let limits = Limits::new(&setup, self.error, 1.0 - margin)?;
        let torque_at_speed = TorqueLimits::new(machine, &setup.params, margin, self.speed)?;
        self.json.give(&Answer { limits, torque_at_speed }, self.file.files())
    }
}

fn parse_error(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| *v > 0.0 && *v <= 10.0);
    legal.ok_or_else(|| format!("`{text}` is not an error above 0 and up to 10 mm"))
}

fn parse_part(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| *v > 0.0 && *v <= 1.0);
    legal.ok_or_else(|| format!("`{text}` is not a part above 0 and up to 1"))
}

fn parse_margin(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| (0.0..1.0).contains(v));
    legal.ok_or_else(|| format!("`{text}` is not a part from 0 to below 1"))
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let legal = text.parse().ok().filter(|v| (1.0..=2000.0).contains(v));
    legal.ok_or_else(|| format!("`{text}` is not a speed from 1 to 2000 mm/s"))
}
