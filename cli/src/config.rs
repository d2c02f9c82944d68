//! `corehbot config`: machine files are begun, checked, described, and sent to boards.

#[cfg(unix)]
mod exchange;
mod from;

#[cfg(unix)]
pub(crate) use exchange::machine_said;

use anyhow::{Context as _, Result};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use corehbot::connectors::BoardConnectors;
use corehbot_boards as boards;
use corehbot_host::status::{DONE, FAILED};
use corehbot_machine_file::printable;
use corehbot_machine_file::template::{self, Kind};
use corehbot_machine_file::{self as machine_file, problems, schema};
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Begins, checks and describes machine files.
#[derive(Subcommand)]
pub(crate) enum Config {
    /// Writes the JSON Schema of machine files, for editors.
    Schema,
    /// Writes a machine file with every key and its meaning.
    New(New),
    /// Writes a machine file from Klipper's printer.cfg or from a printer with Marlin, and reports what became of it.
    From(from::From),
    /// Reports errors and doubtful values in a machine file; the exit status is 1 if there are errors.
    Check(Check),
    /// Sends a machine to a board, which checks it and stores it.
    #[cfg(unix)]
    Send(exchange::Send),
    /// Writes a board's machine, with all changes by commands, as a machine file.
    #[cfg(unix)]
    Get(exchange::Get),
}

#[derive(Args)]
pub(crate) struct New {
    /// The board that the machine is plugged into.
    #[arg(long, value_parser = board())]
    board: &'static BoardConnectors,
    /// How its motors move it.
    #[arg(long, value_parser = kinds())]
    kinematics: Kind,
    /// A hotend and a bed are fitted, on the board's usual outputs and sensors.
    #[arg(long)]
    heaters: bool,
    /// The file to write, which must not exist; the default is standard output.
    #[arg(short, long, value_name = "M.toml")]
    output: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct Check {
    /// The machine file.
    #[arg(value_name = "M.toml")]
    file: PathBuf,
}

/// Boards by their keys.
fn board() -> impl TypedValueParser<Value = &'static BoardConnectors> {
    let keys = PossibleValuesParser::new(boards::all().map(|board| board.key));
    keys.try_map(|key| boards::called(&key).ok_or("there is no such board"))
}

/// Kinds of machines by their names.
fn kinds() -> impl TypedValueParser<Value = Kind> {
    let names = PossibleValuesParser::new(Kind::ALL.map(Kind::name));
    names.try_map(|name| Kind::ALL.into_iter().find(|kind| kind.name() == name).ok_or("there is no such kind"))
}

/// Does it, and says the exit status.
///
/// # Errors
/// A file that cannot be read or written.
pub(crate) fn run(config: &Config) -> Result<u8> {
    match config {
        Config::Schema => say(&format!("{}\n", serde_json::to_string_pretty(&schema())?)),
        Config::New(new) => write_new(new),
        Config::From(args) => from::from(args),
        Config::Check(check) => report(&check.file),
        #[cfg(unix)]
        Config::Send(args) => exchange::send(args),
        #[cfg(unix)]
        Config::Get(args) => exchange::get(args),
    }
}

fn say(text: &str) -> Result<u8> {
    std::io::stdout().lock().write_all(text.as_bytes()).context("cannot write to standard output")?;
    Ok(DONE)
}

fn write_new(new: &New) -> Result<u8> {
    let text = template::file(new.kinematics, new.board, new.heaters)?;
    match &new.output {
        Some(path) => create(path, &text),
        None => say(&text),
    }
}

/// Writes a file that must not exist.
fn create(path: &Path, text: &str) -> Result<u8> {
    let cannot = || format!("cannot create {}", path.display());
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).with_context(cannot)?;
    file.write_all(text.as_bytes()).with_context(cannot)?;
    Ok(DONE)
}

fn report(path: &Path) -> Result<u8> {
    let text = machine_file::read_text(path)?;
    let (machine, found) = problems(&text);
    let file = path.display();
    let mut lines: String = found.iter().map(|problem| format!("{file}:{problem}\n")).collect();
    let errors = found.iter().filter(|problem| problem.is_error).count();
    let counts = format!("{}, {}", count(errors, "error"), count(found.len() - errors, "warning"));
    lines += &match &machine {
        Some(machine) => {
            let motors = count(machine.settings.mechanism.fitted().0.count_ones() as usize, "motor");
            let board = machine.board.map_or("any board", |board| board.name);
            format!("{file}: a machine of {motors} for {board}; {counts}\n")
        }
        None => format!("{file}: no machine; {counts}\n"),
    };
    say(&printable::lines(&lines))?;
    Ok(if machine.is_some() && errors == 0 { DONE } else { FAILED })
}

/// A number of things.
fn count(number: usize, thing: &str) -> String {
    match number {
        0 => format!("no {thing}s"),
        1 => format!("1 {thing}"),
        _ => format!("{number} {thing}s"),
    }
}
