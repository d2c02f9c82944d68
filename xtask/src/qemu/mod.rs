//! `cargo xtask qemu`: a print on the firmware in QEMU.
//!
//! The emulator runs in a folder of its own with the job in it. It gets the G-code over its serial line as a printer
//! would, and leaves the step events in a file. With `--serve`, any host can use the line.

#[cfg(unix)]
mod bridge;
mod dump;
mod emulator;
mod job;
mod line;
mod log;

pub use emulator::PROGRAM;
pub use job::{Job, Outcome, SCALED_PATIENCE_MS, Watcher};
pub use line::talk as converse;

use crate::images;
use anyhow::Result;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_host::input::{self, Plate};
use corehbot_machine_file as machine_file;
use corehbot_machine_file::printable;
use std::path::{Path, PathBuf};

/// The package of the board.
pub const BOARD: &str = "corehbot-qemu";

/// The print and its machine.
#[derive(clap::Args)]
pub struct Args {
    /// G-code file.
    #[arg(required_unless_present = "serve")]
    file: Option<PathBuf>,
    /// Is a printer at the end of a serial line (a pty), as `corehbot serve` is, until Ctrl-C.
    #[arg(long, conflicts_with = "file")]
    serve: bool,
    /// With --serve: makes a link to the serial port here; without it, the port's own name is printed.
    #[arg(long, value_name = "PATH", requires = "serve")]
    pty: Option<PathBuf>,
    /// Writes every step event as CSV.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
    /// Starts as if homed, with the tool at this place in mm.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true)]
    assume_homed: Option<[Mm; 3]>,
    /// The machine; without it, the CoreH-bot prototype.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    settings: Option<PathBuf>,
}

/// Prints the file and sums up.
pub fn main(args: &Args) -> Result<()> {
    let settings = match &args.settings {
        Some(path) => machine_file::read(path)?.settings,
        None => Settings::prototype(),
    };
    let gcode = args.file.as_deref().map(read_gcode).transpose()?.unwrap_or_default();
    let patience_ms = if args.serve { SCALED_PATIENCE_MS } else { 0 };
    let job = Job { gcode, settings, start: args.assume_homed, mesh: None, patience_ms };
    let image = images::build_image(BOARD)?;
    let outcome = match &args.file {
        Some(_) => job.run(&image, args.trace.as_deref())?,
        None => serve(&job, &image, args)?,
    };
    for line in &outcome.log {
        println!("{line}");
    }
    for warning in &outcome.warnings {
        println!("{}:{}", args.file.as_deref().unwrap_or(Path::new("")).display(), printable::line(warning));
    }
    println!("events       {}", outcome.events);
    println!("motion time  {:.3} s", outcome.ticks as f64 / f64::from(TICKS_PER_SECOND));
    println!("wall time    {:.1} s", outcome.wall.as_secs_f64());
    println!("sha256       {}", outcome.sha256);
    Ok(())
}

/// Lets hosts at a pseudo-terminal talk to the board until a signal comes.
#[cfg(unix)]
fn serve(job: &Job, image: &Path, args: &Args) -> Result<Outcome> {
    let stop = corehbot_host::stop::Stop::at_signals()?;
    let mut port = corehbot_host::serial::Port::open(args.pty.as_deref())?;
    corehbot_host::say::println(format_args!("{}", port.path().display()))?;
    job.talk(image, args.trace.as_deref(), |stream| bridge::talk(stream, &mut port, &stop))
}

/// Reports that it cannot.
#[cfg(not(unix))]
fn serve(_job: &Job, _image: &Path, _args: &Args) -> Result<Outcome> {
    anyhow::bail!("there are no pseudo-terminals here")
}

/// The text of a G-code file; bytes that are not UTF-8 can only stand in comments.
pub fn read_gcode(path: &Path) -> Result<String> {
    input::read(path, Plate::default())
}

/// Three numbers, turned into positions exactly as the simulator does it.
fn parse_place(text: &str) -> Result<[Mm; 3], String> {
    let place: Option<Vec<Mm>> =
        text.split(',').map(|part| part.trim().parse().ok().and_then(Mm::checked_from_num::<f64>)).collect();
    place.and_then(|place| place.try_into().ok()).ok_or_else(|| "expected three numbers: X,Y,Z".to_owned())
}
