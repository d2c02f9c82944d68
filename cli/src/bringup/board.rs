//! The board: lines to it, its answers, and how it is brought to rest.

use super::owner::Owner;
use super::step_error::StepError;
use corehbot_host::serial::SerialLine;
use corehbot_machine_file::printable;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Seconds of silence after which the board counts as absent, unless the owner states others. A board says `busy` every
/// 2 s, and is silent for half a second while it stores settings in flash. A restarted board has greeted by then, and a
/// computer has found its USB port again.
pub(super) const SILENCE: u8 = 8;

/// Silence after which a board has said all that it says by itself.
const QUIET: Duration = Duration::from_millis(500);

/// The second line of a greeting. The first one may end a line that the reset has cut.
const GREETING: &str = "echo:corehbot ";

/// What the greeting begins with after a reset that nobody asked for.
const REASON: &str = "echo:the last reset came after ";

/// Orders that bring it to rest, each of them harmless at any time: the first two act at once, as they arrive.
const REST: [&str; 6] = ["M410", "M108", "M104 S0", "M140 S0", "M141 S0", "M84"];

/// What the board repeats after these orders (M118). Their `ok`s do not tell them from the order before.
const AT_REST: &str = "bringup: at rest";

/// The board at the end of a serial line.
pub(super) struct Board {
    port: SerialLine,
    path: PathBuf,
    baud: u32,
    /// Silence after which it counts as absent.
    pub patience: Duration,
    part: Vec<u8>,
    last: Instant,
}

impl Board {
    pub fn open(path: &Path, baud: u32, patience: Duration) -> anyhow::Result<Self> {
        let port = SerialLine::open(path, baud)?;
        Ok(Self { port, path: path.to_owned(), baud, patience, part: Vec::new(), last: Instant::now() })
    }

    /// The answer to a line, without its `ok`.
    pub fn ask(&mut self, line: &str, owner: &Owner) -> Result<Vec<String>, StepError> {
        self.ask_and(line, owner, |_, _| Ok(()))
    }

    /// The same while motors move: Enter stops everything with M112.
    pub fn ask_watched(&mut self, line: &str, owner: &Owner) -> Result<Vec<String>, StepError> {
        self.ask_and(line, owner, |board, _| {
            if owner.has_interrupted() {
                board.port.write(b"M112\n")?;
            }
            Ok(())
        })
    }

    /// The same, and `meanwhile` gets every line that is heard before the end.
    pub fn ask_and(
        &mut self,
        line: &str,
        owner: &Owner,
        mut meanwhile: impl FnMut(&mut Self, Option<&str>) -> Result<(), StepError>,
    ) -> Result<Vec<String>, StepError> {
        self.port.write(format!("{line}\n").as_bytes())?;
        self.last = Instant::now();
        let mut heard = Vec::new();
        loop {
            owner.look_at_stop()?;
            let lines = self.hear()?;
            if lines.is_empty() {
                meanwhile(self, None)?;
            }
            for line in lines {
                if let Some(after) = line.strip_prefix("ok") {
                    heard.extend((!after.is_empty()).then(|| after.trim().to_owned()));
                    return Ok(heard);
                }
                if is_halt(&line) {
                    // The line before has the fault, if there is one.
                    let why = heard.iter().rev().find(|line: &&String| line.starts_with("Error:")).unwrap_or(&line);
                    return Err(StepError::Halted(why.trim_start_matches("Error:").to_owned()));
                }
                if line.starts_with(GREETING) {
                    let reason = heard.iter().find_map(|line: &String| line.strip_prefix(REASON));
                    return Err(StepError::Restarted(reason.unwrap_or("it does not say why").to_owned()));
                }
                meanwhile(self, Some(&line))?;
                if !line.starts_with("echo:busy") {
                    heard.push(line);
                }
            }
        }
    }

    /// Sends a line and leaves its answer to whoever asks next.
    pub fn tell(&self, line: &str) -> Result<(), StepError> {
        Ok(self.port.write(format!("{line}\n").as_bytes())?)
    }

    /// Lines that have come; nothing heard for long is an error.
    fn hear(&mut self) -> Result<Vec<String>, StepError> {
        let mut bytes = [0; 512];
        let count = self.port.read(&mut bytes)?;
        if count > 0 {
            self.last = Instant::now();
        } else if self.last.elapsed() > self.patience {
            let (path, seconds) = (self.path.display(), self.patience.as_secs());
            return Err(StepError::Lost(format!("nothing on {path} at {} baud for {seconds} s", self.baud)));
        }
        let mut lines = Vec::new();
        for byte in bytes.iter().take(count) {
            if *byte == b'\n' {
                let line = String::from_utf8_lossy(&std::mem::take(&mut self.part)).trim_end().to_owned();
                lines.push(printable::line(&line).to_string());
            } else {
                self.part.push(*byte);
            }
        }
        Ok(lines)
    }

    /// Throws away what the board says by itself, until it has been silent for a while. A USB port that has gone with
    /// a reset comes back meanwhile.
    pub fn drain(&mut self, owner: &Owner) -> Result<(), StepError> {
        let (begin, mut quiet) = (Instant::now(), Instant::now());
        while quiet.elapsed() < QUIET {
            owner.look_at_stop()?;
            match self.hear_again() {
                Ok(lines) if lines.is_empty() => {}
                Err(trouble) if begin.elapsed() > self.patience => return Err(trouble),
                Ok(_) | Err(_) => quiet = Instant::now(),
            }
        }
        Ok(())
    }

    /// Lines that have come, however long the silence. A port that is gone is opened again, for the next time.
    fn hear_again(&mut self) -> Result<Vec<String>, StepError> {
        self.last = Instant::now();
        let heard = self.hear();
        if heard.is_err() {
            std::thread::sleep(Duration::from_millis(200));
            if let Ok(port) = SerialLine::open(&self.path, self.baud) {
                self.port = port;
                self.part.clear();
            }
        }
        heard
    }

    /// Restarts a firmware that has stopped everything.
    pub fn restart(&mut self, owner: &Owner) -> Result<(), StepError> {
        self.port.write(b"M999\n")?;
        let begin = Instant::now();
        while begin.elapsed() < self.patience {
            owner.look_at_stop()?;
            if self.hear_again().is_ok_and(|lines| lines.iter().any(|line| line.starts_with(GREETING))) {
                return self.drain(owner);
            }
        }
        Err(StepError::Lost("it did not restart after M999; switch it off and on".to_owned()))
    }

    /// Heaters off, motors without power. If the board does not confirm it within half of the patience, M112 does it at
    /// once. Returns whether it has confirmed it.
    pub fn rest(&mut self) -> Result<bool, StepError> {
        let begin = Instant::now();
        let orders = REST.into_iter().map(str::to_owned).chain([format!("M118 {AT_REST}")]);
        for order in orders {
            self.port.write(format!("{order}\n").as_bytes())?;
        }
        while begin.elapsed() < self.patience / 2 {
            self.last = Instant::now();
            if self.hear()?.iter().any(|line| line == AT_REST || is_halt(line)) {
                return Ok(true);
            }
        }
        self.port.write(b"M112\n")?;
        Ok(false)
    }
}

/// Whether a line says that only M999 or a reset helps.
fn is_halt(line: &str) -> bool {
    line.starts_with("Error:") && line.contains("kill()")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_stop_is_one() {
        assert!(is_halt("Error:Printer halted. kill() called! Send M999 or reset"));
        for line in ["Error:Homing failed: X endstop was not met", "ok", "echo:M999", "Error:driver of motor m1"] {
            assert!(!is_halt(line), "{line}");
        }
    }
}
