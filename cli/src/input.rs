//! Input: a G-code file of any size, read line by line.
//!
//! Input from a pipe is kept in a temporary file first, because it is read twice: once to count its commands and find
//! its limits, once to print it. Input that is not text is refused with a hint.

use crate::output::STANDARD;
use anyhow::{Context as _, Result, ensure};
use corehbot_sim::lines::{Lines, Survey, survey};
use corehbot_sim::not_gcode::{HEAD, check_head, check_line};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek as _};
use std::path::Path;

/// A G-code file that can be read twice.
#[derive(Debug)]
pub struct GcodeFile {
    /// Its name in messages.
    pub name: String,
    file: File,
}

impl GcodeFile {
    /// Opens a file, `-` being standard input.
    ///
    /// # Errors
    /// If it cannot be read, or is not text.
    pub fn open(path: &Path) -> Result<Self> {
        let (name, file) = if path == Path::new(STANDARD) {
            ("stdin".to_owned(), keep(io::stdin().lock()).context("cannot read standard input")?)
        } else {
            let cannot = || format!("cannot open {}", path.display());
            let file = File::open(path).with_context(cannot)?;
            let kind = file.metadata().with_context(cannot)?;
            ensure!(!kind.is_dir(), "{}: it is a directory", cannot());
            (path.display().to_string(), if kind.is_file() { file } else { keep(file).with_context(cannot)? })
        };
        let mut opened = Self { name, file };
        opened.refuse_binaries()?;
        Ok(opened)
    }

    /// Counts its commands and shows `each`.
    ///
    /// # Errors
    /// If it cannot be read, a line is not text, or the error from `each`.
    pub fn survey(&mut self, mut each: impl FnMut(&str) -> Result<()>) -> Result<Survey> {
        self.file.rewind().with_context(|| self.name.clone())?;
        let each = |number, line: &str, command: &str| {
            check_line(number, line, command)?;
            if command.is_empty() { Ok(()) } else { each(command) }
        };
        survey(&mut Lines::new(BufReader::new(&self.file)), each).with_context(|| self.name.clone())
    }

    /// The same file, to be read once more after its lines.
    ///
    /// # Errors
    /// If the system gives no other handle for it.
    pub fn again(&self) -> Result<File> {
        self.file.try_clone().with_context(|| self.name.clone())
    }

    /// Its lines from the first on.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn into_lines(mut self) -> Result<Lines<Box<dyn BufRead + Send>>> {
        self.file.rewind().with_context(|| self.name.clone())?;
        Ok(Lines::new(Box::new(BufReader::new(self.file))))
    }

    fn refuse_binaries(&mut self) -> Result<()> {
        let mut head = Vec::new();
        (&self.file).take(HEAD as u64).read_to_end(&mut head).with_context(|| format!("cannot read {}", self.name))?;
        check_head(&head).with_context(|| self.name.clone())
    }
}

/// The whole text of a G-code file, in one piece.
///
/// # Errors
/// If it cannot be read, or is not text.
pub fn read(path: &Path) -> Result<String> {
    let mut opened = GcodeFile::open(path)?;
    opened.survey(|_| Ok(()))?;
    opened.file.rewind()?;
    let mut bytes = Vec::new();
    opened.file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Keeps input that can be read only once in a temporary file.
fn keep(mut from: impl Read) -> io::Result<File> {
    let mut file = tempfile::tempfile()?;
    io::copy(&mut from, &mut file)?;
    file.rewind()?;
    Ok(file)
}

#[cfg(test)]
mod tests;
