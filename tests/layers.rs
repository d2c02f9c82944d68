//! The arrows between the rooms: every `use crate::room` in src/ must be one that this table holds.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// What each room may use. A room uses itself without asking.
const ARROWS: [(&str, &[&str]); 14] = [
    ("units", &[]),
    ("text", &[]),
    ("motors", &[]),
    ("status", &["motors"]),
    ("port", &["units", "motors"]),
    ("protocol", &["units", "text", "port"]),
    ("gcode", &["units", "text"]),
    ("kinematics", &["units", "motors"]),
    ("settings", &["units", "motors", "kinematics"]),
    ("motion", &["units", "motors", "status", "port", "settings", "kinematics"]),
    ("driver", &["units", "motors", "port", "settings"]),
    ("storage", &["units", "port", "kinematics", "settings"]),
    (
        "machine",
        &[
            "units",
            "motors",
            "status",
            "port",
            "protocol",
            "gcode",
            "settings",
            "kinematics",
            "motion",
            "driver",
            "storage",
        ],
    ),
    ("app", &["units", "motors", "status", "port", "settings", "kinematics", "motion", "machine"]),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The rooms named behind `crate::` in a source text, comments apart.
fn rooms_used(text: &str) -> Vec<String> {
    let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    code.match_indices("crate::")
        .filter_map(|(at, found)| {
            let before = code[..at].chars().next_back();
            let is_path = before.is_none_or(|c| !(c.is_alphanumeric() || c == '_' || c == ':'));
            let name: String =
                code[at + found.len()..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            (is_path && !name.is_empty()).then_some(name)
        })
        .collect()
}

#[test]
fn rooms_use_only_the_rooms_to_their_left() {
    let allowed: BTreeMap<_, _> = ARROWS.into_iter().collect();
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    assert!(files.len() > 20, "only {} sources found", files.len());
    let mut wrong = Vec::new();
    for file in files {
        let relative = file.strip_prefix(&src).unwrap();
        let room = relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_owned();
        if room == "lib" {
            continue;
        }
        let may = allowed.get(room.as_str()).unwrap_or_else(|| panic!("room {room} is not in the table"));
        for used in rooms_used(&fs::read_to_string(&file).unwrap()) {
            if used != room && !may.contains(&used.as_str()) {
                wrong.push(format!("{}: {room} -> {used}", relative.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "arrows that the table does not hold:\n{}", wrong.join("\n"));
}

#[test]
fn the_table_has_no_cycle() {
    let order: Vec<&str> = ARROWS.iter().map(|(room, _)| *room).collect();
    for (at, (room, may)) in ARROWS.iter().enumerate() {
        for used in *may {
            let place = order.iter().position(|r| r == used);
            assert!(place.is_some_and(|p| p < at), "{room} uses {used}, which is not to its left");
        }
    }
}

#[test]
fn an_arrow_is_found_wherever_it_is_written() {
    let text = "use crate::units::Mm;\n// crate::app\nfn f(x: crate::port::Motor) { mycrate::machine() }";
    assert_eq!(rooms_used(text), ["units", "port"]);
}
