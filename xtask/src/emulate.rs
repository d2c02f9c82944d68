//! `cargo xtask emulate` and `equal`: the image that a user flashes, on an emulated processor.
//!
//! The emulated processor is a feature of the emulator's package, so that no other build waits for it; this room asks
//! for it.

use crate::checkout::{self, run};
use crate::compare::check_file;
use crate::images;
use anyhow::Result;
use corehbot_host::accident_args::AccidentArgs;
use corehbot_host::stop::Stop;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The print.
#[derive(clap::Args)]
pub struct Args {
    /// The board.
    board: Board,
    /// G-code file; it has to home, because the image starts without a position. The Nucleo homes no Z.
    #[arg(required_unless_present = "pty")]
    file: Option<PathBuf>,
    /// Is a printer at the end of a serial line until Ctrl-C, and makes a link to it here.
    #[arg(long, value_name = "PATH", conflicts_with = "file")]
    pty: Option<PathBuf>,
    /// The machine, which is put into the Octopus's EEPROM or the Nucleo's image.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    settings: Option<PathBuf>,
    /// Writes the step events as they are on the pins, in real time since reset.
    #[arg(long, value_name = "T.csv")]
    trace: Option<PathBuf>,
    /// Writes the same as VCD.
    #[arg(long, value_name = "V.vcd")]
    vcd: Option<PathBuf>,
    #[command(flatten)]
    plant: PlantArgs,
    /// More options of the emulator, such as `--speed max --fault swap-motors:m1,m8`.
    #[arg(last = true, value_name = "OPTION")]
    more: Vec<String>,
}

/// The machine that the image drives, as `corehbot run` has it.
#[derive(clap::Args, Default)]
struct PlantArgs {
    /// The plant that the motors turn: `belt`; without it, a rigid machine.
    #[arg(long, value_name = "PLANT")]
    plant: Option<String>,
    /// Draws phases and noise.
    #[arg(long, value_name = "N")]
    seed: Option<String>,
    /// Something in the tool's way.
    #[arg(long, value_name = "X,Y,N,MS", allow_hyphen_values = true)]
    hit: Vec<String>,
    #[command(flatten)]
    accidents: AccidentArgs,
}

impl PlantArgs {
    /// The options that were given, for the emulator to check.
    fn given(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let one = [("plant", &self.plant), ("seed", &self.seed)];
        let one = one.into_iter().filter_map(|(option, value)| Some((option, value.as_deref()?)));
        let hits = self.hit.iter().map(|hit| ("hit", hit.as_str()));
        one.chain(hits).chain(self.accidents.given())
    }
}

/// A board that the emulator knows.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum Board {
    /// BTT Octopus V1.0 or V1.1.
    Octopus,
    /// Nucleo-F446RE with a CNC shield v3.
    Nucleo,
}

impl Board {
    /// The package of its image.
    pub const fn package(self) -> &'static str {
        match self {
            Self::Octopus => "corehbot-octopus",
            Self::Nucleo => "corehbot-nucleo",
        }
    }

    /// Its name for the emulator.
    const fn name(self) -> &'static str {
        match self {
            Self::Octopus => "octopus",
            Self::Nucleo => "nucleo",
        }
    }
}

/// The comparison.
#[derive(clap::Args)]
pub struct EqualArgs {
    /// G-code file; it has to home.
    file: PathBuf,
    /// The machine.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    settings: Option<PathBuf>,
}

/// Builds the image and prints a file on it; the emulator compares its steps with the simulator's.
pub fn main(args: &Args) -> Result<()> {
    // The emulator ends in an orderly way, and this program waits for it.
    let _stop = Stop::at_signals()?;
    let options = [("--machine", &args.settings), ("--trace", &args.trace), ("--vcd", &args.vcd), ("--pty", &args.pty)];
    print(args.board, args.file.as_deref(), options, &args.plant, &args.more)
}

/// Prints a file three times: the simulator against QEMU, byte for byte, and against the image.
pub fn equal(args: &EqualArgs) -> Result<()> {
    check_file(&args.file, args.settings.as_deref())?;
    print(Board::Octopus, Some(&args.file), [("--machine", &args.settings)], &PlantArgs::default(), &[])
}

fn print<const N: usize>(
    board: Board,
    file: Option<&Path>,
    options: [(&'static str, &Option<PathBuf>); N],
    plant: &PlantArgs,
    more: &[String],
) -> Result<()> {
    let mut command = cargo(["run"], &["--"]);
    command.current_dir(std::env::current_dir()?).arg(images::build_image(board.package())?).args(file);
    command.args(["--board", board.name()]);
    for (option, path) in options {
        if let Some(path) = path {
            command.arg(option).arg(path);
        }
    }
    for (option, value) in plant.given() {
        command.arg(format!("--{option}={value}"));
    }
    command.args(more);
    run(command)
}

/// What every build of the emulator is told. `--ignore-rust-version` is for the crate rigless, which declares a newer
/// compiler than it needs.
pub const WITH_PROCESSOR: [&str; 2] = ["--features=corehbot-emulator/processor", "--ignore-rust-version"];

/// Cargo for the emulator's package.
pub fn cargo<const N: usize>(task: [&str; N], options: &[&str]) -> Command {
    let mut command = checkout::cargo(task);
    command.arg("--package=corehbot-emulator").args(WITH_PROCESSOR).args(options);
    command
}
