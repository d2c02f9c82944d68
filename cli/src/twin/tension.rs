//! `twin tension`: pitches of the belts' straight parts.

use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::values::number;
use corehbot_questions::setup::{FileArgs, PlaceArgs};
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::tension::Tension as Answer;

/// `twin tension`.
#[derive(Args)]
pub(crate) struct Tension {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    place: PlaceArgs,
    /// The wanted tension in N; without it each belt's own (preload_N).
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(0.1, 1000.0))]
    wanted: Option<f64>,
    /// A pitch that was heard: number of the part in the table, and Hz. May be given for several parts.
    #[arg(long, value_name = "PART=HZ", value_parser = parse_heard)]
    heard: Vec<(usize, f64)>,
    #[command(flatten)]
    json: Json,
}

impl Tension {
    pub(super) fn answer(&self) -> Result<u8> {
        let (machine, params, tool) = self.place.read(&self.file.read()?)?;
        let setup = Setup { machine, params, tool, freedom: Freedom::default() };
        let answer = Answer::new(&setup, self.wanted, &self.heard)?;
        self.json.give(&answer, self.file.files())
    }
}

/// `3=63.6`.
fn parse_heard(text: &str) -> Result<(usize, f64), String> {
    let pair = text.split_once('=').and_then(|(part, hz)| Some((part.trim().parse().ok()?, hz.trim().parse().ok()?)));
    pair.filter(|(_, hz): &(usize, f64)| (1.0..=2000.0).contains(hz))
        .ok_or_else(|| format!("`{text}` is not a part and its pitch like 3=63.6, from 1 to 2000 Hz"))
}
