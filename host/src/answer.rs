//! Answer: a table on the terminal, and JSON where it is asked for.

use crate::output::{Outputs, Stream};
use crate::status::DONE;
use crate::stop::Stop;
use anyhow::{Context as _, Result};
use clap::Args;
use corehbot_machine_file::printable;
use serde::Serialize;
use std::fmt::Display;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Where the figures go.
#[derive(Args, Default)]
pub struct Json {
    /// Writes the figures as JSON; `-` is standard output, and the table goes to standard error then.
    #[arg(long, value_name = "F.json")]
    json: Option<PathBuf>,
}

impl Json {
    /// Whether the figures and other outputs can be written. A command that computes for long asks first.
    ///
    /// # Errors
    /// One cannot be written, or is an input or another output.
    pub fn check<'p>(
        &'p self,
        inputs: impl IntoIterator<Item = &'p Path>,
        others: impl IntoIterator<Item = &'p PathBuf>,
    ) -> Result<()> {
        let paths = self.json.iter().chain(others);
        Outputs::new(inputs, Stop::default()).check(paths.map(PathBuf::as_path))
    }

    /// Gives the answer to a question about these files.
    ///
    /// # Errors
    /// An output cannot be written.
    pub fn give<'p>(
        &self,
        answer: &(impl Serialize + Display),
        inputs: impl IntoIterator<Item = &'p Path>,
    ) -> Result<u8> {
        self.give_with(answer, inputs, |_| Ok(()))
    }

    /// The same with other outputs in addition.
    ///
    /// # Errors
    /// An output cannot be written.
    pub fn give_with<'p>(
        &self,
        answer: &(impl Serialize + Display),
        inputs: impl IntoIterator<Item = &'p Path>,
        others: impl FnOnce(&mut Outputs) -> Result<()>,
    ) -> Result<u8> {
        let mut outputs = Outputs::new(inputs, Stop::default());
        if let Some(mut out) = self.open(&mut outputs)? {
            Self::write(&mut out, answer)?;
        }
        others(&mut outputs)?;
        say(&answer.to_string(), outputs.is_standard_taken())?;
        outputs.keep()?;
        Ok(DONE)
    }

    /// Opens where the figures go, if they are asked for.
    ///
    /// # Errors
    /// It cannot be written, or is an input or another output.
    pub fn open(&self, outputs: &mut Outputs) -> Result<Option<BufWriter<Stream>>> {
        self.json.as_deref().map(|path| outputs.open(path)).transpose()
    }

    /// Writes the figures there.
    ///
    /// # Errors
    /// The error from `out`.
    pub fn write(out: &mut impl Write, answer: &impl Serialize) -> Result<()> {
        let text = serde_json::to_string_pretty(answer)?;
        writeln!(out, "{text}").and_then(|()| out.flush()).context("cannot write the JSON")
    }
}

/// Prints a text for people, where there is no output of another kind.
pub fn say(text: &str, is_standard_taken: bool) -> Result<()> {
    let text = printable::lines(text);
    let written = if is_standard_taken {
        std::io::stderr().write_all(text.as_bytes())
    } else {
        std::io::stdout().write_all(text.as_bytes())
    };
    match written {
        // The reader has read enough.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.context("cannot write the answer"),
    }
}

/// Writes a drawing, if one is asked for.
///
/// # Errors
/// It cannot be written.
pub fn drawn(outputs: &mut Outputs, path: Option<&Path>, draw: impl FnOnce() -> String) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let mut out = outputs.open(path)?;
    out.write_all(draw().as_bytes()).and_then(|()| out.flush()).context("cannot write the drawing")
}
