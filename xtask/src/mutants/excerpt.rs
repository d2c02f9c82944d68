//! An excerpt of the core: a room, the rooms that it uses, and nothing else.
//!
//! The core is rebuilt for each mutant, and most of that time went into rooms that cannot notice it. A room uses only
//! rooms of the lines above its own (CONTRIBUTING.md, *The layer rule*). So a fault in a driver can be tested without
//! the machine and the heaters. The tests are one program, of which the excerpt has the modules that it needs.

use crate::checkout::root;
use anyhow::{Context as _, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Lines of the manifest about crates besides the core. Controllers heat the rig, which uses all of the core.
const OTHER_CRATES: [&str; 4] = ["members", "exclude", "default-members", "corehbot-rig."];

/// The program of the core's tests, as the manifest names it, and the file with its modules.
const PROGRAM: (&str, &str) = ("core_tests", "tests/main.rs");

/// Folders and files that each excerpt has. The manifest names the benches, and the crate's documentation the example.
const WHOLE: [&str; 5] = ["tests", "proptest-regressions", "benches", "examples/embed.rs", "Cargo.lock"];

/// The programs that have these tests. Each but one of the tests is a module of the same program.
pub fn programs<'t>(tests: &[&'t str]) -> BTreeSet<&'t str> {
    tests.iter().map(|test| if is_program(test) { test } else { PROGRAM.0 }).collect()
}

/// Whether a test is a program of its own.
fn is_program(test: &str) -> bool {
    root().join("tests").join(test).join("main.rs").exists()
}

/// Writes the excerpt to a folder. From the core it takes the room, and the rooms that it and these tests use. It takes
/// all files of tests, but only the modules that these tests use are named.
pub fn write(folder: &Path, room: &str, tests: &[&str]) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    let Parts { rooms, modules } = Parts::of(room, tests)?;
    for path in rooms.iter().flat_map(|room| sources("src", room)) {
        copy(&path, folder)?;
    }
    WHOLE.map(Path::new).into_iter().try_for_each(|path| copy(path, folder))?;
    write_some("src/lib.rs", folder, |text| some_modules(text, &rooms))?;
    write_some(PROGRAM.1, folder, |text| some_modules(text, &modules))?;
    let is_kept = |line: &&str| !OTHER_CRATES.iter().any(|begin| line.starts_with(begin));
    write_some("Cargo.toml", folder, |text| text.lines().filter(is_kept).collect::<Vec<_>>().join("\n"))
}

/// What an excerpt consists of.
struct Parts {
    /// Rooms of the core.
    rooms: BTreeSet<String>,
    /// Modules of the program of tests.
    modules: BTreeSet<String>,
}

impl Parts {
    /// A room, tests, and all that they use.
    fn of(room: &str, tests: &[&str]) -> Result<Self> {
        let all = modules_of(&read(Path::new(PROGRAM.1))?);
        let (own, modules): (Vec<&str>, Vec<&str>) = tests.iter().partition(|test| is_program(test));
        let mut parts = Self { rooms: BTreeSet::new(), modules: BTreeSet::new() };
        let mut left = parts.take_room(room);
        left.extend(modules.iter().flat_map(|name| parts.take_module(name, &all)));
        left.extend(own.iter().flat_map(|test| sources("tests", test)));
        while let Some(path) = left.pop() {
            for file in files(&path)?.iter().filter(|file| file.extension().is_some_and(|end| end == "rs")) {
                let text = read(file)?;
                left.extend(names(&text, "corehbot::").iter().flat_map(|name| parts.take_room(name)));
                left.extend(names(&text, "crate::").iter().flat_map(|name| match file.strip_prefix("tests") {
                    Err(_) => parts.take_room(name),
                    Ok(test) if own.iter().any(|own| test.starts_with(own)) => Vec::new(),
                    Ok(_) => parts.take_module(name, &all),
                }));
                // A file of the core in a test is a part of its room.
                let elsewhere = text.lines().filter_map(path_of).map(|path| plain(&file.with_file_name(path)));
                left.extend(
                    elsewhere.flat_map(|path| room_of(&path).map_or(vec![path], |room| parts.take_room(&room))),
                );
            }
        }
        Ok(parts)
    }

    /// Takes a room of the core, and returns its sources if it is new.
    fn take_room(&mut self, name: &str) -> Vec<PathBuf> {
        let paths = sources("src", name);
        if !paths.is_empty() && self.rooms.insert(name.to_owned()) { paths } else { Vec::new() }
    }

    /// Takes one of all modules, and returns its sources if it is new.
    fn take_module(&mut self, name: &str, all: &BTreeMap<String, Vec<PathBuf>>) -> Vec<PathBuf> {
        all.get(name).filter(|_| self.modules.insert(name.to_owned())).cloned().unwrap_or_default()
    }
}

/// The modules that the program of tests names, and their sources.
fn modules_of(text: &str) -> BTreeMap<String, Vec<PathBuf>> {
    let mut before = "";
    let mut modules = BTreeMap::new();
    for line in text.lines() {
        if let Some(name) = module(line) {
            let elsewhere = path_of(before).map(|path| vec![Path::new(PROGRAM.1).with_file_name(path)]);
            modules.insert(name.to_owned(), elsewhere.unwrap_or_else(|| sources("tests", name)));
        }
        before = line;
    }
    modules
}

