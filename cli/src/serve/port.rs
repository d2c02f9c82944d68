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

/// Bytes kept for a host that does not read; the kernel keeps another 4 KiB. A thousand answers, more than the
/// longest report, and a host that leaves them unread has gone.
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
        Ok(Self { near, _far: far, path, link: link.map(Path::to_owned), backlog: VecDeque::new() })
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

    /// Sends bytes to the host; bytes that do not fit into the backlog are lost.
    ///
    /// # Errors
    /// If the pseudo-terminal fails.
    pub fn write(&mut self, bytes: impl Iterator<Item = u8>) -> Result<()> {
        let room = BACKLOG - self.backlog.len();
        let mut bytes = bytes;
        self.backlog.extend(bytes.by_ref().take(room));
        bytes.for_each(drop);
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
