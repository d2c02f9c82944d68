//! The emulator: a QEMU process with a serial line to us.

use crate::processor;
use anyhow::{Context as _, Result, bail};
use std::fs::File;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
#[cfg(unix)]
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The program.
pub const PROGRAM: &str = "qemu-system-arm";

/// Longest time for the emulator to open its serial line, and to end on request.
const PATIENCE: Duration = Duration::from_secs(30);

/// A running emulator.
pub struct Emulator {
    process: Child,
    line: TcpStream,
    errors: PathBuf,
}

impl Emulator {
    /// Starts `image` in `folder`, where it finds `settings` and leaves `trace`, `log` and `errors`; a `plugin` of the
    /// emulator may watch.
    pub fn start(image: &Path, folder: &Path, plugin: Option<&str>) -> Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).context("cannot open a port")?;
        let port = listener.local_addr()?.port();
        let errors = folder.join("errors");
        let mut command = Command::new(PROGRAM);
        command
            .args(["-M", "mps2-an386", "-display", "none", "-monitor", "none"])
            // Virtual time counts instructions: 8 ns each, about what an STM32F446 needs on average.
            .args(["-icount", "shift=3,sleep=off"])
            .arg("-chardev")
            .arg(format!("socket,id=host,host=127.0.0.1,port={port},server=off,nodelay=on"))
            .args(["-serial", "chardev:host", "-kernel"])
            .arg(image)
            .args(["-semihosting-config", "enable=on,target=native,arg=corehbot,arg=settings,arg=trace"])
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(File::create(folder.join("log"))?)
            .stderr(File::create(&errors)?);
        if let Some(plugin) = plugin {
            command.args(["-plugin", plugin]);
        }
        // Ctrl-C goes to this program, which then asks the board to end.
        #[cfg(unix)]
        command.process_group(0);
        let process = command.spawn().with_context(|| format!("cannot run {PROGRAM}"))?;
        // From here on the process must not survive an error, hence the guard.
        let mut guard = Guard(Some(process));
        let line = accept(&listener, &mut guard, &errors)?;
        line.set_nodelay(true)?;
        let Some(process) = guard.0.take() else { bail!("the emulator is gone") };
        Ok(Self { process, line, errors })
    }

    /// The serial line.
    pub const fn line(&mut self) -> &mut TcpStream {
        &mut self.line
    }

    /// Waits for the end, and returns the processors' time that the emulator took. The board brings the end about if it
    /// was asked to; otherwise the wait is short. A failed end is an error with the board's last output.
    pub fn end(mut self, was_asked: bool) -> Result<Duration> {
        let patience = if was_asked { PATIENCE } else { Duration::from_secs(1) };
        let (status, taken) = wait(&mut self.process, patience)?;
        let words = std::fs::read_to_string(&self.errors).unwrap_or_default();
        match status {
            Some(status) if status.success() => Ok(taken),
            Some(status) => bail!("the board ended with {status}: {}", words.trim()),
            None if was_asked => bail!("the board does not end: {}", words.trim()),
            // A caller that did not ask reports an error of its own.
            None => Ok(taken),
        }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Kills the process unless it is taken out.
struct Guard(Option<Child>);

impl Drop for Guard {
    fn drop(&mut self) {
        if let Some(process) = &mut self.0 {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

fn accept(listener: &TcpListener, guard: &mut Guard, errors: &Path) -> Result<TcpStream> {
    listener.set_nonblocking(true)?;
    let begin = Instant::now();
    loop {
        match listener.accept() {
            Ok((line, _)) => {
                line.set_nonblocking(false)?;
                return Ok(line);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        let status = match &mut guard.0 {
            Some(process) => process.try_wait()?,
            None => None,
        };
        if status.is_some() || begin.elapsed() > PATIENCE {
            let words = std::fs::read_to_string(errors).unwrap_or_default();
            bail!("{PROGRAM} does not open its serial line: {}", words.trim());
        }
        sleep(Duration::from_millis(5));
    }
}

/// The status, if the process ends in time, and its processors' time when it was last seen.
fn wait(process: &mut Child, patience: Duration) -> Result<(Option<ExitStatus>, Duration)> {
    let (begin, mut taken) = (Instant::now(), Duration::ZERO);
    loop {
        taken = processor::of_process(process.id()).unwrap_or(taken);
        if let Some(status) = process.try_wait()? {
            return Ok((Some(status), taken));
        }
        if begin.elapsed() > patience {
            return Ok((None, taken));
        }
        sleep(Duration::from_millis(5));
    }
}
