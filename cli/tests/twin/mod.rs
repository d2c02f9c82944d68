//! `corehbot twin` as a user sees it: questions in, tables and JSON out, and the exit status.

mod asked;
mod fitted;
mod keys;
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
    // A pipe of an earlier run would wait for a reader.
    let _ = std::fs::remove_file(&path);
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
    assert_eq!(corehbot_twin::shaping::shaper::ShaperKind::ALL.len(), kinds.count(), "twin/src/shaping/shaper.rs");
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
    assert!(complaint("modes --routing hbot --free-motor 8").contains("no motor 8"));
    assert!(complaint("slip --motor 3").contains("has 1, 4, 8, 11"));
    assert!(complaint("modes --routing hbot --at 45,100").contains("52.70"));
    let bad = [
        ("typo.toml", "[twin]\nbelt_EA = 1\n", "did you mean `belt_EA_N`?"),
        ("negative.toml", "[twin]\npreload_N = -1\n", "2:13: twin.preload_N = -1 is outside 0 to 1000000"),
        ("alone.toml", "[twin]\nwidth_mm = [470, 470]\n", "2:12: twin.width_mm = [470, 470]: expected a number"),
        ("routing.toml", "[twin]\nrouting = \"hbt\"\n", "2:11: unknown variant `hbt`"),
    ];
    for (name, text, word) in bad {
        let path = file(name, text);
        let told = complaint(&format!("stiffness --machine {}", path.display()));
        assert!(told.contains(name) && told.contains(word), "{told}");
    }
    assert!(complaint("stiffness --machine nowhere.toml").contains("cannot open"));
}

/// Reproducer: a page's folder that does not exist was told after the computation. The file to compute is missing
/// too, so the first complaint shows the order.
#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_computation() {
    let page = "--report nofolder/r.html";
    for words in [
        format!("run nothing.gcode {page}"),
        format!("resonance --grid 200x200 {page}"),
        "ripple --step 0.2 --angle-step 1 --svg nofolder/r.svg".to_owned(),
    ] {
        let told = complaint(&words);
        assert!(told.contains("cannot create nofolder/") && !told.contains("nothing.gcode"), "{words}: {told}");
    }
    let taken = complaint("run nothing.gcode --json same.html --report same.html");
    assert!(taken.contains("same.html is another output already"), "{taken}");
    assert!(!Path::new("same.html.partial").exists());
    // What was there stays, and nothing else is left.
    let kept = file("kept.html", "an older one");
    assert!(complaint(&format!("run nothing.gcode --report {}", kept.display())).contains("nothing.gcode"));
    assert_eq!(std::fs::read(&kept).unwrap(), b"an older one");
    assert!(!kept.with_extension("html.partial").exists());
}

/// Its reader would be lost if the pipe was opened twice.
#[cfg(unix)]
#[test]
fn a_page_may_go_into_a_pipe() {
    let pipe = file("pipe.html", "");
    std::fs::remove_file(&pipe).unwrap();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let path = pipe.clone();
    let reader = std::thread::spawn(move || std::fs::read_to_string(path).unwrap());
    assert!(twin(&format!("resonance --grid 2x2 --report {}", pipe.display())).status.success());
    assert!(reader.join().unwrap().ends_with("</html>\n"));
}
