//! `twin frame`: the motors' torque on the frame, and a frame that is not rigid.

use super::drawn;
use super::setup::{FileArgs, SetupArgs};
use anyhow::Result;
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_report::frame::picture;
use corehbot_twin::queries::soft_frame::SoftFrame;
use std::path::PathBuf;

/// `twin frame`.
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
    pub(super) fn answer(&self) -> Result<u8> {
        let answer = SoftFrame::new(&self.setup.read(&self.file.read()?)?)?;
        self.json
            .give_with(&answer, self.file.files(), |outputs| drawn(outputs, self.svg.as_deref(), || picture(&answer)))
    }
}
