//! The arrows between the crates of the command. The rooms of the core have a test of their own, and so have the twin's
//! rooms; circles of files in any crate are the core's `tests/layers.rs`.

#[path = "../../tests/support/sources.rs"]
mod sources;

use sources::{code_of, sources};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of each crate, its name, and the crates that it may use: only those above it.
const CRATES: [(&str, &str, &[&str]); 16] = [
    ("text-macro", "corehbot-text-macro", &[]),
    (".", "corehbot", &["corehbot-text-macro"]),
    ("sim/rig", "corehbot-rig", &["corehbot"]),
    ("twin", "corehbot-twin", &[]),
    ("resonance", "corehbot-resonance", &["corehbot-twin"]),
    ("chips/wiring", "corehbot-wiring", &["corehbot"]),
    ("boards/registry", "corehbot-boards", &["corehbot", "corehbot-wiring"]),
    ("machine-file", "corehbot-machine-file", &["corehbot", "corehbot-boards", "corehbot-wiring", "corehbot-twin"]),
    ("gcode-file", "corehbot-gcode-file", &["corehbot-machine-file"]),
    ("sim/board", "corehbot-sim", &["corehbot", "corehbot-rig", "corehbot-twin", "corehbot-machine-file"]),
    (
        "host",
        "corehbot-host",
        &[
            "corehbot",
            "corehbot-boards",
            "corehbot-rig",
            "corehbot-twin",
            "corehbot-machine-file",
            "corehbot-gcode-file",
            "corehbot-sim",
        ],
    ),
    (
        "questions",
        "corehbot-questions",
        &["corehbot", "corehbot-rig", "corehbot-twin", "corehbot-machine-file", "corehbot-sim", "corehbot-host"],
    ),
    (
        "report",
        "corehbot-report",
        &["corehbot", "corehbot-twin", "corehbot-resonance", "corehbot-machine-file", "corehbot-sim"],
    ),
    (
        "page",
        "corehbot-page",
        &[
            "corehbot",
            "corehbot-boards",
            "corehbot-rig",
            "corehbot-twin",
            "corehbot-machine-file",
            "corehbot-gcode-file",
            "corehbot-sim",
            "corehbot-report",
        ],
    ),
    (
        "lab",
        "corehbot-lab",
        &[
            "corehbot",
            "corehbot-rig",
            "corehbot-twin",
            "corehbot-machine-file",
            "corehbot-sim",
            "corehbot-host",
            "corehbot-questions",
            "corehbot-report",
        ],
    ),
    (
        "cli",
        "corehbot-cli",
        &[
            "corehbot",
            "corehbot-boards",
            "corehbot-rig",
            "corehbot-twin",
            "corehbot-resonance",
            "corehbot-machine-file",
            "corehbot-sim",
            "corehbot-report",
            "corehbot-host",
            "corehbot-questions",
        ],
    ),
];

/// The houses, in their order: a crate uses crates of its own house and of those above. Docs: explanation/houses.md.
const HOUSES: [(&str, &[&str]); 8] = [
    ("the core", &["text-macro", "."]),
    (
        "what flies",
        &[
            "boards/nucleo",
            "boards/octopus",
            "boards/registry",
            "chips/board-support",
            "chips/cortex-m4",
            "chips/stepgen",
            "chips/stm32f446",
            "chips/usb-device",
            "chips/wiring",
        ],
    ),
    ("the belt's twin", &["twin"]),
    ("files", &["gcode-file", "machine-file"]),
    ("the simulated machine", &["sim/board", "sim/rig"]),
    ("the host", &["cli", "host", "page", "questions", "report", "resonance"]),
    ("the laboratory", &["lab"]),
    ("the bench", &["boards/qemu", "chips/usb-model", "emulator", "fuzz", "page/bind", "xtask", "xtask/manual"]),
];

