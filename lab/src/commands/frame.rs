//! `corehbot-lab frame`: the motors' torque on the frame, and a frame that is not rigid.

use crate::drawings::frame::picture;
use crate::queries::soft_frame::SoftFrame;
use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::answer::drawn;
use corehbot_questions::setup::{FileArgs, SetupArgs};
use std::path::PathBuf;

/// `corehbot-lab frame`.
#[derive(Args)]
pub(crate) struct Frame {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    setup: SetupArgs,
    /// Draws both, as SVG; `-` is standard output.
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl Frame {
    pub(crate) fn answer(&self) -> Result<u8> {
        let answer = SoftFrame::new(&self.setup.read(&self.file.read()?)?)?;
        self.json
            .give_with(&answer, self.file.files(), |outputs| drawn(outputs, self.svg.as_deref(), || picture(&answer)))
    }
}
