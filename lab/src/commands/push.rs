//! `corehbot-lab push`: a force on the tool.

use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_questions::setup::{FileArgs, SetupArgs, parse_pair};
use corehbot_twin::queries::push;

/// Greatest force, in N: a hundred times the holding force of a motor.
const MOST_N: f64 = 10_000.0;

fn parse_force(text: &str) -> Result<[f64; 2], String> {
    let force = parse_pair(text)?;
    let is_legal = force.iter().all(|part| part.abs() <= MOST_N);
    if is_legal { Ok(force) } else { Err(format!("`{text}` is not a force of -{MOST_N} to {MOST_N} N")) }
}

/// `corehbot-lab push`.
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
    pub(crate) fn answer(&self) -> Result<u8> {
        let answer = push::Push::new(&self.setup.read(&self.file.read()?)?, self.force)?;
        self.json.give(&answer, self.file.files())
    }
}
