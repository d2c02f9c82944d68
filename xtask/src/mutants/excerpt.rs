//! An excerpt of the core: a room, the rooms that it uses, and nothing else.
//!
//! The core is rebuilt for each mutant, and most of that time went into rooms that cannot notice it. A room uses only
//! rooms of the lines above its own (CONTRIBUTING.md, *The layer rule*). So a fault in a driver can be tested without
//! the machine and the heaters.

use crate::checkout::root;
use anyhow::{Context as _, Result};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Lines of the manifest about crates besides the core. Controllers heat the rig, which uses all of the core.
const OTHER_CRATES: [&str; 4] = ["members", "exclude", "default-members", "corehbot-rig."];

/// Writes the excerpt to a folder. From the core it takes the room, and the rooms that it and these tests use. It takes
/// all tests, but the others cannot be built.
pub fn write(folder: &Path, room: &str, tests: &[&str]) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    let rooms = rooms(room, tests)?;
    for path in rooms.iter().flat_map(|room| sources("src", room)) {
        copy(&path, folder)?;
    }
    // The manifest names the benches.
    ["tests", "benches", "Cargo.lock"].map(Path::new).into_iter().try_for_each(|path| copy(path, folder))?;
    let is_kept = |line: &str| match line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(';')) {
        Some(room) => rooms.contains(room),
        None => true,
    };
    copy_lines("src/lib.rs", folder, is_kept)?;
    copy_lines("Cargo.toml", folder, |line| !OTHER_CRATES.iter().any(|begin| line.starts_with(begin)))
}

/// A room, and the rooms that it and tests use.
fn rooms(room: &str, tests: &[&str]) -> Result<BTreeSet<String>> {
    let mut rooms = BTreeSet::from([room.to_owned()]);
    let mut left: Vec<_> = tests.iter().flat_map(|test| sources("tests", test)).chain(sources("src", room)).collect();
    while let Some(path) = left.pop() {
        for file in files(&path)?.iter().filter(|file| file.extension().is_some_and(|end| end == "rs")) {
            let text = read(file)?;
            for line in text.lines().map(str::trim) {
                if line == "mod support;" {
                    left.extend(sources("tests", "support"));
                }
                // A file of another test.
                let path = line.strip_prefix("#[path = \"").and_then(|rest| rest.strip_suffix("\"]"));
                left.extend(path.map(|path| file.with_file_name(path)).filter(|path| root().join(path).exists()));
            }
            // Within the core, and from its tests.
            for used in ["crate::", "corehbot::"].into_iter().flat_map(|root| names(&text, root)) {
                let paths = sources("src", &used);
                if !paths.is_empty() && rooms.insert(used) {
                    left.extend(paths);
                }
            }
        }
    }
    Ok(rooms)
}

/// Names behind `root` in a text. Comments do not count: they may point to rooms that are not used.
fn names(text: &str, root: &str) -> BTreeSet<String> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let behind = code.flat_map(|line| line.split(root).skip(1));
    let name = |rest: &str| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    behind.map(name).filter(|name| !name.is_empty()).collect()
}

/// A room or a test is a folder, a file, or both.
fn sources(place: &str, name: &str) -> Vec<PathBuf> {
    let folder = Path::new(place).join(name);
    [folder.with_extension("rs"), folder].into_iter().filter(|path| root().join(path).exists()).collect()
}

/// The files of a folder of the core and of the folders in it, or the file itself.
fn files(path: &Path) -> Result<Vec<PathBuf>> {
    let place = root().join(path);
    if place.is_file() {
        return Ok(vec![path.to_owned()]);
    }
    let mut found = Vec::new();
    for entry in fs::read_dir(&place).with_context(|| format!("cannot list {}", place.display()))? {
        found.extend(files(&path.join(entry?.file_name()))?);
    }
    Ok(found)
}

fn read(path: &Path) -> Result<String> {
    fs::read_to_string(root().join(path)).with_context(|| format!("cannot read {}", path.display()))
}

/// Copies a file or a folder.
fn copy(path: &Path, folder: &Path) -> Result<()> {
    files(path)?.iter().try_for_each(|file| write_file(&folder.join(file), &fs::read(root().join(file))?))
}

/// Copies some lines of a file.
fn copy_lines(path: &str, folder: &Path, is_kept: impl Fn(&str) -> bool) -> Result<()> {
    let text = read(Path::new(path))?;
    let kept: Vec<_> = text.lines().filter(|line| is_kept(line)).collect();
    write_file(&folder.join(path), kept.join("\n").as_bytes())
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(path, bytes))
        .with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_excerpt_has_a_room_and_what_it_uses() {
        let rooms = rooms("driver", &[]).unwrap();
        assert!(["driver", "settings", "kinematics", "units", "port"].iter().all(|room| rooms.contains(*room)));
        assert!(["machine", "thermal", "motion", "gcode"].iter().all(|room| !rooms.contains(*room)), "{rooms:?}");
    }

    #[test]
    fn an_excerpt_has_what_tests_use_in_files_that_they_share() {
        let rooms = |test| super::rooms("settings", &[test]).unwrap();
        assert!(rooms("mechanisms").contains("motion") && !rooms("setting_ranges").contains("motion"));
        assert!(rooms("line_noise").contains("thermal"));
    }

    #[test]
    fn a_room_is_a_file_or_a_folder_or_both() {
        assert_eq!(sources("src", "checksum"), [Path::new("src/checksum.rs")]);
        assert_eq!(sources("src", "driver"), [Path::new("src/driver")]);
        assert_eq!(sources("src", "fault"), ["src/fault.rs", "src/fault"].map(Path::new));
    }

    #[test]
    fn a_room_in_a_comment_is_not_used() {
        let text = "/// [crate::machine]\nuse crate::units::Mm;\nlet x = (crate::text::f(), crate::port::g());\n";
        assert_eq!(names(text, "crate::").into_iter().collect::<Vec<_>>(), ["port", "text", "units"]);
    }
}
