//! Input: a G-code file of any size, read line by line.
//!
//! Input from a pipe is kept in a temporary file first, because it is read twice: once to count its commands and find
//! its limits, once to print it. Input that is not text is refused with a hint.

use crate::output::STANDARD;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot_sim::lines::{LONGEST_LINE, Lines, Survey, survey};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek as _};
use std::path::Path;

/// Bytes that identify a kind of file.
const HEAD: usize = 512;

/// Files that slicers and people mistake for G-code, by their first bytes, and a hint for each.
const KINDS: [(&[u8], &str); 16] = [
    (
        b"GCDE",
        "binary G-code (.bgcode); PrusaSlicer's File > Convert makes plain G-code of it, and Printer Settings > \
        General > \
         Supports binary G-code switches it off",
    ),
    (
        b"PK\x03\x04",
        "a ZIP archive (.3mf, .ufp); export plain G-code, or unpack it: Bambu's G-code is Metadata/plate_1.gcode in it",
    ),
    (b"\x1f\x8b", "packed by gzip; `gunzip -c FILE | corehbot run -` prints it"),
    (b"BZh", "packed by bzip2; `bunzip2 -c FILE | corehbot run -` prints it"),
    (b"\xfd7zXZ\0", "packed by xz; `unxz -c FILE | corehbot run -` prints it"),
    (b"\x28\xb5\x2f\xfd", "packed by zstd; `unzstd -c FILE | corehbot run -` prints it"),
    (b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive; unpack it"),
    (b"\xff\xfe\0\0", "text in UTF-32; `iconv -f UTF-32 -t UTF-8 FILE | corehbot run -` prints it"),
    (b"\xff\xfe", "text in UTF-16; `iconv -f UTF-16 -t UTF-8 FILE | corehbot run -` prints it"),
    (b"\xfe\xff", "text in UTF-16; `iconv -f UTF-16 -t UTF-8 FILE | corehbot run -` prints it"),
    (b"\x7fELF", "a program; an image of the firmware runs with `cargo xtask emulate`"),
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"solid ", "a model (STL); slice it first"),
    (b"ISO-10303-21", "a model (STEP); slice it first"),
];

/// Refuses a line that is not text.
fn check(number: u32, line: &str, command: &str) -> Result<()> {
    ensure!(!line.contains('\0'), "line {number} contains a zero byte: this is not text");
    ensure!(command.len() < LONGEST_LINE, "line {number} is longer than a MiB: this is not G-code");
    Ok(())
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
            check(number, line, command)?;
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
        if let Some((_, kind)) = KINDS.iter().find(|(begin, _)| head.starts_with(begin)) {
            bail!("{} is not G-code but {kind}", self.name);
        }
        // Without a mark, half of the bytes of such a text are 0 all the same.
        let zeros = head.iter().filter(|byte| **byte == 0).count();
        if 5 * zeros > 2 * head.len() && head.chunks(2).all(|pair| pair.contains(&0) != pair.iter().all(|b| *b == 0)) {
            bail!("{} is not G-code but {}", self.name, KINDS[8].1);
        }
        ensure!(zeros == 0, "{} is not G-code but binary data", self.name);
        Ok(())
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
