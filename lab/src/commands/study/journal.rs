//! Journal: the finished samples, in a file next to the result until that is complete.
//!
//! A file that is only appended to, one line a sample ([`super::line`]), the study's own line first. A killed process
//! leaves at most half a line at its end. A last line without a line end is cut off before the next sample is written,
//! and a line with a wrong check is ignored. Only one process may write at a time. Some network drives cannot lock
//! files; there the user must make sure of that.

use super::line;
use super::plan::{Sample, Study};
use anyhow::{Context as _, Result, bail};
use corehbot_host::say::note;
use std::ffi::OsString;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

/// Suffix of journals.
const ENDING: &str = ".journal";

/// A journal, open for more samples.
#[derive(Debug)]
pub(in crate::commands) struct Journal {
    file: File,
    pub path: PathBuf,
    /// Whether it has no sample.
    is_empty: bool,
}

impl Journal {
    /// The journal of the result at `path`, and the samples that it has.
    ///
    /// # Errors
    /// It is of another study, another process writes it, or it cannot be written.
    pub(super) fn open(path: &Path, study: &Study) -> Result<(Self, Vec<Sample>)> {
        let mut name = OsString::from(path);
        name.push(ENDING);
        let path = PathBuf::from(name);
        let cannot = || format!("cannot open {}", path.display());
        let file = OpenOptions::new().read(true).append(true).create(true).open(&path).with_context(cannot)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => bail!("{}: another process computes these samples", path.display()),
            Err(TryLockError::Error(error)) => note(format_args!(
                "corehbot: {} cannot be locked ({error}); make sure that no other process computes these samples",
                path.display()
            )),
            Ok(()) => {}
        }
        let mut journal = Self { file, path, is_empty: true };
        let kept = journal.read(study).with_context(|| journal.path.display().to_string())?;
        journal.is_empty = kept.is_empty();
        Ok((journal, kept))
    }

    /// Keeps the line of a sample.
    ///
    /// # Errors
    /// It cannot be written.
    pub(super) fn append(&mut self, line: &str) -> Result<()> {
        self.is_empty = false;
        self.write(line)
    }

    fn write(&mut self, line: &str) -> Result<()> {
        let written = self.file.write_all(format!("{line}\n").as_bytes());
        written.with_context(|| format!("cannot write {}", self.path.display()))
    }

    /// Takes it away: the result is whole.
    ///
    /// # Errors
    /// It cannot be removed.
    pub(super) fn remove(self) -> Result<()> {
        std::fs::remove_file(&self.path).with_context(|| format!("cannot remove {}", self.path.display()))
    }

    /// Takes it away if it has no sample: nothing came of the study.
    ///
    /// # Errors
    /// It cannot be removed.
    pub(super) fn remove_if_empty(self) -> Result<()> {
        if self.is_empty { self.remove() } else { Ok(()) }
    }

    /// The samples in it; an incomplete line at its end is cut off.
    fn read(&mut self, study: &Study) -> Result<Vec<Sample>> {
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(0)).and_then(|_| self.file.read_to_end(&mut bytes)).context("cannot read it")?;
        let head = line::head(study)?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let text = bytes.get(..whole).map(String::from_utf8_lossy).unwrap_or_default();
        let mut lines = text.lines();
        match lines.next() {
            Some(first) if first == head => {}
            Some(first) if line::is_head(first) => {
                bail!(
                    "is of another study, or of this one with another version of the command or on another kind of \
                     machine; remove it, or name another output"
                )
            }
            Some(_) => bail!("is not a journal of a study; remove it, or name another output"),
            None if head.as_bytes().starts_with(&bytes) => {}
            None => bail!("is not a journal of a study; remove it, or name another output"),
        }
        self.file.set_len(whole as u64).context("cannot cut it")?;
        if whole == 0 {
            self.write(&head)?;
        }
        Ok(lines.filter_map(|line| line::sample(study, line)).collect())
    }
}
