//! `corehbot-lab jump`: the ringing after a jump of speed.

use crate::jump;
use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_questions::play::RunModel;
use corehbot_questions::setup::{FileArgs, PlaceArgs, parse_pair};

/// `corehbot-lab jump`.
#[derive(Args)]
pub(crate) struct Jump {
    /// The jump of speed in mm/s, to the right and away from the front.
    #[arg(long, value_name = "VX,VY", value_parser = parse_pair, allow_hyphen_values = true)]
    speed: [f64; 2],
    /// Without damping and friction: the amplitude of a single mode (--model reduced) is speed over angular frequency.
    #[arg(long)]
    undamped: bool,
    /// Parts that move besides the tool.
    #[arg(long, value_enum, default_value = "rotors")]
    model: RunModel,
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    place: PlaceArgs,
    #[command(flatten)]
    json: Json,
}

impl Jump {
    pub(crate) fn answer(&self) -> Result<u8> {
        let (machine, params, tool) = self.place.read(&self.file.read()?)?;
        let params = if self.undamped { params.undamped() } else { params };
        let answer = jump::Jump::new(machine, &params, tool, self.model.detail(), self.speed)?;
        self.json.give(&answer, self.file.files())
    }
}
