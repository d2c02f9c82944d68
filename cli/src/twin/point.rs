//! Questions about one place of the tool.

use super::setup::{FileArgs, SetupArgs, parse_finite, parse_pair};
use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_twin::queries::{geometry, modes, push, slip, stiffness};

/// Greatest force, in N: a hundred times the holding force of a motor.
const MOST_N: f64 = 10_000.0;

/// Most full steps of a slip: fifty turns, two metres of belt.
const MOST_FULL_STEPS: f64 = 10_000.0;

fn parse_force(text: &str) -> Result<[f64; 2], String> {
    let force = parse_pair(text)?;
    let is_legal = force.iter().all(|part| part.abs() <= MOST_N);
    if is_legal { Ok(force) } else { Err(format!("`{text}` is not a force of -{MOST_N} to {MOST_N} N")) }
}

fn parse_full_steps(text: &str) -> Result<f64, String> {
    let steps = parse_finite(text)?;
    let is_legal = steps.abs() <= MOST_FULL_STEPS;
    if is_legal { Ok(steps) } else { Err(format!("{text} is not from -{MOST_FULL_STEPS} to {MOST_FULL_STEPS}")) }
}

/// `twin geometry`.
#[derive(Args)]
pub(crate) struct Geometry {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    setup: SetupArgs,
    #[command(flatten)]
    json: Json,
}

impl Geometry {
    pub(super) fn answer(&self) -> Result<u8> {
        let answer = geometry::Geometry::new(&self.setup.read(&self.file.read()?)?);
        self.json.give(&answer, self.file.files())
    }
}

/// `twin stiffness`.
#[derive(Args)]
pub(crate) struct Stiffness {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    setup: SetupArgs,
    #[command(flatten)]
    json: Json,
}

impl Stiffness {
    pub(super) fn answer(&self) -> Result<u8> {
        let answer = stiffness::Stiffness::new(&self.setup.read(&self.file.read()?)?)?;
        self.json.give(&answer, self.file.files())
    }
}

/// `twin modes`.
#[derive(Args)]
pub(crate) struct Modes {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    setup: SetupArgs,
    #[command(flatten)]
    json: Json,
}

impl Modes {
    pub(super) fn answer(&self) -> Result<u8> {
        let answer = modes::Modes::new(&self.setup.read(&self.file.read()?)?)?;
        self.json.give(&answer, self.file.files())
    }
}

/// `twin push`.
#[derive(Args)]
pub(crate) struct Push {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    setup: SetupArgs,
    /// The force on the tool in N, to the right and away from the front.
    #[arg(long, value_name = "FX,FY", value_parser = parse_force, allow_hyphen_values = true)]
    force: [f64; 2],
    #[command(flatten)]
    json: Json,
}

impl Push {
    pub(super) fn answer(&self) -> Result<u8> {
        let answer = push::Push::new(&self.setup.read(&self.file.read()?)?, self.force)?;
        self.json.give(&answer, self.file.files())
    }
}

/// `twin slip`.
#[derive(Args)]
pub(crate) struct Slip {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    setup: SetupArgs,
    /// The motor that slipped.
    #[arg(long, value_name = "N")]
    motor: u8,
    /// Slip in full steps, counter-clockwise; a rotor slips by four, an electrical turn.
    #[arg(long, value_name = "K", default_value_t = slip::A_SLIP, value_parser = parse_full_steps, allow_hyphen_values = true)]
    full_steps: f64,
    #[command(flatten)]
    json: Json,
}

impl Slip {
    pub(super) fn answer(&self) -> Result<u8> {
        let answer = slip::Slip::new(&self.setup.read(&self.file.read()?)?, self.motor, self.full_steps)?;
        self.json.give(&answer, self.file.files())
    }
}
