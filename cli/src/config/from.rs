//! `config from`: the configuration of another firmware as a machine file, and a report of what became of every part.

#[cfg(unix)]
mod ask;
mod klipper;

use anyhow::{Context as _, Result, ensure};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use corehbot::connectors::BoardConnectors;
use corehbot_host::status::{DONE, FAILED};
use corehbot_machine_file::file_kind::{FileKind, START, Wanted, WrongFile, text_of};
use corehbot_machine_file::marlin::{self, Given, Kinematics};
use corehbot_machine_file::printable;
use corehbot_machine_file::{Translation, configuration_h, klipper as of_klipper, reprap};
use std::fmt::Write as _;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(crate) struct From {
    /// Klipper's printer.cfg, or the folder with it; the answer of a Marlin printer to M503; Marlin's Configuration.h,
    /// with Configuration_adv.h beside it; or RepRapFirmware's config.g.
    #[cfg_attr(unix, arg(value_name = "FILE", required_unless_present = "serial"))]
    #[cfg_attr(not(unix), arg(value_name = "FILE", required = true))]
    file: Option<PathBuf>,
    #[cfg(unix)]
    #[command(flatten)]
    printer: ask::Printer,
    /// The board that the machine gets; left out, the pins and comments of printer.cfg tell it.
    #[arg(long, value_parser = super::board())]
    board: Option<&'static BoardConnectors>,
    /// How the motors of a Marlin printer move it, which most of them do not say.
    #[arg(long, value_parser = kinematics())]
    kinematics: Option<&'static Kinematics>,
    /// The file to write, which must not exist; the default is standard output.
    #[arg(short, long, value_name = "M.toml")]
    output: Option<PathBuf>,
}

/// Kinematics by their names.
fn kinematics() -> impl TypedValueParser<Value = &'static Kinematics> {
    let names = PossibleValuesParser::new(Kinematics::ALL.iter().map(|known| known.name));
    names.try_map(|name| Kinematics::called(&name).ok_or("there are no such kinematics"))
}

/// Writes the machine file, and the report to the other one of standard output and standard error.
pub(super) fn from(args: &From) -> Result<u8> {
    if let Some(path) = &args.output {
        // Before a printer is asked for many seconds.
        ensure!(path.symlink_metadata().is_err(), "cannot create {}: it is there already", path.display());
    }
    let done = translated(args)?;
    let written = args.output.as_deref().map_or_else(|| "machine file".to_owned(), |path| path.display().to_string());
    let mut report = done.report.to_string();
    done.problems.iter().for_each(|problem| {
        let _ = writeln!(report, "{written}:{problem}");
    });
    let is_open = !done.report.open.is_empty();
    report += match (done.is_whole(), done.machine.is_some()) {
        (true, _) if is_open => {
            "the machine file is a machine: fill it in, and check approximated keys before it moves\n"
        }
        (true, _) => "the machine file is a machine: measure and check approximated keys before it moves\n",
        (false, true) => "the machine file is a machine, apart from the keys that are to decide\n",
        (false, false) => "the machine file is no machine yet: decide, then run `corehbot config check`\n",
    };
    let report = printable::lines(&report);
    match &args.output {
        Some(path) => {
            super::create(path, &done.text)?;
            super::say(&report)?;
        }
        None => {
            super::say(&done.text)?;
            let _ = std::io::Write::write_all(&mut std::io::stderr().lock(), report.as_bytes());
        }
    }
    Ok(if done.is_whole() { DONE } else { FAILED })
}

/// The translation of whatever it is.
fn translated(args: &From) -> Result<Translation> {
    let given = Given { board: args.board, kinematics: args.kinematics };
    #[cfg(unix)]
    if let Some(port) = args.printer.port() {
        return Ok(marlin::translate(&port.display().to_string(), &args.printer.ask(port)?, given));
    }
    let file = args.file.as_deref().context("say a file")?;
    let first = klipper::first(file);
    let name = first.display().to_string();
    let (kind, text) = told(&first)?;
    Wanted::Configuration.check(kind).with_context(|| name.clone())?;
    match kind {
        FileKind::ConfigG => return Ok(reprap::translate(&name, &text, given)),
        FileKind::ConfigurationH => {
            let others = sources_beside(&first)?;
            let mut files = vec![(name.as_str(), text.as_str())];
            files.extend(others.iter().map(|(name, text)| (name.as_str(), text.as_str())));
            return Ok(configuration_h::translate(&files, given));
        }
        FileKind::Settings | FileKind::SettingCommands => return Ok(marlin::translate(&name, &text, given)),
        _ => {}
    }
    ensure!(
        args.kinematics.is_none(),
        "--kinematics is for printers with Marlin or RepRapFirmware: {name} says its own kinematics"
    );
    if kind == FileKind::Empty {
        return Err(WrongFile { kind, wanted: Wanted::Configuration }).context(name);
    }
    let config = klipper::read(&first)?;
    if kind == FileKind::Text && !config.has_printer() {
        return Err(WrongFile { kind, wanted: Wanted::Configuration }).context(name);
    }
    of_klipper::translate(&config, args.board).map_err(|error| anyhow::anyhow!("{name}: {error}"))
}

/// What a file is, and the begin of its text: all that a report or a source of settings has.
fn told(path: &Path) -> Result<(FileKind, String)> {
    let cannot = || format!("cannot open {}", path.display());
    let file = File::open(path).with_context(cannot)?;
    let (length, mut start) = (file.metadata().with_context(cannot)?.len(), Vec::new());
    file.take(START as u64).read_to_end(&mut start).with_context(cannot)?;
    Ok((FileKind::of(&start, length), text_of(&start)))
}

/// Marlin's sources of settings.
const SOURCES: [&str; 2] = ["Configuration.h", "Configuration_adv.h"];

/// The other one of Marlin's two sources, if it lies beside the first.
fn sources_beside(path: &Path) -> Result<Vec<(String, String)>> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let mut found = Vec::new();
    for other in SOURCES.into_iter().filter(|other| SOURCES.contains(&name) && *other != name) {
        let other = path.with_file_name(other);
        if other.is_file() {
            found.push((other.display().to_string(), told(&other)?.1));
        }
    }
    Ok(found)
}
