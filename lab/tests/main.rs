//! `corehbot-lab` as a user sees it: questions in, tables, JSON and drawings out, and the exit status; and its models.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod asked;
mod compared;
mod compensated;
mod drawn;
mod keys;
mod model;
mod papers;
mod parts;
mod studies;
mod varied;
mod wrong_files;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn ask(words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corehbot-lab")).args(words.split_whitespace()).output().unwrap()
}

/// The command, which is an example of this package and is built with its tests.
fn corehbot(words: &str) -> Output {
    let program = std::env::current_exe().unwrap();
    let command = program.parent().and_then(Path::parent).unwrap().join("examples/command_for_lab");
    assert!(command.exists(), "{} is built with all tests of this package", command.display());
    Command::new(command).args(words.split_whitespace()).output().unwrap()
}

/// The JSON on standard output.
fn told(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The JSON that a question is answered with.
fn json(words: &str) -> Value {
    told(&ask(&format!("{words} --json -")))
}

/// The one line that a question fails with.
fn complaint(words: &str) -> String {
    let output = ask(words);
    assert_eq!(output.status.code(), Some(1), "{words}");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

fn file(test: &str, text: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("lab");
    std::fs::create_dir_all(&place).unwrap();
    let path = place.join(test);
    // A pipe of an earlier run would wait for a reader.
    let _ = std::fs::remove_file(&path);
    std::fs::write(&path, text).unwrap();
    path
}

fn near(value: &Value, expected: f64, part: f64) -> bool {
    (value.as_f64().unwrap() - expected).abs() <= part * expected.abs().max(1e-3)
}
