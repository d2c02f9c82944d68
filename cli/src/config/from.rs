//! `config from`: a configuration of Klipper as a machine file, and a report of what became of every key.

use crate::status::{DONE, FAILED};
use anyhow::{Context as _, Result, bail};
use clap::Args;
use corehbot::connectors::BoardConnectors;
use corehbot_machine_file::klipper::{Config, Files, matches, translate};
use corehbot_report::printable;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The first file of a folder.
const FIRST: &str = "printer.cfg";

/// Mistakes that are printed.
const MOST_MISTAKES: usize = 20;

#[derive(Args)]
pub(crate) struct From {
    /// Klipper's printer.cfg, or the folder with it.
    #[arg(value_name = "printer.cfg")]
    file: PathBuf,
    /// The board; left out, its pins and comments tell it.
    #[arg(long, value_parser = super::board())]
    board: Option<&'static BoardConnectors>,
    /// The file to write, which must not exist; the default is standard output.
    #[arg(short, long, value_name = "M.toml")]
    output: Option<PathBuf>,
}

/// Writes the machine file, and the report to the other one of standard output and standard error.
pub(super) fn from(args: &From) -> Result<u8> {
    let first = if args.file.is_dir() { args.file.join(FIRST) } else { args.file.clone() };
    let name = first.to_str().with_context(|| format!("{} is no name in UTF-8", first.display()))?;
    std::fs::metadata(&first).with_context(|| format!("cannot open {name}"))?;
    let config = match Config::read(name, &mut OnDisk) {
        Ok(config) => config,
        Err(mistakes) => {
            let mut lines: Vec<_> = mistakes.iter().take(MOST_MISTAKES).map(ToString::to_string).collect();
            lines.extend(mistakes.get(MOST_MISTAKES).map(|_| format!("{} mistakes in all", mistakes.len())));
            bail!("no configuration that Klipper reads\n{}", lines.join("\n"));
        }
    };
    let done = translate(&config, args.board).map_err(anyhow::Error::msg)?;
    let written = args.output.as_deref().map_or_else(|| "machine file".to_owned(), |path| path.display().to_string());
    let mut report = done.report.to_string();
    done.problems.iter().for_each(|problem| {
        let _ = writeln!(report, "{written}:{problem}");
    });
    report += match (done.is_whole(), done.machine.is_some()) {
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
            eprint!("{report}");
        }
    }
    Ok(if done.is_whole() { DONE } else { FAILED })
}

/// The files on this computer.
struct OnDisk;

impl Files for OnDisk {
    fn matching(&mut self, from: &str, pattern: &str) -> Vec<String> {
        let mut found = vec![Path::new(from).parent().unwrap_or(Path::new("")).to_owned()];
        for part in Path::new(pattern) {
            let Some(part) = part.to_str() else { return Vec::new() };
            found = found.iter().flat_map(|folder| inside(folder, part)).collect();
        }
        let names = found.iter().filter(|path| path.is_file()).filter_map(|path| path.to_str());
        let mut names: Vec<_> = names.map(str::to_owned).collect();
        names.sort();
        names
    }

    fn read(&mut self, name: &str) -> Result<String, String> {
        std::fs::read_to_string(name).map_err(|error| error.to_string())
    }
}

/// The files and folders in a folder that a part of a pattern means.
fn inside(folder: &Path, part: &str) -> Vec<PathBuf> {
    let whole = folder.join(part);
    // A way up, or a root, is no name in the folder.
    if whole.exists() || !corehbot_machine_file::klipper::is_pattern(part) {
        return vec![whole];
    }
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(listed) = std::fs::read_dir(here) else { return Vec::new() };
    let names = listed.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    names.filter(|name| matches(part, name)).map(|name| folder.join(name)).collect()
}
