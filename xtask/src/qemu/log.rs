//! The board's log: defmt frames; their texts are in the image.

use anyhow::{Context as _, Result};
use defmt_decoder::{DecodeError, Table};
use std::path::Path;

/// Decodes the frames in `path` that `image` wrote.
pub fn decode(image: &Path, path: &Path) -> Result<Vec<String>> {
    let elf = std::fs::read(image).with_context(|| format!("cannot open {}", image.display()))?;
    let Some(table) = Table::parse(&elf)? else {
        return Ok(Vec::new());
    };
    let mut decoder = table.new_stream_decoder();
    decoder.received(&std::fs::read(path).context("the board left no log")?);
    let mut lines = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => lines.push(frame.display(false).to_string()),
            Err(DecodeError::UnexpectedEof) => return Ok(lines),
            Err(DecodeError::Malformed) => lines.push("(a line of the log is damaged)".to_owned()),
        }
    }
}
