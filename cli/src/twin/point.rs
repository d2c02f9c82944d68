//! Questions about one place of the tool.

use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_questions::setup::{FileArgs, SetupArgs, parse_finite};
use corehbot_twin::queries::{geometry, modes, slip, stiffness};

/// Most full steps of a slip: fifty turns, two metres of belt.
const MOST_FULL_STEPS: f64 = 10_000.0;

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
