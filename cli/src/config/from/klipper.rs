//! A configuration of Klipper, with all files that it includes.

use anyhow::{Context as _, Result, bail};
use corehbot_machine_file::file_kind::with_line_feeds;
use corehbot_machine_file::klipper::{Config, Files, is_pattern, matches};
use std::path::{Path, PathBuf};

/// The first file of a folder.
const FIRST: &str = "printer.cfg";

/// Mistakes that are printed.
const MOST_MISTAKES: usize = 20;

/// The first file of a configuration: the one of that name, or the usual one of a folder.
pub(super) fn first(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(FIRST) } else { path.to_owned() }
}

/// Reads the configuration.
pub(super) fn read(first: &Path) -> Result<Config> {
    let name = first.to_str().with_context(|| format!("{} is no name in UTF-8", first.display()))?;
    Config::read(name, &mut OnDisk).or_else(|mistakes| {
        let mut lines: Vec<_> = mistakes.iter().take(MOST_MISTAKES).map(ToString::to_string).collect();
        lines.extend(mistakes.get(MOST_MISTAKES).map(|_| format!("{} mistakes in all", mistakes.len())));
        bail!("no configuration that Klipper reads\n{}", lines.join("\n"))
    })
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
        std::fs::read_to_string(name).map(with_line_feeds).map_err(|error| error.to_string())
    }
}

/// The files and folders in a folder that a part of a pattern means.
fn inside(folder: &Path, part: &str) -> Vec<PathBuf> {
    let whole = folder.join(part);
    // A way up, or a root, is no name in the folder.
    if whole.exists() || !is_pattern(part) {
        return vec![whole];
    }
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(listed) = std::fs::read_dir(here) else { return Vec::new() };
    let names = listed.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    names.filter(|name| matches(part, name)).map(|name| folder.join(name)).collect()
}
