//! The types of the machine: who may reach what. An owner keeps its fields to itself, no type has more methods than a
//! reader keeps in mind, and no command gets the Console.

use crate::sources::{code_of, sources};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Whether a name occurs in code, not as a part of another.
fn names(code: &str, name: &str) -> bool {
    let is_other = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(name).any(|(at, found)| {
        !code[..at].chars().next_back().is_some_and(is_other)
            && !code[at + found.len()..].chars().next().is_some_and(is_other)
    })
}

/// The lines with the fields of a struct; none if it is not in this code.
fn fields_of<'c>(code: &'c str, name: &str) -> Vec<&'c str> {
    let is_other = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(&format!("struct {name}"))
        .map(|(at, found)| &code[at + found.len()..])
        .find(|rest| !rest.starts_with(is_other))
        .and_then(|rest| rest.split_once(" {\n"))
        .and_then(|(_, begin)| begin.split_once("\n}"))
        .map_or_else(Vec::new, |(fields, _)| fields.lines().map(str::trim).collect())
}

/// The types of the main loop's owners, which are its public fields.
fn owners(machine: &Path) -> Vec<String> {
    let text = fs::read_to_string(machine.join("main_loop/mod.rs")).unwrap();
    let code = code_of(&text);
    let open = fields_of(&code, "MainLoop").into_iter().filter(|field| field.starts_with("pub "));
    // What is left is a port of the board, or the atomics, which have one writer each.
    open.map(|field| field.split(": ").nth(1).unwrap())
        .filter(|owner| !owner.starts_with("P::") && !owner.starts_with('&'))
        .map(|owner| owner.split(['<', ',']).next().unwrap().to_owned())
        .collect()
}

#[test]
fn an_owner_has_private_fields() {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/machine");
    let mut files = Vec::new();
    sources(&machine, &mut files);
    let mut wrong = Vec::new();
    let mut missing: BTreeSet<String> = owners(&machine).into_iter().chain(["Console".to_owned()]).collect();
    assert!(missing.len() > 5, "only {} owners found", missing.len());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let code = code_of(&text);
        for owner in missing.clone() {
            let fields = fields_of(&code, &owner);
            if !fields.is_empty() {
                missing.remove(&owner);
            }
            wrong.extend(fields.into_iter().filter(|field| field.starts_with("pub")).map(|f| format!("{owner}: {f}")));
        }
    }
    assert!(missing.is_empty(), "not found: {missing:?}");
    assert!(wrong.is_empty(), "fields that others can reach:\n{}", wrong.join("\n"));
}

/// The type that a line begins to implement.
fn implemented(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("impl")?;
    let mut depth = 0;
    let (_, header) = rest.split_at(rest.find(|c| {
        depth += i32::from(c == '<') - i32::from(c == '>');
        depth == 0 && c == ' '
    })?);
    let name = header.split_once(" for ").map_or(header, |(_, name)| name).trim_start();
    name.split(|c: char| !(c.is_alphanumeric() || c == '_')).next()
}

/// The greatest number of methods of a type of the machine: as many as a reader keeps in mind.
const MOST_METHODS: usize = 30;

#[test]
fn no_type_of_the_machine_has_more_methods_than_a_reader_keeps_in_mind() {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/machine");
    let mut files = Vec::new();
    sources(&machine, &mut files);
    let mut methods = BTreeMap::<String, usize>::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let mut of: Option<String> = None;
        for line in code_of(&text).lines() {
            of = implemented(line).map(str::to_owned).or(of);
            let is_open = line.starts_with("    pub fn ")
                || line.starts_with("    pub const fn ")
                || line.starts_with("    pub async fn ")
                || (line.starts_with("    pub(in crate::machine) ") && line.contains("fn "));
            if is_open {
                *methods.entry(of.clone().unwrap()).or_default() += 1;
            }
        }
    }
    for seen in ["MainLoop", "Motion", "Hosts", "Job", "Commanded"] {
        assert!(methods.contains_key(seen), "{seen} was not found");
    }
    let wrong: Vec<_> = methods.iter().filter(|(_, count)| **count > MOST_METHODS).collect();
    assert!(wrong.is_empty(), "split these, or pass values in: {wrong:?}");
}

#[test]
fn no_command_gets_the_console_and_nobody_widens_the_main_loop() {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/machine");
    let mut files = Vec::new();
    sources(&machine, &mut files);
    let mut wrong = Vec::new();
    for file in files {
        let relative = file.strip_prefix(&machine).unwrap().to_str().unwrap().to_owned();
        let text = fs::read_to_string(&file).unwrap();
        let code = code_of(&text);
        if names(&code, "Console") && !["console.rs", "mod.rs"].contains(&relative.as_str()) {
            wrong.push(format!("{relative} names the Console: it gets the main_loop, and the states that it names"));
        }
        let widens = code.lines().any(|line| line.starts_with("impl") && line.contains("> MainLoop<"));
        if widens && !relative.starts_with("main_loop/") {
            wrong.push(format!("{relative} adds to the main_loop: write a function that gets it"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_type_is_found_in_the_first_line_of_its_methods() {
    for (line, name) in [
        ("impl Job {", Some("Job")),
        ("impl<'m, D: Bus, W: Wake> MainLoop<'m, Ports<D>, W> {", Some("MainLoop")),
        ("impl<S: Serial> Listener for Hosts<S> {", Some("Hosts")),
        ("    impl Inner {", None),
    ] {
        assert_eq!(implemented(line), name, "{line}");
    }
}
