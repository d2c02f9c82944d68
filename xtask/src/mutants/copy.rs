//! A copy of the checkout, in which rooms of the core have all of their mutants.

use crate::checkout::{cargo, command_output, root, target_dir};
use crate::mutants::rewrite::{Rewritten, rewrite};
use crate::mutants::sites::{self, Site};
use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

/// The switch, a module of the core in the copy.
const SWITCH: &str = include_str!("switch.rs");

/// What the switch needs of the compiler: a function that knows whether the compiler runs it.
const FEATURES: &str = "#![feature(core_intrinsics, const_eval_select)]\n#![no_std]\n";

/// A copy and the mutants in it.
pub struct Copy {
    folder: PathBuf,
    sources: Vec<Source>,
    unviable: BTreeSet<u32>,
}

/// A file of a room.
struct Source {
    room: String,
    path: PathBuf,
    text: String,
    sites: Vec<Site>,
    /// The number of its first mutant.
    first: u32,
    rewritten: Option<Rewritten>,
}

/// A mutant.
pub struct Mutant {
    pub number: u32,
    /// The number of the first mutant of its site.
    pub site: u32,
    /// `file:line:column: change`.
    pub name: String,
}

impl Copy {
    /// Copies all files that belong to the checkout, and finds the sites of rooms.
    pub fn of(rooms: &[&str]) -> Result<Self> {
        let folder = target_dir()?.join("mutants/copy");
        let files = files()?;
        let mut sources = Vec::new();
        let mut first = 0;
        for path in &files {
            let is_source = path.extension().is_some_and(|end| end == "rs") && !is_for_tests(path);
            let room = room_of(path).filter(|room| is_source && rooms.contains(&room.as_str()));
            if let Some(room) = room {
                let text = fs::read_to_string(root().join(path))?;
                let sites = sites::of(&text).with_context(|| format!("cannot read {}", path.display()))?;
                let count: usize = sites.iter().map(|site| site.changes.len()).sum();
                sources.push(Source { room, path: path.clone(), text, sites, first, rewritten: None });
                first += count as u32;
            } else {
                write(&folder.join(path), &contents(path)?)?;
            }
        }
        write(&folder.join("src/mutant.rs"), SWITCH.as_bytes())?;
        remove_others(&folder, &folder, &files)?;
        Ok(Self { folder, sources, unviable: BTreeSet::new() })
    }

    /// Leaves out mutants that do not compile. The compiler finds faults of one kind at a time, so it is asked again.
    ///
    /// What is the same in the end as before has its old time, so it is not built again.
    pub fn leave_out_unviable(&mut self) -> Result<()> {
        let place = |source: &Source| self.folder.join(&source.path);
        let before: Vec<_> = self.sources.iter().map(|source| Written::read(place(source))).collect();
        self.check()?;
        before.iter().flatten().try_for_each(Written::keep)
    }

    fn check(&mut self) -> Result<()> {
        loop {
            for source in &mut self.sources {
                let viable = |number| !self.unviable.contains(&number);
                let rewritten = rewrite(&source.text, &source.sites, source.first, viable);
                write(&self.folder.join(&source.path), rewritten.text.as_bytes())?;
                source.rewritten = Some(rewritten);
            }
            let output = self.cargo(&["check", "--package", "corehbot", "--lib"])?;
            if output.is_success {
                return Ok(());
            }
            let errors: Vec<_> = output.messages.iter().filter(|message| message["level"] == "error").collect();
            let unviable: BTreeSet<u32> = errors.iter().flat_map(|error| self.causes(error)).collect();
            if unviable.is_empty() {
                return output.fail();
            }
            self.unviable.extend(unviable);
        }
    }

