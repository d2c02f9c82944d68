//! Answers of printers with Marlin, in the forms of its three generations, as machine files.

mod config_g;
mod defines;
mod forms;
mod sources;

use crate::reports::{is_stored, verdict};
use corehbot_machine_file::Translation;
use corehbot_machine_file::marlin::{Given, Kinematics, translate};
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

#[test]
fn reports_and_machine_files_are_the_stored_ones() {
    for (name, _) in LOGS {
        let done = translated(name);
        let problems: String = done.problems.iter().map(|problem| format!("{name}.toml:{problem}\n")).collect();
        is_stored(&folder().join(format!("{name}.txt")), &format!("{}{problems}", done.report));
        is_stored(&folder().join(format!("{name}.toml")), &done.text);
    }
}
