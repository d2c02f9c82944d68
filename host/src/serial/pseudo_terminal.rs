//! The port: a pseudo-terminal; a host opens its far end like a serial line.
//!
//! The far end is held open here too. Otherwise the near end would fail while no host has it open, and lose its raw
//! mode. Output without a host stays for the next host to read, or to discard, as pyserial does when it opens a port.

use anyhow::{Context as _, Result, bail};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
use rustix::io::{Errno, read, write};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::collections::VecDeque;
use std::ffi::OsString;
use std::fs::{read_link, remove_file, symlink_metadata};
use std::os::fd::{BorrowedFd, OwnedFd};
use std::os::unix::ffi::OsStringExt as _;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Bytes kept for a host that does not read, and the rest of a line that begins within them; the kernel keeps another
/// 4 KiB. A thousand answers, more than the longest report, and a host that leaves them unread has gone.
const BACKLOG: usize = 1 << 16;

/// A pseudo-terminal.
#[derive(Debug)]
pub struct Port {
    near: OwnedFd,
    /// Held open, see above.
    _far: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    backlog: VecDeque<u8>,
    line: Line,
}

/// Where the printer's output stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Line {
    /// A line begins.
    Begin,
    /// In a line that the host gets.
    Kept,
    /// In a line that is lost.
    Lost,
}

impl Port {
    /// A new pseudo-terminal, and a link to it if wanted.
    ///
    /// # Errors
    /// If no pseudo-terminal is available, or the link would replace something.
    pub fn open(link: Option<&Path>) -> Result<Self> {
        let near = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).context("cannot open a pseudo-terminal")?;
        grantpt(&near).and_then(|()| unlockpt(&near)).context("cannot unlock the pseudo-terminal")?;
        let path = ptsname(&near, Vec::new()).context("the pseudo-terminal has no name")?;
        let path = PathBuf::from(OsString::from_vec(path.into_bytes()));
        let named = || format!("cannot open {}", path.display());
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let far = open(&path, flags, Mode::empty()).with_context(named)?;
        let mut modes = tcgetattr(&far).with_context(named)?;
        modes.make_raw();
        tcsetattr(&far, OptionalActions::Now, &modes).with_context(named)?;
        fcntl_setfl(&near, OFlags::RDWR | OFlags::NONBLOCK).with_context(named)?;
        if let Some(link) = link {
            place(link, &path)?;
        }
        Ok(Self { near, _far: far, path, link: link.map(Path::to_owned), backlog: VecDeque::new(), line: Line::Begin })
    }

    /// The path for a host to open.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.link.as_deref().unwrap_or(&self.path)
    }

    /// Takes the bytes that the host has sent.
    ///
    /// # Errors
    /// If the pseudo-terminal fails.
    pub fn read(&self, into: &mut Vec<u8>) -> Result<()> {
        let mut bytes = [0; 1024];
        loop {
            match read(&self.near, &mut bytes) {
                Ok(0) | Err(Errno::AGAIN) => return Ok(()),
                Ok(count) => into.extend_from_slice(&bytes[..count]),
                Err(Errno::INTR) => {}
                Err(error) => return Err(error).context("cannot read from the pseudo-terminal"),
            }
        }
    }

    /// Sends bytes to the host. A line for which the backlog has no room is lost as a whole: half of one would be read
    /// as another answer.
    ///
    /// # Errors
    /// If the pseudo-terminal fails.
    pub fn write(&mut self, bytes: impl Iterator<Item = u8>) -> Result<()> {
        for byte in bytes {
            if self.line == Line::Begin {
                self.line = if self.backlog.len() < BACKLOG { Line::Kept } else { Line::Lost };
            }
            if self.line == Line::Kept {
                self.backlog.push_back(byte);
            }
            if byte == b'\n' {
                self.line = Line::Begin;
            }
        }
        while !self.backlog.is_empty() {
            match write(&self.near, self.backlog.as_slices().0) {
                Ok(count) => drop(self.backlog.drain(..count)),
                Err(Errno::AGAIN) => break,
                Err(Errno::INTR) => {}
                Err(error) => return Err(error).context("cannot write to the pseudo-terminal"),
            }
        }
        Ok(())
    }

    /// Waits until the host sends something, until it can receive pending output, or until `other` can be read; no
    /// longer than `patience`.
    ///
    /// # Errors
    /// If one of them fails.
    pub fn wait(&self, patience: Duration, other: Option<BorrowedFd<'_>>) -> Result<()> {
        let output = if self.backlog.is_empty() { PollFlags::empty() } else { PollFlags::OUT };
        let near = PollFd::new(&self.near, PollFlags::IN | output);
        let timeout = Timespec::try_from(patience).context("no such patience")?;
        let others = other.map(|other| PollFd::from_borrowed_fd(other, PollFlags::IN));
        let mut ends: Vec<_> = [near].into_iter().chain(others).collect();
        match poll(&mut ends, Some(&timeout)) {
            // A signal is for the caller to see.
            Ok(_) | Err(Errno::INTR) => Ok(()),
            Err(error) => Err(error).context("cannot wait for the pseudo-terminal"),
        }
    }
}

