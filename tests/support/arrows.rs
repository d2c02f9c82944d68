//! Arrows: which files and folders of a crate use which, read from their sources; for the tests that hold them.

use crate::sources::code_of;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The module that a file below src/ is.
pub fn module_of(relative: &Path) -> Vec<String> {
    let mut path: Vec<String> = relative.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    let file = path.pop().unwrap();
    if file != "mod.rs" && file != "lib.rs" {
        path.push(file.trim_end_matches(".rs").to_owned());
    }
    path
}

/// The paths of a `use` tree, without its braces.
pub fn branches(tree: &str) -> Vec<String> {
    let Some((stem, rest)) = tree.split_once('{') else { return vec![tree.trim().to_owned()] };
    let (mut parts, mut depth, mut part) = (Vec::new(), 0, String::new());
    for c in rest.chars() {
        match c {
            ',' if depth == 0 => parts.push(std::mem::take(&mut part)),
            '}' if depth == 0 => break,
            _ => {
                depth += i32::from(c == '{') - i32::from(c == '}');
                part.push(c);
            }
        }
    }
    parts.push(part);
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| branches(part)).map(|part| format!("{}{part}", stem.trim())).collect()
}

/// The paths that a file uses, from the root of the crate on. A `use` without `crate` or `super` is one of a child.
pub fn paths_used(module: &[String], code: &str) -> Vec<Vec<String>> {
    let uses =
        code.match_indices("use ").filter(|(at, _)| code[..*at].chars().next_back().is_none_or(char::is_whitespace));
    let mut paths: Vec<String> =
        uses.flat_map(|(at, found)| branches(code[at + found.len()..].split(';').next().unwrap())).collect();
    for (at, _) in code.match_indices("crate::").chain(code.match_indices("super::")) {
        let is_begin = code[..at].chars().next_back().is_none_or(|c| !(c.is_alphanumeric() || c == '_' || c == ':'));
        let is_path = |c: &char| c.is_alphanumeric() || *c == '_' || *c == ':';
        if is_begin {
            paths.push(code[at..].chars().take_while(is_path).collect());
        }
    }
    let absolute = |path: &String| {
        let mut parts = path.split("::").map(|part| part.split_whitespace().next().unwrap_or_default().to_owned());
        let mut root = match parts.clone().next().unwrap().as_str() {
            "crate" => Vec::new(),
            _ => module.to_vec(),
        };
        parts.by_ref().for_each(|part| match part.as_str() {
            "crate" | "self" | "" => {}
            "super" => drop(root.pop()),
            _ => root.push(part),
        });
        root
    };
    paths.iter().map(absolute).collect()
}

/// The files and folders in one folder, and the others of that folder that each of them uses.
///
/// A folder's own `mod.rs` is not one of them: it opens the folder, and its files may use its definitions. A name that
/// `mod.rs` hands on from one of its files counts as that file's.
pub fn arrows_within(src: &Path, files: &[PathBuf]) -> BTreeMap<Vec<String>, BTreeMap<String, BTreeSet<String>>> {
    let read: Vec<_> = files
        .iter()
        // A test may use any file.
        .filter(|file| file.file_name().is_none_or(|name| name != "tests.rs"))
        .map(|file| {
            let module = module_of(file.strip_prefix(src).unwrap());
            let code = code_of(&fs::read_to_string(file).unwrap());
            (module.clone(), paths_used(&module, &code))
        })
        .collect();
    let modules: BTreeSet<&Vec<String>> = read.iter().map(|(module, _)| module).collect();
    let mut arrows = BTreeMap::new();
    for (module, paths) in &read {
        for path in paths {
            let common = module.iter().zip(path).take_while(|(a, b)| a == b).count();
            let (Some(from), Some(name)) = (module.get(common), path.get(common)) else { continue };
            let folder = &module[..common];
            let file = |name: &String| modules.contains(&[folder, std::slice::from_ref(name)].concat());
            // A name of the folder's own, or one that it hands on.
            let handed_on = || {
                let (_, handed) = read.iter().find(|(other, _)| other == folder)?;
                let used = handed.iter().find(|used| used.starts_with(folder) && used.last() == Some(name))?;
                used.get(common).filter(|name| file(name))
            };
            let Some(to) = Some(name).filter(|name| file(name)).or_else(handed_on) else { continue };
            if to != from {
                let folder: &mut BTreeMap<String, BTreeSet<String>> = arrows.entry(folder.to_vec()).or_default();
                folder.entry(from.clone()).or_default().insert(to.clone());
            }
        }
    }
    arrows
}

/// The files that are in a circle, or between two.
pub fn circle(arrows: &BTreeMap<String, BTreeSet<String>>) -> BTreeMap<String, BTreeSet<String>> {
    let mut left = arrows.clone();
    loop {
        let (users, count): (BTreeSet<String>, usize) = (left.keys().cloned().collect(), left.len());
        left.values_mut().for_each(|used| used.retain(|to| users.contains(to)));
        left.retain(|_, used| !used.is_empty());
        if left.len() == count {
            return left;
        }
    }
}
