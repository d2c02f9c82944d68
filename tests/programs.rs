//! The test programs: each file is a part of one, and each recorded failure belongs to a file.

use crate::sources::sources;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The packages whose tests are one program, and with these the core's second one.
const PACKAGES: [&str; 8] = ["", "boards/registry", "cli", "lab", "machine-file", "resonance", "sim/board", "twin"];

/// The files that a source file names as modules, by `mod NAME;`.
fn modules_of(file: &Path) -> Vec<PathBuf> {
    let folder = file.parent().unwrap();
    let is_folder = file.ends_with("main.rs") || file.ends_with("mod.rs");
    let below = if is_folder { folder.to_owned() } else { file.with_extension("") };
    let mut path = None;
    let mut modules = Vec::new();
    for line in fs::read_to_string(file).unwrap().lines() {
        if let Some(name) = line.trim_start_matches("pub ").strip_prefix("mod ").and_then(|rest| rest.strip_suffix(';'))
        {
            let usual = [below.join(name).with_extension("rs"), below.join(name).join("mod.rs")];
            modules.extend(path.take().map_or_else(|| usual.to_vec(), |path| vec![folder.join(path)]));
        }
        path = line.strip_prefix("#[path = \"").and_then(|rest| rest.strip_suffix("\"]")).map(str::to_owned).or(path);
    }
    modules.into_iter().filter_map(|module| module.canonicalize().ok()).collect()
}

/// The test programs that a package's manifest names.
fn programs_of(package: &Path) -> Vec<PathBuf> {
    let manifest = fs::read_to_string(package.join("Cargo.toml")).unwrap();
    let paths = manifest.lines().filter_map(|line| line.strip_prefix("path = \"")?.strip_suffix('"'));
    paths.filter(|path| path.starts_with("tests/")).map(|path| package.join(path).canonicalize().unwrap()).collect()
}

/// A file that no `mod` names, and a program that no manifest names, are not compiled: their tests would be silent.
#[test]
fn every_file_of_a_test_program_is_a_part_of_it() {
    let mut files = Vec::new();
    let mut parts = BTreeSet::new();
    for package in PACKAGES.map(Path::new) {
        sources(&package.join("tests"), &mut files);
        parts.extend(programs_of(package));
    }
    assert!(files.len() > 200 && parts.len() == 9, "{} files, {} programs", files.len(), parts.len());
    parts.extend(files.iter().flat_map(|file| modules_of(file)));
    let lone: Vec<_> = files.iter().filter(|file| !parts.contains(&file.canonicalize().unwrap())).collect();
    assert!(lone.is_empty(), "no parts of a test program: {lone:?}");
}

/// Each further program is linked with the whole package once more, and begins when the one before it has ended.
#[test]
fn a_package_of_the_workspace_has_one_test_program() {
    let manifest = fs::read_to_string("Cargo.toml").unwrap();
    let members = manifest.lines().find_map(|line| line.strip_prefix("members = [")?.strip_suffix(']')).unwrap();
    let packages: Vec<_> = members.split(", ").map(|member| Path::new(member.trim_matches('"'))).collect();
    assert!(packages.len() > 20, "{packages:?}");
    for package in packages {
        let is_found = !fs::read_to_string(package.join("Cargo.toml")).unwrap().contains("\nautotests = false\n");
        // Cargo takes each file there, and each folder with such a file, for a program.
        let is_program =
            |path: &PathBuf| path.extension().is_some_and(|rs| rs == "rs") || path.join("main.rs").exists();
        let entries = fs::read_dir(package.join("tests")).into_iter().flatten().map(|entry| entry.unwrap().path());
        let programs = if is_found { entries.filter(is_program).count() } else { programs_of(package).len() };
        assert!(programs <= 1, "{} has {programs} test programs", package.display());
    }
}

/// proptest looks for `tests/motion/corners.rs`' failures in `proptest-regressions/motion/corners.txt`, as `main.rs` is
/// in `tests`. It tries no other file, and says nothing.
#[test]
fn every_recorded_failure_is_where_its_test_looks_for_it() {
    let mut records = 0;
    for package in PACKAGES.map(Path::new) {
        let place = package.join("proptest-regressions");
        let mut folders = vec![place.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).into_iter().flatten() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                let test = package.join("tests").join(path.strip_prefix(&place).unwrap()).with_extension("rs");
                let text = fs::read_to_string(&test).unwrap_or_else(|_| panic!("{} has no test", path.display()));
                assert!(text.contains("proptest! {"), "{} draws no cases", test.display());
                records += 1;
            }
        }
        assert!(!package.join("tests/proptest-regressions").exists(), "no test looks there");
    }
    assert!(records > 2, "only {records} found");
}
