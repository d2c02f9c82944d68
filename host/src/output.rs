//! Outputs: files that are written under a temporary name and renamed when they are complete.
//!
//! While `t.csv` is being written it is called `t.csv.partial`. So half a trace is never mistaken for a whole one, and
//! an older trace stays until there is a better one. A special file (`/dev/null`, a pipe) is written in place, and `-`
//! is standard output. No output may be an input or another output, whatever the paths are called.

use crate::stop::Stop;
use anyhow::{Context as _, Result, bail, ensure};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Stdout, Write};
use std::path::{Path, PathBuf};

/// Suffix of incomplete files.
const PARTIAL: &str = ".partial";

/// More symbolic links than this lead in a circle; Linux follows as many (path_resolution(7)).
const MOST_LINKS: usize = 40;

/// The path that means standard output, or input.
pub const STANDARD: &str = "-";

/// Where an output goes.
#[derive(Debug)]
pub enum Stream {
    /// A file.
    File(File),
    /// Standard output, and the command to stop when its reader is gone.
    Standard(Stdout, Stop),
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            Self::Standard(out, stop) => or_stop(out.write(bytes), bytes.len(), stop),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            Self::Standard(out, stop) => or_stop(out.flush(), (), stop),
        }
    }
}

/// A reader that closes the pipe has read enough, which is an end and not an error.
fn or_stop<T>(written: io::Result<T>, enough: T, stop: &Stop) -> io::Result<T> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
            stop.lose_reader();
            Ok(enough)
        }
        written => written,
    }
}

/// Identity of a file: two paths with the same identity are the same file.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Identity {
    /// Without symbolic links.
    path: PathBuf,
    /// Device and inode of a plain file that exists.
    inode: Option<(u64, u64)>,
}

impl Identity {
    fn new(path: &Path) -> Self {
        Self { path: absolute(path), inode: inode(path) }
    }

    fn is(&self, other: &Self) -> bool {
        self.path == other.path || self.inode.is_some() && self.inode == other.inode
    }
}

/// A file that is not whole yet; it is removed unless it is kept or left.
#[derive(Debug)]
struct Unfinished {
    partial: PathBuf,
    target: PathBuf,
    is_kept: bool,
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.is_kept {
            // This output was not promised, and no caller is left to report to.
            let _ = fs::remove_file(&self.partial);
        }
    }
}

/// The outputs of one command.
#[derive(Debug, Default)]
pub struct Outputs {
    inputs: Vec<(String, Identity)>,
    taken: Vec<Identity>,
    files: Vec<Unfinished>,
    is_standard_taken: bool,
    stop: Stop,
}

impl Outputs {
    /// Outputs of a command that reads these files, `-` being standard input. `stop` stops the command when the reader
    /// of its standard output is gone.
    #[must_use]
    pub fn new<'p>(inputs: impl IntoIterator<Item = &'p Path>, stop: Stop) -> Self {
        let input = |path: &Path| {
            let file = if path == Path::new(STANDARD) { Path::new("/dev/stdin") } else { path };
            (path.display().to_string(), Identity::new(file))
        };
        Self { inputs: inputs.into_iter().map(input).collect(), stop, ..Self::default() }
    }

    /// Opens an output.
    ///
    /// # Errors
    /// If it cannot be written, or is an input or another output.
    pub fn open(&mut self, path: &Path) -> Result<BufWriter<Stream>> {
        if path == Path::new(STANDARD) {
            ensure!(!self.is_standard_taken, "only one output can go to standard output");
            self.is_standard_taken = true;
            return Ok(BufWriter::new(Stream::Standard(io::stdout(), self.stop.clone())));
        }
        let cannot = || format!("cannot create {}", path.display());
        let target = follow(path).with_context(cannot)?;
        let file = match fs::metadata(&target) {
            Ok(there) if there.is_dir() => bail!("{}: it is a directory", cannot()),
            // A device or a pipe accepts data at once, and cannot be the target of a rename.
            Ok(there) if !there.is_file() => OpenOptions::new().write(true).open(&target).with_context(cannot)?,
            there => {
                let partial = beside(&target);
                self.claim(path, &target, &partial)?;
                let permissions = there.ok().map(|there| there.permissions());
                if permissions.is_some() {
                    // Renaming would also replace a file without write permission.
                    OpenOptions::new().write(true).open(&target).with_context(cannot)?;
                }
                let file = File::create(&partial).with_context(cannot)?;
                self.files.push(Unfinished { partial, target, is_kept: false });
                if let Some(permissions) = permissions {
                    file.set_permissions(permissions).with_context(cannot)?;
                }
                file
            }
        };
        Ok(BufWriter::new(Stream::File(file)))
    }

    /// Whether these outputs can be written; leaves nothing of them. A long computation asks before it begins.
    ///
    /// # Errors
    /// One cannot be written, or is an input or another output.
    pub fn check<'p>(mut self, paths: impl IntoIterator<Item = &'p Path>) -> Result<()> {
        for path in paths {
            // Opening a pipe waits for its reader, and closing it ends the reader.
            let is_special = fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir());
            if !is_special {
                self.open(path)?;
            }
        }
        Ok(())
    }

    /// Whether one of them goes to standard output, so that text for people must not.
    #[must_use]
    pub const fn is_standard_taken(&self) -> bool {
        self.is_standard_taken
    }

    /// All are whole: gives them their names.
    ///
    /// # Errors
    /// If one cannot be renamed.
    pub fn keep(mut self) -> Result<()> {
        for file in &mut self.files {
            let Unfinished { partial, target, .. } = &*file;
            fs::rename(partial, target)
                .with_context(|| format!("cannot rename {} to {}", partial.display(), target.display()))?;
            file.is_kept = true;
        }
        Ok(())
    }

    /// Leaves incomplete files, because they may be useful, and returns their names.
    #[must_use]
    pub fn leave(mut self) -> Vec<PathBuf> {
        self.files.iter_mut().for_each(|file| file.is_kept = true);
        self.files.iter().map(|file| file.partial.clone()).collect()
    }

    /// No other output may have the target, or the temporary name.
    fn claim(&mut self, path: &Path, target: &Path, partial: &Path) -> Result<()> {
        let both = [Identity::new(target), Identity::new(partial)];
        for (name, input) in &self.inputs {
            ensure!(!both.iter().any(|own| own.is(input)), "{} would overwrite the input {name}", path.display());
        }
        let is_taken = both.iter().any(|own| self.taken.iter().any(|other| own.is(other)));
        ensure!(!is_taken, "{} is another output already", path.display());
        self.taken.extend(both);
        Ok(())
    }
}

/// The path with `.partial` at its end.
fn beside(target: &Path) -> PathBuf {
    let mut name = OsString::from(target);
    name.push(PARTIAL);
    name.into()
}

/// The target of symbolic links, also if there is no file yet.
fn follow(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&target) {
            Ok(link) => target = target.parent().unwrap_or(Path::new("")).join(link),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// The path from the root and without symbolic links, as far as it exists.
fn absolute(path: &Path) -> PathBuf {
    if let Ok(whole) = path.canonicalize() {
        return whole;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    path.file_name().map_or_else(|| folder.clone(), |name| folder.join(name))
}

/// Device and inode, which hard links have in common.
#[cfg(unix)]
fn inode(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt as _;
    fs::metadata(path).ok().filter(fs::Metadata::is_file).map(|there| (there.dev(), there.ino()))
}

/// Hard links cannot be told from other files here.
#[cfg(not(unix))]
fn inode(_path: &Path) -> Option<(u64, u64)> {
    None
}

#[cfg(test)]
mod tests;
