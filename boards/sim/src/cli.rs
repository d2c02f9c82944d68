//! Command line: what `corehbot` understands, and with which status it ends.
//!
//! 0: the print was done and its steps are sound. 1: it was not, or nothing was printed. 2: nothing was begun, because
//! the command line, a file or the settings are wrong. 130: Ctrl-C (128 and the number of the signal).

use crate::config::{self, Config};
use crate::eeprom::Eeprom;
use crate::image::{self, Image};
use crate::machine_file::{self, Machine};
use crate::printable;
use crate::run::{self, Run};
#[cfg(unix)]
use crate::serve::{self, Serve};
use crate::twin::{self, Twin};
use anyhow::Result;
use clap::{Args, Parser, Subcommand};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// All went well.
pub(crate) const DONE: u8 = 0;

/// The print failed, or a file is no machine.
pub(crate) const FAILED: u8 = 1;

/// Nothing was begun; clap ends with the same status.
const UNUSABLE: u8 = 2;

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
    /// Is a printer at the end of a serial line (a pty), for hosts and terminal programs.
    #[cfg(unix)]
    Serve(Serve),
    /// Makes an image for a board, with the machine of a file in it. Takes no compiler.
    Image(Image),
    /// Begins, checks and describes machine files, sends them to boards and gets them back.
    #[command(subcommand)]
    Config(Config),
    /// What the belt makes of commanded steps: stiffness, modes, slips.
    #[command(subcommand)]
    Twin(Twin),
}

/// Runs the command that the process was called with.
#[must_use]
pub fn main() -> ExitCode {
    match Cli::parse().command {
        Command::Run(args) => end(run::Prepared::new(&args), |prepared| prepared.run(&args)),
        #[cfg(unix)]
        Command::Serve(args) => end(serve::Prepared::new(&args), |prepared| prepared.run(&args)),
        Command::Image(args) => end(image::Prepared::new(&args), |prepared| prepared.write(&args)),
        Command::Config(config) => end(config::run(&config), Ok),
        Command::Twin(question) => end(Ok(question), |question| twin::run(&question)),
    }
}

/// Does what was prepared, and says how it ended.
fn end<T>(prepared: Result<T>, run: impl FnOnce(T) -> Result<u8>) -> ExitCode {
    match prepared.map(run) {
        Ok(Ok(status)) => ExitCode::from(status),
        Ok(Err(error)) => complain(&error, FAILED),
        Err(error) => complain(&error, UNUSABLE),
    }
}

fn complain(error: &anyhow::Error, status: u8) -> ExitCode {
    eprintln!("corehbot: {}", printable::lines(&format!("{error:#}")));
    ExitCode::from(status)
}

/// The printer that commands have in common.
#[derive(Clone, Args)]
pub(crate) struct Printer {
    /// The machine; without it, the CoreH-bot prototype.
    #[arg(long, value_name = "M.toml")]
    settings: Option<PathBuf>,
    /// Keeps settings (M500) in this 4 KiB image of an EEPROM, which is created if it does not exist.
    #[arg(long, value_name = "E.bin")]
    storage: Option<PathBuf>,
    /// Starts as if homed, with the tool at this place in mm.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true)]
    pub assume_homed: Option<[Mm; 3]>,
}

impl Printer {
    /// One that keeps nothing.
    pub(crate) const fn new(settings: Option<PathBuf>, assume_homed: Option<[Mm; 3]>) -> Self {
        Self { settings, storage: None, assume_homed }
    }

    /// The machine.
    pub(crate) fn machine(&self) -> Result<Machine> {
        read_machine(self.settings.as_deref())
    }

    /// The files that it is made of.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.settings, &self.storage].into_iter().flatten().map(PathBuf::as_path)
    }

    /// What keeps its settings.
    pub(crate) fn eeprom(&self) -> Result<Option<Eeprom>> {
        self.storage.as_deref().map(Eeprom::open).transpose()
    }
}

/// Three numbers that a machine of any size might hold; whether this one does is the firmware's to say.
pub(crate) fn parse_place(text: &str) -> Result<[Mm; 3], String> {
    let mut numbers = text.split(',').map(|part| match part.trim().parse::<f64>() {
        Ok(v) if v.abs() <= 5000.0 => Ok(Mm::from_num(v)),
        _ => Err(format!("`{part}` is no position in mm")),
    });
    let mut next = || numbers.next().unwrap_or_else(|| Err("three numbers are wanted: X,Y,Z".to_owned()));
    let place = [next()?, next()?, next()?];
    if numbers.next().is_some() { Err("three numbers are wanted: X,Y,Z".to_owned()) } else { Ok(place) }
}

fn read_machine(path: Option<&Path>) -> Result<Machine> {
    let Some(path) = path else {
        return Ok(Machine {
            name: Some("CoreH-bot prototype".to_owned()),
            board: None,
            settings: Settings::prototype(),
        });
    };
    machine_file::read(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_three_numbers() {
        assert_eq!(parse_place("1,-2.5, 0").unwrap(), [1.0, -2.5, 0.0].map(Mm::from_num));
        for bad in ["", "1,2", "1,2,3,4", "1,2,z", "1,2,nan", "1,2,1e9"] {
            assert!(parse_place(bad).is_err(), "{bad}");
        }
    }
}
