//! `twin ripple`: fine waves on walls by speed and angle.

use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::values::number;
use corehbot_questions::setup::{FileArgs, PlaceArgs};
use corehbot_report::twin::ripple as picture;
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::ripple::{Question, Ripple as Answer};
use std::path::PathBuf;

/// `twin ripple`.
///
/// Angles are the direction of travel, from x towards y. Amplitudes are across the path, so a ripple on the wall is
/// twice as high from peak to valley. Sources are the keys of [twin] that say so (docs/reference/settings.md).
#[derive(Args)]
pub(crate) struct Ripple {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    place: PlaceArgs,
    /// Lowest and highest speed of outer walls, in mm/s.
    #[arg(long, value_name = "FROM-TO", value_parser = parse_speeds, default_value = "20-300")]
    speeds: [f64; 2],
    /// Distance of the speeds, in mm/s.
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true, value_parser = number(0.2, 50.0), default_value = "2")]
    step: f64,
    /// Distance of the angles, in degrees.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = number(1.0, 90.0), default_value = "5")]
    angle_step: f64,
    /// Longest wave that counts as ripple, in mm of the path; longer ones are an error of shape.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = number(0.1, 1000.0), default_value = "10")]
    longest: f64,
    /// The bar may yaw on its guides.
    #[arg(long)]
    yaw: bool,
    /// Writes a map of speed and angle.
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl Ripple {
    pub(super) fn answer(&self) -> Result<u8> {
        let (machine, params, tool) = self.place.read(&self.file.read()?)?;
        self.json.check(self.file.files(), &self.svg)?;
        let freedom = Freedom { yaw: self.yaw, ..Freedom::default() };
        let question = Question {
            speeds_mm_s: self.speeds,
            step_mm_s: self.step,
            angle_step_deg: self.angle_step,
            longest_mm: self.longest,
        };
        let answer = Answer::new(&Setup { machine, params, tool, freedom }, &question)?;
        self.json.give_with(&answer, self.file.files(), |outputs| {
            let Some(path) = &self.svg else { return Ok(()) };
            picture::write(&mut outputs.open(path)?, &answer)
        })
    }
}

/// `20-300`.
fn parse_speeds(text: &str) -> Result<[f64; 2], String> {
    let pair = text.split_once('-').and_then(|(from, to)| Some([from.trim().parse().ok()?, to.trim().parse().ok()?]));
    pair.filter(|[from, to]: &[f64; 2]| *from >= 1.0 && *to <= 1000.0 && to > from)
        .ok_or_else(|| format!("`{text}` is no range of speeds like 20-300, from 1 to 1000 mm/s"))
}
