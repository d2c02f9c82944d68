//! `corehbot-manual FOLDER` writes manual pages of the command, and what shells complete: both from its command line.
//!
//! `cargo xtask dist` runs it. It is a program of its own, so that `cargo xtask` does not build the command.
#![forbid(unsafe_code)]

use anyhow::{Context as _, Result};
use clap::Command;
use clap_complete::{Shell, generate};
use clap_mangen::Man;
use corehbot_cli::cli;
use std::fs;
use std::path::PathBuf;

/// Shells, and the name of the file that each of them looks for.
const SHELLS: [(Shell, &str); 4] = [
    (Shell::Bash, "corehbot.bash"),
    (Shell::Zsh, "_corehbot"),
    (Shell::Fish, "corehbot.fish"),
    (Shell::PowerShell, "corehbot.ps1"),
];

/// A file, and its path in the folder, with slashes.
struct File {
    path: String,
    bytes: Vec<u8>,
}

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).context("give a folder")?);
    for File { path, bytes } in files()? {
        let path = folder.join(path);
        let cannot = || format!("cannot write {}", path.display());
        fs::create_dir_all(path.parent().unwrap_or(&folder)).with_context(cannot)?;
        fs::write(&path, bytes).with_context(cannot)?;
    }
    Ok(())
}

/// `man/*.1` and `completions/*`.
fn files() -> Result<Vec<File>> {
    let mut command = cli::command();
    let mut files = Vec::new();
    for (shell, name) in SHELLS {
        let mut bytes = Vec::new();
        generate(shell, &mut command, "corehbot", &mut bytes);
        files.push(File { path: format!("completions/{name}"), bytes });
    }
    command.build();
    pages(&command, "corehbot", &mut files)?;
    Ok(files)
}

/// The pages of a command and of those within it.
fn pages(command: &Command, name: &str, files: &mut Vec<File>) -> Result<()> {
    let mut bytes = Vec::new();
    // The same bytes from the same commit: a page has no date.
    Man::new(command.clone()).title(name).date("").render(&mut bytes)?;
    files.push(File { path: format!("man/{name}.1"), bytes });
    let within = command.get_subcommands().filter(|within| within.get_name() != "help");
    within
        .map(|within| (within, format!("{name}-{}", within.get_name())))
        .try_for_each(|(within, name)| pages(within, &name, files))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_with_its_examples_and_every_shell_completes() {
        let files = files().unwrap();
        let text = |path: &str| {
            let file = files.iter().find(|file| file.path == path).unwrap_or_else(|| panic!("no {path}"));
            String::from_utf8(file.bytes.clone()).unwrap()
        };
        let run = text("man/corehbot-run.1");
        assert!(
            run.starts_with(".ie") && run.contains(".TH corehbot-run 1") && run.contains("corehbot run print.gcode"),
            "{run}"
        );
        assert!(text("man/corehbot-twin-run.1").contains("routing") && text("man/corehbot.1").contains("bringup"));
        for (_, name) in SHELLS {
            let text = text(&format!("completions/{name}"));
            assert!(text.contains("bringup") && text.contains("assume-homed"), "{name}");
            // PowerShell is told of no values.
            assert!(text.contains("stuck-on") || name.ends_with(".ps1"), "{name} completes no accidents");
        }
        assert!(files.len() > 28);
    }
}
