//! The serial line to a board, for commands that have to be answered.

use anyhow::{Context as _, Result, bail};
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host as _;
use rustix::fs::{Mode, OFlags, open};
use rustix::io::{read, write};
use rustix::termios::{OptionalActions, QueueSelector, SpecialCodeIndex, tcflush, tcgetattr, tcsetattr};
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Silence after which the board counts as absent: a board that stores settings in flash is silent for half a second.
const SILENCE: Duration = Duration::from_secs(8);

/// A line to a board.
pub(super) struct SerialLine {
    line: OwnedFd,
    path: PathBuf,
    baud: u32,
}

impl SerialLine {
    /// Opens the line; whatever the board has said so far is thrown away.
    pub fn open(path: &Path, baud: u32) -> Result<Self> {
        let cannot = || format!("cannot open {} as a serial line", path.display());
        let line = open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).with_context(cannot)?;
        let mut modes = tcgetattr(&line).with_context(cannot)?;
        modes.make_raw();
        modes.set_speed(baud).with_context(|| format!("{} has no rate of {baud} baud", path.display()))?;
        // A read ends after a tenth of a second, with whatever has come.
        modes.special_codes[SpecialCodeIndex::VMIN] = 0;
        modes.special_codes[SpecialCodeIndex::VTIME] = 1;
        tcsetattr(&line, OptionalActions::Now, &modes).with_context(cannot)?;
        tcflush(&line, QueueSelector::IOFlush).with_context(cannot)?;
        Ok(Self { line, path: path.to_owned(), baud })
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
            let count = read(&self.line, &mut bytes).with_context(|| format!("cannot read {}", self.path.display()))?;
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

    fn write(&self, mut bytes: &[u8]) -> Result<()> {
        while !bytes.is_empty() {
            let count = write(&self.line, bytes).with_context(|| format!("cannot write to {}", self.path.display()))?;
            bytes = &bytes[count..];
        }
        Ok(())
    }
}
