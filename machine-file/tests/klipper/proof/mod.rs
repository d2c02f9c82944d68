//! A proof of values. Configurations with every section are made at random. Another reader works out each key of the
//! machine file, and every value of the file is compared.
//!
//! The reader (`reader`, `expected`) shares nothing with the converter: its own parser, its own tables of pins, and the
//! laws of Klipper's documentation. A key in the file that it does not expect is a failure too.

mod expected;
mod made;
mod reader;

use super::of_text;
use corehbot_machine_file::Translation;
use corehbot_machine_file::klipper::Kind::{Approximated, Taken};
use expected::expected;
use made::Made;
use reader::Read;
use std::collections::BTreeMap;
use toml::Value as Toml;

/// Configurations that are made. Each key is there in about three of four, so every pair of keys comes together and
/// apart many times.
const CASES: u64 = 100;

/// The keys of a machine file, with their tables.
fn leaves(table: &toml::Table, before: &str, found: &mut BTreeMap<String, Toml>) {
    for (key, value) in table {
        let path = if before.is_empty() { key.clone() } else { format!("{before}.{key}") };
        match value {
            // A thermistor is one value.
            Toml::Table(inner) if !path.ends_with(".thermistor") => leaves(inner, &path, found),
            _ => drop(found.insert(path, value.clone())),
        }
    }
}

fn file(done: &Translation) -> BTreeMap<String, Toml> {
    let mut found = BTreeMap::new();
    leaves(&done.text.parse().unwrap(), "", &mut found);
    found
}

fn number(value: &Toml) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Whether two values are one: numbers within their digits.
fn is_same(a: &Toml, b: &Toml) -> bool {
    match (number(a), number(b)) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-6 * a.abs().max(1.0),
        _ => a == b,
    }
}

#[test]
fn every_value_is_as_another_reader_reads_it() {
    for seed in 0..CASES {
        let text = Made::new(seed).text();
        let done = of_text(&text);
        let (found, wanted) = (file(&done), expected(&Read::of(&text)));
        for (path, value) in &found {
            let other = wanted.get(path);
            assert!(
                other.is_some_and(|other| is_same(value, other)),
                "seed {seed}: {path} = {value}, and by another reader {other:?}\n{text}"
            );
        }
        let missing: Vec<_> = wanted.keys().filter(|path| !found.contains_key(*path)).collect();
        assert!(missing.is_empty(), "seed {seed}: {missing:?} are missing\n{text}\n{}", done.text);
    }
}

/// A key that is told to be taken has its value in the file, and no key of ours is taken from two keys that differ.
#[test]
fn what_is_told_is_in_the_file() {
    for seed in 0..CASES {
        let text = Made::new(seed).text();
        let done = of_text(&text);
        let found = file(&done);
        for key in done.report.sections.iter().flat_map(|section| &section.keys) {
            if ![Taken, Approximated].contains(&key.verdict.kind) {
                continue;
            }
            for part in key.verdict.text.split("; ") {
                let Some((path, told)) = part.split_once(" = ") else { continue };
                let told = told.split(", because").next().unwrap_or(told);
                let told = told.split(", the greatest").next().unwrap_or(told);
                let Ok(told) = format!("x = {told}").parse::<toml::Table>() else { continue };
                let value =
                    found.get(path).unwrap_or_else(|| panic!("seed {seed}: {path} is not there: {part}\n{text}"));
                assert!(is_same(value, &told["x"]), "seed {seed}: {}: {part}, but {value}\n{text}", key.key);
            }
        }
    }
}

/// The generator makes what it is meant to: each of its sections and keys, many times.
#[test]
fn every_section_and_key_is_made() {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for seed in 0..CASES {
        let text = Made::new(seed).text();
        for (section, keys) in Read::of(&text).sections {
            keys.keys().for_each(|key| *counts.entry(format!("[{section}] {key}")).or_default() += 1);
        }
    }
    assert!(counts.len() > 150, "{}", counts.len());
    let rare: Vec<_> = counts.iter().filter(|(_, count)| **count < 5).collect();
    assert!(rare.is_empty(), "{rare:?}");
}
