//! Answers of printers with Marlin, in the forms of its three generations, as machine files.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

#[path = "../support/configurations.rs"]
mod configurations;
mod forms;

use corehbot_machine_file::marlin::{Given, Kinematics, translate};
use corehbot_machine_file::{Kind, Report, Translation};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/marlin")
}

/// The logs, with what is said on the command line: 1.1.9, 2.0.x, 2.1.x, and one in inches.
const LOGS: [(&str, Option<&str>); 4] =
    [("mega", Some("cartesian")), ("core", Some("corexy")), ("shaped", None), ("inches", Some("cartesian"))];

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(format!("{name}.log"))).unwrap()
}

/// The translation of a log for the Octopus.
fn translated(name: &str) -> Translation {
    let machine = LOGS.iter().find(|(known, _)| *known == name).unwrap().1;
    of_text(&format!("{name}.log"), &text(name), machine)
}

fn of_text(name: &str, text: &str, machine: Option<&str>) -> Translation {
    let kinematics = machine.map(|name| Kinematics::called(name).unwrap());
    translate(name, text, Given { board: Some(&corehbot_boards::octopus::CONNECTORS), kinematics })
}

/// The verdict on a word: its kind and its words.
fn verdict<'r>(report: &'r Report, code: &str, word: &str) -> (Kind, &'r str) {
    let section = report.sections.iter().find(|known| known.name == code).unwrap();
    let key = section.keys.iter().rfind(|known| known.key == word).unwrap();
    (key.verdict.kind, &key.verdict.text)
}

/// Compares a text with its stored copy.
fn is_stored(name: &str, text: &str) {
    let path = folder().join(name);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap_or_default(), text, "{name}: BLESS=1 writes it");
}

#[test]
fn reports_and_machine_files_are_the_stored_ones() {
    for (name, _) in LOGS {
        let done = translated(name);
        let problems: String = done.problems.iter().map(|problem| format!("{name}.toml:{problem}\n")).collect();
        is_stored(&format!("{name}.txt"), &format!("{}{problems}", done.report));
        is_stored(&format!("{name}.toml"), &done.text);
    }
}