impl Drop for Port {
    fn drop(&mut self) {
        if let Some(link) = self.link.take().filter(|link| leads_to(link, &self.path)) {
            // It is stale from now on, and the next one replaces it.
            let _ = remove_file(link);
        }
    }
}

fn leads_to(link: &Path, path: &Path) -> bool {
    read_link(link).is_ok_and(|target| target == path)
}

/// Makes `link` lead to `path`. Nothing is replaced but a link that leads nowhere, or led to a terminal of this name
/// before there was this one.
fn place(link: &Path, path: &Path) -> Result<()> {
    if symlink_metadata(link).is_ok() {
        let is_stale = read_link(link).is_ok() && (!link.exists() || leads_to(link, path));
        if !is_stale {
            bail!("{} is there already", link.display());
        }
        remove_file(link).with_context(|| format!("cannot remove {}", link.display()))?;
    }
    symlink(path, link).with_context(|| format!("cannot create {}", link.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the host can read now.
    fn heard(port: &mut Port, far: &OwnedFd) -> String {
        let mut bytes = Vec::new();
        let mut part = [0; 1000];
        loop {
            port.write(std::iter::empty()).unwrap();
            match read(far, &mut part) {
                Ok(count) => bytes.extend_from_slice(&part[..count]),
                Err(Errno::AGAIN) if port.backlog.is_empty() => return String::from_utf8(bytes).unwrap(),
                Err(Errno::AGAIN) => {}
                Err(error) => panic!("{error}"),
            }
        }
    }

    /// Bytes come in pieces of any length, and a host that has read nothing for long reads again.
    #[test]
    fn a_backlog_that_is_full_loses_whole_lines() {
        let mut port = Port::open(None).unwrap();
        let far = open(port.path(), OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK, Mode::empty()).unwrap();
        let line = |i: usize| format!("Error:Line Number is not Last Line Number+1, Last Line: {i}\nok\n");
        for round in 0..3 {
            let text: String = (0..4000).map(line).collect();
            for piece in text.as_bytes().chunks(7 + round) {
                port.write(piece.iter().copied()).unwrap();
                assert!(port.backlog.len() < BACKLOG + line(4000).len());
            }
            let told = heard(&mut port, &far);
            assert!(told.len() >= BACKLOG && told.len() < text.len(), "{} bytes", told.len());
            assert!(told.ends_with('\n'));
            // In their order, and each of them was said.
            let mut said = text.lines();
            let unsaid: Vec<_> = told.lines().filter(|line| !said.by_ref().any(|own| own == *line)).collect();
            assert!(unsaid.is_empty(), "{unsaid:?}");
        }
        port.write(line(7).bytes()).unwrap();
        assert_eq!(heard(&mut port, &far), line(7));
    }
}