    /// The mutants that cause an error: those of its place, else those of the places that it names, else all of a site.
    fn causes(&self, error: &Value) -> Vec<u32> {
        let spans: Vec<_> = error["spans"].as_array().into_iter().flatten().collect();
        let of = |is_primary: bool| {
            let these = spans.iter().filter(move |span| span["is_primary"] == is_primary);
            these.flat_map(|span| places(span)).collect::<Vec<_>>()
        };
        let change = |(file, bytes): &(String, Range<usize>)| self.source(file)?.change_at(bytes);
        let changes = |places: &[(String, Range<usize>)]| places.iter().filter_map(change).collect::<Vec<_>>();
        let [primary, others] = [of(true), of(false)];
        let site = |(file, bytes): &(String, Range<usize>)| Some(self.source(file)?.site_at(bytes));
        [changes(&primary), changes(&others)]
            .into_iter()
            .find(|found| !found.is_empty())
            .unwrap_or_else(|| primary.iter().filter_map(site).flatten().collect())
    }

    fn source(&self, file: &str) -> Option<&Rewritten> {
        self.sources.iter().find(|source| source.path == Path::new(file))?.rewritten.as_ref()
    }

    /// Builds a program of tests, as an argument of cargo names it, and returns where it is.
    pub fn build(&self, package: &str, program: &str) -> Result<PathBuf> {
        let output = self.cargo(&["test", "--no-run", "--package", package, program])?;
        if !output.is_success {
            return output.fail();
        }
        output.programs.into_iter().next().with_context(|| format!("cargo builds no {program}"))
    }

    /// The folder of the copy.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The mutants of a room that compile, and the number of the others.
    pub fn mutants(&self, room: &str) -> (Vec<Mutant>, usize) {
        let mut mutants = Vec::new();
        let mut others = 0;
        for source in self.sources.iter().filter(|source| source.room == room) {
            let mut site = source.first;
            for Site { changes, .. } in &source.sites {
                for (number, change) in (site..).zip(changes) {
                    if self.unviable.contains(&number) {
                        others += 1;
                    } else {
                        mutants.push(Mutant {
                            number,
                            site,
                            name: format!("{}:{}", source.path.display(), change.name),
                        });
                    }
                }
                site += changes.len() as u32;
            }
        }
        (mutants, others)
    }

    /// Runs cargo in the copy.
    fn cargo(&self, args: &[&str]) -> Result<Output> {
        let mut command = cargo(args);
        command.args(["--quiet", "--message-format=json"]).current_dir(&self.folder);
        command.env("CARGO_TARGET_DIR", target_dir()?.join("mutants/target"));
        // The switch needs functions that the stable compiler does not offer; and a mutant is no subject for lints.
        command.env("RUSTC_BOOTSTRAP", "corehbot").env("CARGO_ENCODED_RUSTFLAGS", "--cap-lints=allow");
        // These programs need no debugger. Half optimised, a room and its tests take the least time together.
        command.env("CARGO_PROFILE_DEV_DEBUG", "0");
        command
            .args(["opt-level=1", "codegen-units=16"].map(|to| format!("--config=profile.dev.package.corehbot.{to}")));
        let output = command.output().context("cannot run cargo")?;
        let text = String::from_utf8_lossy(&output.stdout);
        let lines: Vec<Value> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
        Ok(Output {
            is_success: output.status.success(),
            errors: String::from_utf8_lossy(&output.stderr).into_owned(),
            programs: lines.iter().filter_map(|line| Some(line["executable"].as_str()?.into())).collect(),
            messages: lines.into_iter().filter(|line| line["reason"] == "compiler-message").map(message).collect(),
        })
    }
}

/// A file of the copy as it was written before.
struct Written {
    path: PathBuf,
    bytes: Vec<u8>,
    time: SystemTime,
}

impl Written {
    fn read(path: PathBuf) -> Option<Self> {
        let time = fs::metadata(&path).ok()?.modified().ok()?;
        Some(Self { bytes: fs::read(&path).ok()?, path, time })
    }

    /// Gives the file its time back, if it is the same again.
    fn keep(&self) -> Result<()> {
        if fs::read(&self.path).is_ok_and(|now| now == self.bytes) {
            File::options().write(true).open(&self.path)?.set_modified(self.time)?;
        }
        Ok(())
    }
}

/// What cargo said.
struct Output {
    is_success: bool,
    /// The words of cargo itself.
    errors: String,
    messages: Vec<Value>,
    programs: Vec<PathBuf>,
}

