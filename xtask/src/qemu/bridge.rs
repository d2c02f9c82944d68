//! The bridge: bytes between the board's serial port and a pseudo-terminal, in both directions as they come.

use super::line::END_OF_TRANSMISSION;
use anyhow::{Context as _, Result, bail};
use corehbot_host::serial::Port;
use corehbot_host::stop::Stop;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::TcpStream;
use std::os::fd::AsFd as _;
use std::time::Duration;

/// A signal ends the waiting by itself, except a signal that comes just before it.
const PATIENCE: Duration = Duration::from_millis(100);

/// Passes bytes on until it is over, and then asks the board to end.
pub fn talk(stream: &mut TcpStream, port: &mut Port, stop: &Stop) -> Result<()> {
    let mut said = [0; 1024];
    let mut sent = Vec::new();
    while !stop.is_set() {
        port.read(&mut sent)?;
        // Only this program may end the run.
        sent.retain(|byte| *byte != END_OF_TRANSMISSION);
        // The emulator buffers bytes that the board has not read yet, so this never waits for long.
        stream.set_nonblocking(false)?;
        stream.write_all(&sent).context("the board hung up")?;
        sent.clear();
        stream.set_nonblocking(true)?;
        let count = match stream.read(&mut said) {
            Ok(0) => bail!("the board hung up"),
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => 0,
            Err(error) => return Err(error).context("the board hung up"),
        };
        port.write(said[..count].iter().copied())?;
        port.wait(PATIENCE, Some(stream.as_fd()))?;
    }
    stream.set_nonblocking(false)?;
    stream.write_all(&[END_OF_TRANSMISSION]).context("the board hung up")
}
