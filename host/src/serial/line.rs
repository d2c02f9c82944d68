//! The serial line to a board, for commands that have to be answered.

use super::ports::cannot_open;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host as _;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::{read, write};
use rustix::termios::{OptionalActions, QueueSelector, SpecialCodeIndex, tcflush, tcgetattr, tcsetattr};
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Silence after which the board counts as absent: a board that stores settings in flash is silent for half a second.
const SILENCE: Duration = Duration::from_secs(8);

/// A line to a board.
pub struct SerialLine {
    line: OwnedFd,
    path: PathBuf,
    baud: u32,
}

impl SerialLine {
    /// Opens the line; whatever the board has said so far is thrown away.
    pub fn open(path: &Path, baud: u32) -> Result<Self> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let line = open(path, flags, Mode::empty()).map_err(|error| cannot_open(path, error))?;
        let line = Self { line, path: path.to_owned(), baud };
        line.tune()?;
        Ok(line)
    }

    /// Goes on at another rate; whatever has come so far is thrown away.
    pub fn retune(&mut self, baud: u32) -> Result<()> {
        self.baud = baud;
        self.tune()
    }

    fn tune(&self) -> Result<()> {
        let (line, path, baud) = (&self.line, &self.path, self.baud);
        let mut modes = tcgetattr(line).map_err(|error| cannot_open(path, error))?;
        modes.make_raw();
        modes.set_speed(baud).with_context(|| format!("{} has no rate of {baud} baud", path.display()))?;
        // A read ends after a tenth of a second, with whatever has come.
        modes.special_codes[SpecialCodeIndex::VMIN] = 0;
        modes.special_codes[SpecialCodeIndex::VTIME] = 1;
        tcsetattr(line, OptionalActions::Now, &modes).map_err(|error| cannot_open(path, error))?;
        tcflush(line, QueueSelector::IOFlush).map_err(|error| cannot_open(path, error))
    }

    /// Sends commands as a print, with numbers and checksums, and again where the board asks for it. Returns the
    /// replies.
    pub fn talk(&mut self, commands: &str) -> Result<Vec<String>> {
        let (mut host, mut heard, mut part) = (FileHost::new(commands), Vec::new(), Vec::new());
        let mut active = Instant::now();
        while !host.is_done() {
            let mut out = Vec::new();
            host.send(&mut out);
            self.write(&out)?;
            let mut bytes = [0; 256];
            let count = self.read(&mut bytes)?;
            if count > 0 {
                active = Instant::now();
            } else if active.elapsed() > SILENCE {
                bail!("nothing answers on {} at {} baud", self.path.display(), self.baud);
            }
            for byte in &bytes[..count] {
                if *byte != b'\n' {
                    part.push(*byte);
                    continue;
                }
                let line = String::from_utf8_lossy(&std::mem::take(&mut part)).trim_end().to_owned();
                host.hear(&line);
                heard.push(line);
            }
        }
        match host.failure() {
            Some(failure) => bail!("{failure}"),
            None => Ok(heard),
        }
    }

    /// Takes bytes that come within a tenth of a second.
    pub fn read(&self, bytes: &mut [u8]) -> Result<usize> {
        let count = read(&self.line, bytes).with_context(|| format!("cannot read {}", self.path.display()))?;
        ensure!(count > 0 || !self.is_gone(), "{} is gone: unplugged, or its board was reset", self.path.display());
        Ok(count)
    }

    /// Whether nothing is plugged in any more. A read of such a line only says that nothing has come.
    fn is_gone(&self) -> bool {
        let mut line = [PollFd::new(&self.line, PollFlags::empty())];
        poll(&mut line, Some(&Timespec::default())).is_ok()
            && line.iter().any(|line| line.revents().contains(PollFlags::HUP))
    }

    /// Sends bytes.
    pub fn write(&self, mut bytes: &[u8]) -> Result<()> {
        while !bytes.is_empty() {
            let count = write(&self.line, bytes).with_context(|| format!("cannot write to {}", self.path.display()))?;
            bytes = &bytes[count..];
        }
        Ok(())
    }
}