impl Output {
    /// The error of a copy that does not compile.
    fn fail<T>(&self) -> Result<T> {
        let texts = self.messages.iter().filter_map(|message| message["rendered"].as_str());
        bail!("the copy does not compile:\n{}{}", texts.collect::<String>(), self.errors);
    }
}

fn message(mut line: Value) -> Value {
    line["message"].take()
}

/// The places of an error, also those in the source of macros.
fn places(span: &Value) -> Vec<(String, Range<usize>)> {
    let byte = |name: &str| Some(span[name].as_u64()? as usize);
    let own = || Some((span["file_name"].as_str()?.to_owned(), byte("byte_start")?..byte("byte_end")?));
    let around = &span["expansion"]["span"];
    own().into_iter().chain(if around.is_null() { Vec::new() } else { places(around) }).collect()
}

/// The files of the checkout, as git knows them.
fn files() -> Result<BTreeSet<PathBuf>> {
    let mut git = Command::new("git");
    git.args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"]).current_dir(root());
    let list = command_output(git)?;
    let paths = list.split('\0').filter(|path| !path.is_empty()).map(PathBuf::from);
    Ok(paths.filter(|path| root().join(path).is_file()).collect())
}

/// Whether a module of the core, or one around it, is only there for tests: the line that names it says so.
fn is_for_tests(path: &Path) -> bool {
    let with_parents = path.ancestors().zip(path.ancestors().skip(1));
    with_parents.filter(|(_, around)| around.starts_with("src")).any(|(module, around)| {
        let name = module.file_stem().unwrap_or_default().to_string_lossy();
        let places = [around.join("mod.rs"), around.join("lib.rs"), around.with_extension("rs")];
        let texts = places.iter().filter_map(|place| fs::read_to_string(root().join(place)).ok());
        texts.into_iter().any(|text| names_for_tests(&text, &name))
    })
}

/// Whether a source names a module, with an attribute for tests before it.
fn names_for_tests(text: &str, module: &str) -> bool {
    let lines: Vec<_> = text.lines().collect();
    let named = lines.iter().position(|line| *line == format!("mod {module};"));
    named.is_some_and(|named| {
        let attributes = lines[..named].iter().rev().take_while(|line| line.starts_with("#["));
        attributes.into_iter().any(|line| line.starts_with("#[cfg(test)]"))
    })
}

/// The room that has this file of the core.
fn room_of(path: &Path) -> Option<String> {
    let name = path.strip_prefix("src").ok()?.iter().next()?;
    Some(Path::new(name).file_stem()?.to_string_lossy().into_owned())
}

/// A file for the copy: the crate of the core has the switch.
fn contents(path: &Path) -> Result<Vec<u8>> {
    let place = root().join(path);
    let bytes = fs::read(&place).with_context(|| format!("cannot open {}", place.display()))?;
    if path != Path::new("src/lib.rs") {
        return Ok(bytes);
    }
    let text = String::from_utf8(bytes)?;
    Ok((text.replacen("#![no_std]\n", FEATURES, 1) + "\nmod mutant;\n").into_bytes())
}

/// Writes a file, unless it is there: what has not changed is not built again.
fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    if fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(path, bytes))
        .with_context(|| format!("cannot write {}", path.display()))
}

/// Removes files of an earlier copy that the checkout does not have.
fn remove_others(copy: &Path, folder: &Path, files: &BTreeSet<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))? {
        let path = entry?.path();
        let name = path.strip_prefix(copy)?;
        if path.is_dir() {
            remove_others(copy, &path, files)?;
        } else if !files.contains(name) && name != Path::new("src/mutant.rs") {
            fs::remove_file(&path).with_context(|| format!("cannot remove {}", path.display()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_for_tests_have_no_mutants() {
        let text = "mod a;\n#[cfg(test)]\n#[path = \"x.rs\"]\nmod b;\n\nmod c;\n";
        assert!(names_for_tests(text, "b") && ["a", "c", "d"].iter().all(|name| !names_for_tests(text, name)));
        assert!(is_for_tests(Path::new("src/storage/record/tests/longest.rs")));
        assert!(!is_for_tests(Path::new("src/storage/record.rs")));
        assert_eq!(room_of(Path::new("src/fault.rs")).as_deref(), Some("fault"));
    }
}