/// The module that a line names.
fn module(line: &str) -> Option<&str> {
    line.strip_prefix("pub ").unwrap_or(line).strip_prefix("mod ")?.strip_suffix(';')
}

/// The file that a line gives for the module of the next one.
fn path_of(line: &str) -> Option<&str> {
    line.trim().strip_prefix("#[path = \"")?.strip_suffix("\"]")
}

/// The room that has this file of the core.
fn room_of(path: &Path) -> Option<String> {
    let name = path.strip_prefix("src").ok()?.iter().next()?;
    Some(Path::new(name).file_stem()?.to_string_lossy().into_owned())
}

/// The path without steps back.
fn plain(path: &Path) -> PathBuf {
    path.iter().fold(PathBuf::new(), |mut plain, part| {
        if part == ".." {
            _ = plain.pop()
        } else {
            plain.push(part)
        }
        plain
    })
}

/// The text without the other modules, and without the files of those.
fn some_modules(text: &str, wanted: &BTreeSet<String>) -> String {
    let lines: Vec<_> = text.lines().collect();
    let is_kept = |line: &str| module(line).is_none_or(|name| wanted.contains(name));
    let next = lines.iter().skip(1).copied().chain([""]);
    let pairs =
        lines.iter().zip(next).filter(|(line, next)| is_kept(if path_of(line).is_some() { next } else { line }));
    pairs.map(|(line, _)| *line).collect::<Vec<_>>().join("\n")
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

/// Writes a part of a file.
fn write_some(path: &str, folder: &Path, part: impl Fn(&str) -> String) -> Result<()> {
    write_file(&folder.join(path), part(&read(Path::new(path))?).as_bytes())
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
        let rooms = Parts::of("driver", &[]).unwrap().rooms;
        assert!(["driver", "settings", "kinematics", "units", "port"].iter().all(|room| rooms.contains(*room)));
        assert!(["machine", "thermal", "motion", "gcode"].iter().all(|room| !rooms.contains(*room)), "{rooms:?}");
    }

    #[test]
    fn an_excerpt_has_what_tests_use_in_files_that_they_share() {
        let parts = |test| Parts::of("settings", &[test]).unwrap();
        assert!(parts("mechanisms").rooms.contains("motion") && !parts("setting_ranges").rooms.contains("motion"));
        assert!(parts("line_noise").rooms.contains("thermal"));
        let modules = parts("golden_steps").modules;
        assert_eq!(modules.iter().collect::<Vec<_>>(), ["clock", "dice", "golden_steps", "line"]);
    }

    #[test]
    fn an_excerpt_has_the_files_that_its_crate_and_its_manifest_name() {
        let folder = std::env::temp_dir().join(format!("corehbot-excerpt-{}", std::process::id()));
        write(&folder, "units", &["surface"]).unwrap();
        let named = |file: &str, begin, end| -> Vec<PathBuf> {
            let text = fs::read_to_string(folder.join(file)).unwrap();
            let places = text.split(begin).skip(1).filter_map(|rest| rest.split(end).next());
            places.map(|place| folder.join(file).with_file_name(place)).collect()
        };
        let included = named("src/lib.rs", "include_str!(\"", '"');
        let programs = named("Cargo.toml", "\npath = \"", '"');
        assert_eq!((included.len(), programs.len()), (1, 2));
        let missing: Vec<_> = included.iter().chain(&programs).filter(|path| !path.exists()).collect();
        assert!(missing.is_empty(), "{missing:?}");
        let main = fs::read_to_string(folder.join(PROGRAM.1)).unwrap();
        assert!(main.contains("\nmod surface;") && !main.contains("\nmod driver;"));
        fs::remove_dir_all(folder).unwrap();
    }

    /// Behind `crate::` it has no modules of the other program.
    #[test]
    fn a_program_of_its_own_brings_its_rooms_and_no_modules() {
        let Parts { rooms, modules } = Parts::of("units", &["queue_orders"]).unwrap();
        assert!(modules.is_empty() && ["motors", "port", "motion"].iter().all(|room| rooms.contains(*room)));
        assert_eq!(programs(&["motion", "queue_orders", "stepper"]), BTreeSet::from([PROGRAM.0, "queue_orders"]));
    }

    #[test]
    fn other_modules_are_left_out_with_their_files() {
        let text = "//! Tests.\n#[path = \"support/a.rs\"]\nmod a;\nmod b;\n#[path = \"support/c.rs\"]\nmod c;\n";
        let some = some_modules(text, &BTreeSet::from(["b".to_owned(), "c".to_owned()]));
        assert_eq!(some, "//! Tests.\nmod b;\n#[path = \"support/c.rs\"]\nmod c;");
        let modules = modules_of(text);
        assert_eq!(modules["a"], [Path::new("tests/support/a.rs")]);
        assert!(modules_of(&read(Path::new(PROGRAM.1)).unwrap()).values().all(|paths| !paths.is_empty()));
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
