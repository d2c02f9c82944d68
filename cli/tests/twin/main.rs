//! `corehbot twin` as a user sees it: questions in, tables and JSON out, and the exit status.
// Clippy sees no test in the helpers here.
#![allow(clippy::unwrap_used)]

mod asked;
mod compensated;
mod drawn;
mod fitted;
mod keys;
mod papers;
mod parts;
mod played;
mod questions;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn twin(words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("twin").args(words.split_whitespace()).output().unwrap()
}

/// The JSON that a question is answered with on standard output.
fn json(words: &str) -> Value {
    let output = twin(&format!("{words} --json -"));
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The one line that a question fails with.
fn complaint(words: &str) -> String {
    let output = twin(words);
    assert_eq!(output.status.code(), Some(1), "{words}");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

fn file(test: &str, text: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("twin");
    std::fs::create_dir_all(&place).unwrap();
    let path = place.join(test);
    std::fs::write(&path, text).unwrap();
    path
}

fn near(value: &Value, expected: f64, part: f64) -> bool {
    (value.as_f64().unwrap() - expected).abs() <= part * expected.abs().max(1e-3)
}

/// The twin suggests the firmware's shapers and no others.
#[test]
fn the_twin_knows_every_shaper() {
    let kinds = corehbot::settings::ShaperKind::all().filter(|kind| *kind != corehbot::settings::ShaperKind::None);
    assert_eq!(corehbot_twin::shaping::shaper::Kind::ALL.len(), kinds.count(), "twin/src/shaping/shaper.rs");
}
#[test]
fn the_numbers_of_a_machine_stand_in_the_documentation() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/settings.md");
    let docs = std::fs::read_to_string(docs).unwrap();
    let nominal = serde_json::to_value(corehbot_twin::params::Params::default()).unwrap();
    for (key, value) in nominal.as_object().unwrap() {
        let row =
            docs.lines().find(|line| line.starts_with(&format!("| `twin.{key}` |"))).unwrap_or_else(|| panic!("{key}"));
        let told: f64 = row.split('|').nth(5).unwrap().trim().parse().unwrap();
        assert!(near(value, told, 1e-12), "{row}");
    }
}

#[test]
fn people_get_tables() {
    let text = String::from_utf8(twin("slip --motor 8 --at 100,100").stdout).unwrap();
    assert!(text.contains("motor 8 slipped by 4 full steps") && text.contains("residual"), "{text}");
    let both = twin("stiffness --json -");
    assert!(String::from_utf8(both.stderr).unwrap().contains("Kxx"));
}

#[test]
fn what_is_not_there_is_told_in_one_line() {
    assert!(complaint("stiffness --at 10,10").contains("x 40.00 to 430.00"));
    assert!(complaint("stiffness --gcode-frame --at 400,10").contains("x 0.00 to 390.00"));
    assert!(complaint("modes --machine hbot --free-motor 8").contains("no motor 8"));
    assert!(complaint("slip --motor 3").contains("has 1, 4, 8, 11"));
    assert!(complaint("modes --machine hbot --at 45,100").contains("52.70"));
    let bad = [
        ("typo.toml", "[twin]\nbelt_EA = 1\n", "did you mean `belt_EA_N`?"),
        ("negative.toml", "[twin]\npreload_N = -1\n", "2:13: twin.preload_N = -1 is outside 0 to 1000000"),
        ("alone.toml", "[twin]\nwidth_mm = [470, 470]\n", "2:12: twin.width_mm = [470, 470]: expected a number"),
        ("routing.toml", "[twin]\nrouting = \"hbt\"\n", "2:11: unknown variant `hbt`"),
    ];
    for (name, text, word) in bad {
        let path = file(name, text);
        let told = complaint(&format!("stiffness --settings {}", path.display()));
        assert!(told.contains(name) && told.contains(word), "{told}");
    }
    assert!(complaint("stiffness --settings nowhere.toml").contains("cannot open"));
}
