//! Command line: the arguments of `corehbot`, and its exit status.
//!
//! 0: the print was done and its steps are sound. 1: it was not, or nothing was printed. 2: nothing was begun, because
//! the command line, a file or the settings are wrong. 130: Ctrl-C (128 and the number of the signal).

#[cfg(unix)]
use crate::bringup::{self, Bringup};
use crate::config::{self, Config};
use crate::examples::EXAMPLES;
use crate::image::{self, Image};
use crate::resonance::{self, Resonance};
use crate::run::{self, Run};
#[cfg(unix)]
use crate::serve::{self, Serve};
use crate::twin::{self, Twin};
use clap::error::ErrorKind;
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use corehbot_host::examples::with_examples;
use corehbot_host::say::note;
use corehbot_host::status::{UNUSABLE, end};
use corehbot_machine_file::file_kind::{FileKind, START};
use corehbot_machine_file::printable;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::process::ExitCode;

/// The name of this program in messages.
const PROGRAM: &str = "corehbot";

/// The CoreH-bot firmware on this computer: prints G-code on a simulated machine.
#[derive(Parser)]
#[command(name = "corehbot", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Prints a G-code file and checks every step.
    Run(Run),
    /// Runs the firmware on a pseudo-terminal, for hosts and terminal programs.
    #[cfg(unix)]
    Serve(Serve),
    /// Leads from a flashed board to a first print, step by step, and writes a report to keep.
    #[cfg(unix)]
    Bringup(Bringup),
    /// Writes a firmware image for a board, with the machine of a file in it. Needs no compiler.
    Image(Image),
    /// Writes, checks and describes machine files, sends them to boards and reads them back.
    #[command(subcommand)]
    Config(Config),
    /// Computes how the belt follows commanded steps: stiffness, modes, slips.
    #[command(subcommand)]
    Twin(Twin),
    /// Analyses recordings of an accelerometer on the tool: modes, shapers, belts, quiet speeds.
    ///
    /// Parts are of 1: part of a mode in the slow motion (negative against the command), remaining_vibration,
    /// most_ringing, uncertainty. damping_ratio is of critical damping. A net rounding is positive where the tool stays
    /// inside a corner. A comparison of belts is A against B: positive where A is higher, stiffer or louder.
    Resonance(Resonance),
}

/// The command line, with examples in the help of each command.
#[must_use]
pub fn command() -> clap::Command {
    with_examples(Cli::command(), &EXAMPLES, "")
}

/// Runs the command that the process was called with.
#[must_use]
pub fn main() -> ExitCode {
    let called = match command().try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(called) => called,
        Err(error) => {
            if error.kind() == ErrorKind::InvalidSubcommand
                && let Some(way) = std::env::args_os().nth(1).and_then(|file| way_of(Path::new(&file)))
            {
                note(format_args!("corehbot: {}", printable::line(&way)));
                return ExitCode::from(UNUSABLE);
            }
            error.exit()
        }
    };
    match called.command {
        Command::Run(args) => end(PROGRAM, run::Prepared::new(&args), |prepared| prepared.run(&args)),
        #[cfg(unix)]
        Command::Serve(args) => end(PROGRAM, serve::Prepared::new(&args), |prepared| prepared.run(&args)),
        #[cfg(unix)]
        Command::Bringup(args) => end(PROGRAM, bringup::Prepared::new(&args), |prepared| prepared.run(&args)),
        Command::Image(args) => end(PROGRAM, image::Prepared::new(&args), |prepared| prepared.write(&args)),
        Command::Config(config) => end(PROGRAM, config::run(&config), Ok),
        Command::Resonance(args) => end(PROGRAM, resonance::Prepared::new(&args), |prepared| prepared.run(&args)),
        Command::Twin(question) => end(PROGRAM, Ok(question), |question| twin::run(&question)),
    }
}

/// What to do with a file that stands in place of a command.
fn way_of(path: &Path) -> Option<String> {
    let mut start = Vec::new();
    let (kind, file) = if path.is_dir() {
        (FileKind::Folder, path)
    } else {
        let file = File::open(path).ok()?;
        let length = file.metadata().ok()?.len();
        file.take(START as u64).read_to_end(&mut start).ok()?;
        (FileKind::of(&start, length), path)
    };
    let file = file.display().to_string();
    Some(format!("{file} is {}: {}", kind.name(), kind.way().replace("FILE", &file).replace("FOLDER", &file)))
}
