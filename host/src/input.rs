//! Input: a G-code file of any size, read line by line.
//!
//! Input from a pipe is kept in a temporary file first, because it is read twice: once to count its commands and find
//! its limits, once to print it. So is the text of a packed file. Input that is not G-code is refused with its way.

use crate::output::STANDARD;
use crate::say::note;
use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use corehbot_gcode_file::{GcodeFileError, Unpacked, unpack};
use corehbot_machine_file::file_kind::{self, FileKind, START, Wanted, WrongFile};
use corehbot_machine_file::printable;
use corehbot_sim::lines::{Lines, Survey, survey};
use corehbot_sim::not_gcode::check_line;
use std::fs::File;
use std::io::{self, BufRead, BufReader, IsTerminal as _, Read, Seek as _};
use std::path::Path;

/// Bytes of the text in a packed file: hundred times as many as a long print has.
const MOST: u64 = 4 << 30;

/// Which part of a file.
#[derive(Clone, Copy, Default, Args)]
pub struct Plate {
    /// The plate of a sliced .3mf that has several; without it, a person at a terminal is asked.
    #[arg(long, value_name = "N")]
    plate: Option<u32>,
}

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
    /// If it cannot be read, or is not G-code.
    pub fn open(path: &Path, Plate { plate }: Plate) -> Result<Self> {
        let (name, file) = if path == Path::new(STANDARD) {
            ("stdin".to_owned(), keep(io::stdin().lock()).context("cannot read standard input")?)
        } else {
            let cannot = || format!("cannot open {}", path.display());
            let file = File::open(path).with_context(cannot)?;
            let kind = file.metadata().with_context(cannot)?;
            if kind.is_dir() {
                bail!("{}: {}", cannot(), WrongFile { kind: FileKind::Folder, wanted: Wanted::Gcode });
            }
            (path.display().to_string(), if kind.is_file() { file } else { keep(file).with_context(cannot)? })
        };
        let file = text_of(&file, &name, plate).with_context(|| name.clone())?.unwrap_or(file);
        Ok(Self { name, file })
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
}

/// The text of a packed file; `None` if the file is the text.
fn text_of(file: &File, name: &str, plate: Option<u32>) -> Result<Option<File>> {
    let text = tempfile::tempfile()?;
    match unpack(file, io::BufWriter::new(&text), plate, MOST) {
        Ok(Unpacked::AsItIs) => Ok(None),
        Ok(Unpacked::Written) => Ok(Some(text)),
        Err(GcodeFileError::Several(plates)) if io::stdin().is_terminal() && io::stderr().is_terminal() => {
            for plate in &plates {
                note(format_args!("plate {}: {}", plate.number, printable::line(&plate.name)));
            }
            note(format_args!("which plate of {}?", printable::line(name)));
            let mut answer = String::new();
            io::stdin().read_line(&mut answer).context("cannot read the answer")?;
            let chosen = answer.trim().parse().context("a plate is a number")?;
            let text = tempfile::tempfile()?;
            unpack(file, io::BufWriter::new(&text), Some(chosen), MOST)?;
            Ok(Some(text))
        }
        Err(error) => Err(error.into()),
    }
}

/// The whole text of a G-code file, in one piece.
///
/// # Errors
/// If it cannot be read, or is not text.
pub fn read(path: &Path, plate: Plate) -> Result<String> {
    let mut opened = GcodeFile::open(path, plate)?;
    opened.survey(|_| Ok(()))?;
    opened.file.rewind()?;
    let mut bytes = Vec::new();
    opened.file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The bytes of a file that is read at once. A folder or another kind of file is refused with its way.
///
/// # Errors
/// If it cannot be read, or is of another kind.
pub fn bytes(path: &Path, wanted: Wanted) -> Result<Vec<u8>> {
    let cannot = || format!("cannot open {}", path.display());
    ensure!(!path.is_dir(), "{}: {}", cannot(), WrongFile { kind: FileKind::Folder, wanted });
    let mut file = File::open(path).with_context(cannot)?;
    let (length, mut bytes) = (file.metadata().with_context(cannot)?.len(), Vec::new());
    (&mut file).take(START as u64).read_to_end(&mut bytes).with_context(cannot)?;
    wanted.check(FileKind::of(&bytes, length)).with_context(|| path.display().to_string())?;
    file.read_to_end(&mut bytes).with_context(cannot)?;
    Ok(bytes)
}

/// The text of such a file.
///
/// # Errors
/// If it cannot be read, or is of another kind.
pub fn text(path: &Path, wanted: Wanted) -> Result<String> {
    Ok(file_kind::text_of(&bytes(path, wanted)?))
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
