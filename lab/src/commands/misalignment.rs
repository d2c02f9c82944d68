//! `corehbot-lab misalignment`: pulleys that are not where they should be.

use crate::drawings::misalignment::picture;
use crate::queries::misalignment::{Misalignment as Answer, Offset};
use anyhow::{Context as _, Result, ensure};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_questions::setup::{FileArgs, SetupArgs, parse_pair};
use std::io::Write as _;
use std::path::PathBuf;

/// Greatest offset of a pulley in mm.
const MOST_MM: f64 = 20.0;

/// `corehbot-lab misalignment`.
#[derive(Args)]
pub(crate) struct Misalignment {
    /// A pulley that is off: its number in `twin geometry`, and how far to the right and away from the front, in mm.
    /// May be repeated; offsets of one pulley add up. Torques are counter-clockwise, seen from above. Without it, the
    /// torques for 1 mm of each pulley on bar and head.
    #[arg(long = "off", value_name = "PULLEY=DX,DY", value_parser = parse_offset, allow_hyphen_values = true)]
    offsets: Vec<Offset>,
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    setup: SetupArgs,
    /// Draws tension and tool along both strokes, as SVG.
    #[arg(long, value_name = "F.svg", requires = "offsets")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl Misalignment {
    pub(crate) fn answer(&self) -> Result<u8> {
        for Offset { pulley, .. } in &self.offsets {
            let of = self.offsets.iter().filter(|offset| offset.pulley == *pulley);
            let [x, y] = of.fold([0.0; 2], |[x, y], Offset { off_mm: [right, back], .. }| [x + right, y + back]);
            ensure!(
                x.abs() <= MOST_MM && y.abs() <= MOST_MM,
                "pulley {pulley} is off by ({x}, {y}) mm in all; the limit is {MOST_MM}"
            );
        }
        let answer = Answer::new(&self.setup.read(&self.file.read()?)?, &self.offsets)?;
        self.json.give_with(&answer, self.file.files(), |outputs| {
            let Some(path) = &self.svg else { return Ok(()) };
            let mut out = outputs.open(path)?;
            out.write_all(picture(&answer).as_bytes()).and_then(|()| out.flush()).context("cannot write the picture")
        })
    }
}

/// `12=0.5,-1`.
fn parse_offset(text: &str) -> Result<Offset, String> {
    let (pulley, off) = text.split_once('=').ok_or("expected PULLEY=DX,DY")?;
    let pulley = pulley.trim().parse().map_err(|_| format!("`{pulley}` is not the number of a pulley"))?;
    let off_mm = parse_pair(off)?;
    match off_mm.iter().find(|mm| mm.abs() > MOST_MM) {
        Some(mm) => Err(format!("{mm} is not from -{MOST_MM} to {MOST_MM} mm")),
        None => Ok(Offset { pulley, off_mm }),
    }
}
