//! `corehbot serve`: the firmware as a printer at the end of a serial line, in real time or faster.
//!
//! The loop turns the same world as `corehbot run`, but the host is a real one behind a pseudo-terminal, and virtual
//! time is held against the wall clock. It ends with a signal, which is no failure.

mod pace;
mod port;
mod screen;
mod wire;

use crate::cli::{Printer, create};
use crate::drivers::Drivers;
use crate::eeprom::Eeprom;
use crate::trace::TraceWriter;
use crate::world::{Desk, Sink, World};
use anyhow::{Context as _, Result};
use clap::Args;
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::TICKS_PER_SECOND;
use pace::{Pace, Speed};
pub use port::Port;
use screen::Screen;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use wire::Delay;

/// At full speed the port is looked at no more often than this: a look takes a microsecond, and so does a virtual
/// millisecond.
const LOOK: Duration = Duration::from_micros(100);

/// What printer to be, and where.
#[derive(Args)]
pub(crate) struct Serve {
    /// Makes a link here to the serial port; without it, the port's own name is printed.
    #[arg(long, value_name = "PATH")]
    pty: Option<PathBuf>,
    /// Sends and receives bytes no faster than a UART at this rate; without it, the line takes no time.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=10_000_000))]
    baud: Option<u32>,
    /// So many times as fast as real time, or `max`: as fast as it can be computed, but in real time (after 0.25 s)
    /// while it waits for the host.
    #[arg(long, value_name = "X", default_value = "1", value_parser = pace::parse)]
    speed: Speed,
    #[command(flatten)]
    printer: Printer,
    /// Writes every step event as CSV.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
}

/// Everything that can be wrong before there is a printer.
pub(crate) struct Prepared {
    settings: Settings,
    eeprom: Option<Eeprom>,
    trace: TraceWriter<BufWriter<File>>,
    port: Port,
    is_over: Arc<AtomicBool>,
}

impl Sink for TraceWriter<BufWriter<File>> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.event(tick, steps, forward);
    }
}

impl Prepared {
    pub fn new(args: &Serve) -> Result<Self> {
        let settings = args.printer.machine()?.settings;
        let eeprom = args.printer.eeprom()?;
        let trace = args.trace.as_deref().map(create).transpose()?;
        let is_over = until_signal()?;
        let port = Port::open(args.pty.as_deref())?;
        Ok(Self { settings, eeprom, trace: TraceWriter::new(trace, (&settings).into()), port, is_over })
    }

    /// Is a printer until a signal comes.
    pub fn run(self, args: &Serve) -> Result<bool> {
        let Self { settings, mut eeprom, mut trace, port, is_over } = self;
        println(format_args!("{}", port.path().display()))?;
        let (drivers, mut desk) = (Drivers::new(), Desk::new(1));
        let start = args.printer.assume_homed;
        let world = match &mut eeprom {
            Some(eeprom) => World::new(&mut desk, &settings, start, eeprom, &drivers, &mut trace),
            None => World::new(&mut desk, &settings, start, NoStorage, &drivers, &mut trace),
        };
        let server = Server {
            world,
            port,
            pace: Pace::new(args.speed),
            screen: Screen::new(&settings, start.unwrap_or(corehbot_rig::AT_POWER_UP)),
            inbound: Delay::new(args.baud),
            outbound: Delay::new(args.baud),
        };
        let outcome = server.serve(&is_over)?;
        let trace = trace.finish().context("cannot write the trace")?;
        println(format_args!("motion time  {:.3} s", outcome.ticks as f64 / f64::from(TICKS_PER_SECOND)))?;
        println(format_args!("moves        {}, underruns {}", outcome.moves, outcome.underruns))?;
        println(format_args!("sha256       {}", trace.sha256))?;
        Ok(true)
    }
}

/// A flag that Ctrl-C sets, and what else ends a process in an orderly way.
///
/// # Errors
/// If the system does not take the handlers.
pub fn until_signal() -> Result<Arc<AtomicBool>> {
    let is_over = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&is_over)).context("cannot wait for Ctrl-C")?;
    }
    Ok(is_over)
}

/// Says a line at once; whoever does not listen any more has heard enough.
///
/// # Errors
/// If it cannot be written.
pub fn println(line: std::fmt::Arguments<'_>) -> Result<()> {
    let mut out = std::io::stdout();
    match writeln!(out, "{line}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => written.context("cannot write to standard output"),
    }
}

/// A printer in its world, with a line to the world outside.
struct Server<'w> {
    world: World<'w>,
    port: Port,
    pace: Pace,
    screen: Screen,
    inbound: Delay,
    outbound: Delay,
}

impl Server<'_> {
    fn serve(mut self, is_over: &AtomicBool) -> Result<crate::world::Outcome> {
        let begin = Instant::now();
        let mut look = Duration::ZERO;
        while !is_over.load(Ordering::Relaxed) {
            let wall = begin.elapsed();
            if wall >= look {
                self.hear_host()?;
                self.screen.show(wall, &self.world);
                look = wall + LOOK;
            }
            self.talk()?;
            let is_on_the_way = !(self.inbound.is_empty() && self.outbound.is_empty());
            let is_awaiting_host = !is_on_the_way && self.world.is_awaiting_hosts();
            let wait = self.pace.wait(wall, self.world.now(), is_awaiting_host);
            if wait.is_zero() {
                self.world.advance();
            } else {
                self.port.wait(wait, None)?;
                look = Duration::ZERO;
            }
        }
        self.screen.close();
        Ok(self.world.outcome())
    }

    fn hear_host(&mut self) -> Result<()> {
        let mut bytes = Vec::new();
        self.port.read(&mut bytes)?;
        if !bytes.is_empty() {
            self.pace.hear();
            self.inbound.send(self.world.now(), bytes);
        }
        Ok(())
    }

    /// Bytes arrive on both ends of the wire.
    fn talk(&mut self) -> Result<()> {
        let now = self.world.now();
        for wire in self.world.wires() {
            wire.put(self.inbound.receive(now));
            self.world.poll();
            let said = wire.heard();
            self.screen.hear(&said);
            self.outbound.send(now, said);
        }
        self.port.write(self.outbound.receive(now))
    }
}
