//! The line: our end of the board's serial port.

use anyhow::{Context as _, Result, bail};
use corehbot::units::TICKS_PER_SECOND;
use corehbot_sim::world::Host;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// ASCII end of transmission: the board is to end once all motion is done.
pub const END_OF_TRANSMISSION: u8 = 0x04;

/// A board that is silent for this long has stopped. A busy board reports that every two seconds of its time, and its
/// time passes slower than ours only while it steps as fast as it can.
const SILENCE: Duration = Duration::from_secs(120);

/// A host that waits for something else than the board has a turn so often.
const TURN: Duration = Duration::from_millis(500);

/// Ticks in a us.
const TICKS_PER_US: u32 = TICKS_PER_SECOND / 1_000_000;

/// The greeting is over when nothing has followed for so long.
const PAUSE: Duration = Duration::from_millis(50);

/// Lets `host` talk to the board until the host is done, then asks the board to end. If `heard` reports each byte that
/// the board has heard, a byte waits until the board has heard the previous one.
pub fn talk(stream: &mut TcpStream, host: &mut dyn Host, heard: Option<TcpStream>) -> Result<()> {
    let mut line = Line { stream, heard, spoken: Vec::new() };
    if !line.hear(host, SILENCE)? {
        bail!("the board does not greet");
    }
    while line.hear(host, PAUSE)? {}
    let mut wire = Vec::new();
    let (begin, mut heard) = (Instant::now(), Instant::now());
    while !host.is_done() {
        host.clock((begin.elapsed().as_micros() * u128::from(TICKS_PER_US)) as u64);
        host.interject(&mut wire);
        host.send(&mut wire);
        line.send(&wire)?;
        wire.clear();
        if line.hear(host, TURN)? {
            heard = Instant::now();
        } else if heard.elapsed() > SILENCE {
            bail!("the board has said nothing for {} s", SILENCE.as_secs());
        }
    }
    line.send(&[END_OF_TRANSMISSION])
}

struct Line<'s> {
    stream: &'s mut TcpStream,
    /// Where a byte comes for every byte that the board has heard, if anywhere.
    heard: Option<TcpStream>,
    /// The board's output of an incomplete line.
    spoken: Vec<u8>,
}

impl Line<'_> {
    fn send(&mut self, bytes: &[u8]) -> Result<()> {
        let Some(heard) = &mut self.heard else {
            return self.stream.write_all(bytes).context("the board hung up");
        };
        heard.set_read_timeout(Some(SILENCE))?;
        for byte in bytes {
            self.stream.write_all(&[*byte]).context("the board hung up")?;
            heard.read_exact(&mut [0]).context("the board does not listen")?;
        }
        Ok(())
    }

    /// Hands the board's output to `host`; returns false if it is silent for `patience`.
    fn hear(&mut self, host: &mut dyn Host, patience: Duration) -> Result<bool> {
        self.stream.set_read_timeout(Some(patience))?;
        let mut bytes = [0; 256];
        let count = match self.stream.read(&mut bytes) {
            Ok(0) => bail!("the board hung up"),
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => return Ok(false),
            Err(error) => return Err(error).context("the board hung up"),
        };
        for &byte in &bytes[..count] {
            if byte == b'\n' {
                host.hear(&String::from_utf8_lossy(&self.spoken));
                self.spoken.clear();
            } else {
                self.spoken.push(byte);
            }
        }
        Ok(true)
    }
}