/// The crates that may use a system.
const ON_A_SYSTEM: [&str; 4] = ["host", "questions", "lab", "cli"];

/// Parts of a system: threads, clocks, processes, temporary files, terminals. Only the command and its host's crate may
/// use them: the others run in a browser too.
const SYSTEM: [&str; 8] =
    ["std::thread", "std::time", "std::process", "std::env", "tempfile::", "rayon::", "rustix::", "indicatif::"];

fn folder_of(krate: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(krate)
}

/// The crates of the project that a crate is built with, its tests apart.
fn dependencies(krate: &str) -> BTreeSet<String> {
    let manifest: toml::Table = fs::read_to_string(folder_of(krate).join("Cargo.toml")).unwrap().parse().unwrap();
    let targets = manifest.get("target").and_then(toml::Value::as_table).into_iter().flat_map(toml::Table::values);
    let tables = std::iter::once(&manifest).chain(targets.filter_map(toml::Value::as_table));
    let names = tables.filter_map(|table| table.get("dependencies")?.as_table()).flat_map(toml::Table::keys);
    names.filter(|name| name.starts_with("corehbot")).cloned().collect()
}

#[test]
fn crates_use_only_those_above_them() {
    let mut above = BTreeSet::new();
    for (folder, name, may) in CRATES {
        assert!(may.iter().all(|used| above.contains(used)), "{name} uses what is not above it: {may:?}");
        let used = dependencies(folder);
        let expected: BTreeSet<String> = may.iter().map(|name| (*name).to_owned()).collect();
        assert_eq!(used, expected, "{folder}/Cargo.toml");
        above.insert(name);
    }
}

/// The folders of all crates: those of the workspace, and those with a workspace of their own.
fn crates() -> BTreeSet<String> {
    let manifest: toml::Table = fs::read_to_string(folder_of(".").join("Cargo.toml")).unwrap().parse().unwrap();
    let lists = ["members", "exclude"].map(|key| manifest["workspace"].get(key).and_then(toml::Value::as_array));
    let folders = lists.into_iter().flatten().flatten().map(|folder| folder.as_str().unwrap().to_owned());
    folders.chain([".".to_owned()]).collect()
}

/// The name of the crate in a folder.
fn name_of(krate: &str) -> String {
    let manifest: toml::Table = fs::read_to_string(folder_of(krate).join("Cargo.toml")).unwrap().parse().unwrap();
    manifest["package"]["name"].as_str().unwrap().to_owned()
}

#[test]
fn no_arrow_between_crates_leads_up_to_another_house() {
    let housed: Vec<&str> = HOUSES.iter().flat_map(|(_, folders)| folders.iter().copied()).collect();
    assert_eq!(housed.iter().map(|folder| (*folder).to_owned()).collect::<BTreeSet<_>>(), crates(), "a house for each");
    let (mut known, mut arrows) = (BTreeSet::new(), 0);
    for (house, folders) in HOUSES {
        known.extend(folders.iter().map(|folder| name_of(folder)));
        for folder in folders {
            let used = dependencies(folder);
            arrows += used.len();
            let below: Vec<_> = used.difference(&known).collect();
            assert!(below.is_empty(), "{folder} is in {house}, and uses {below:?} of a house below");
        }
    }
    assert!(arrows > 60, "only {arrows} arrows found");
}

#[test]
fn below_the_command_nothing_takes_threads_clocks_or_temporary_files() {
    for (krate, _, _) in CRATES.iter().filter(|(folder, _, _)| !ON_A_SYSTEM.contains(folder)) {
        let mut files = Vec::new();
        sources(&folder_of(krate).join("src"), &mut files);
        for file in files.iter().filter(|file| file.file_name().is_none_or(|name| name != "tests.rs")) {
            let code = code_of(&fs::read_to_string(file).unwrap());
            for taken in SYSTEM {
                assert!(!code.contains(taken), "{}: {taken}", file.display());
            }
        }
    }
}
