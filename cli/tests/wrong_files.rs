//! A file of another kind than the wanted one: every command says what it is, and what to do with it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// An empty place for one test's files.
fn scratch(test: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wrong_files").join(test);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn corehbot(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corehbot")).args(args).output().unwrap()
}

/// What a command says when it refuses its files with this status, in one line.
fn refused(args: &[&str], status: i32) -> String {
    let output = corehbot(args);
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(status), "{args:?}: {told}");
    assert_eq!(told.lines().count(), 1, "{args:?}: {told}");
    told
}

/// Files by their names in a place; names and endings count for nothing.
fn file(place: &Path, name: &str, text: &[u8]) -> String {
    let path = place.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

const KLIPPER: &[u8] = b"[printer]\nkinematics: corexy\nmax_velocity: 300\n";
const GCODE: &[u8] = b"G28\nG1 X5 F600\n";
const PICTURE: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\0";

#[test]
fn a_wrong_file_is_told_with_its_way_by_every_command() {
    let place = scratch("told");
    let klipper = file(&place, "print.gcode", KLIPPER);
    let gcode = file(&place, "printer.cfg", GCODE);
    let machine = file(&place, "data.csv", b"[axes.x]\nlength = 300\n");
    let report = file(&place, "a.gcode", b"<!doctype html>\n<title>corehbot report</title>\n");
    let folder = place.display().to_string();
    let from = "`corehbot config from FILE` makes a machine file of it";
    let cases: [(&[&str], i32, String); 9] = [
        (&["run", &klipper], 2, format!("{klipper}: this is Klipper's printer.cfg, not G-code: {from}")),
        (&["run", &gcode, "--machine", &klipper], 2, format!("Klipper's printer.cfg, not a machine file: {from}")),
        (&["run", &machine], 2, "this is a machine file, not G-code: `--machine FILE` takes it".to_owned()),
        (&["run", &report], 2, "a page of `corehbot` with figures, not G-code".to_owned()),
        (&["run", &folder], 2, "this is a folder, not G-code".to_owned()),
        (
            &["config", "check", &gcode],
            2,
            "this is G-code, not a machine file: `corehbot run FILE` prints it".to_owned(),
        ),
        (&["config", "from", &machine], 2, "this is a machine file, not another firmware's settings".to_owned()),
        // `twin` has nothing to prepare.
        (&["twin", "stiffness", "--machine", &gcode], 1, "this is G-code, not a machine file".to_owned()),
        (&["resonance", &gcode], 2, "this is G-code, not a recording".to_owned()),
    ];
    for (args, status, words) in cases {
        let told = refused(args, status);
        assert!(told.contains(&words), "{args:?}: {told}");
    }
}

/// Reproducer: inputs beside the first one gave errors of a parser, or `os error 21`.
#[test]
fn a_wrong_input_of_any_option_is_told_with_its_way() {
    let place = scratch("options");
    let gcode = file(&place, "a.gcode", GCODE);
    let heater = file(&place, "m.toml", b"[heaters.hotend]\nis_fitted = true\n");
    let wrong = [
        (file(&place, "printer.cfg", KLIPPER), "this is Klipper's printer.cfg, not"),
        (file(&place, "other.gcode", GCODE), "this is G-code, not"),
        (file(&place, "p.png", PICTURE), "this is a picture, not"),
        (place.display().to_string(), "this is a folder, not"),
    ];
    let image = place.join("out.bin").display().to_string();
    for (wrong, words) in &wrong {
        let cases: [(&[&str], i32, &str); 4] = [
            (&["twin", "fit", wrong], 1, "measurements"),
            (&["run", &gcode, "--machine", &heater, "--plant-heat", wrong], 2, "a file of heaters"),
            (&["run", &gcode, "--storage", wrong], 2, "stored settings"),
            (&["image", "--from", wrong, "-o", &image], 2, "an image of this firmware"),
        ];
        for (args, status, wanted) in cases {
            let told = refused(args, status);
            assert!(told.contains(&format!("{words} {wanted}")) && !told.contains("os error"), "{args:?}: {told}");
        }
        let kept = Path::new(wrong);
        assert!(kept.is_dir() || std::fs::read(kept).unwrap().len() < 60, "{wrong} is as it was");
    }
}

/// Reproducer: "cannot tell the board, because the main processor has no motors" was said of any text.
#[test]
fn a_file_without_a_printer_is_told_so() {
    let place = scratch("no_printer");
    for (name, text, words) in [
        ("empty", "", "this is an empty file, not another firmware's settings"),
        ("Cargo.toml", "[package]\nname = \"x\"\nversion = \"0.1.0\"\n", "this is a text without anything known in it"),
        (
            "macros.cfg",
            "[gcode_macro START]\ngcode:\n  G28\n",
            "no printer is in it, neither [printer] nor [stepper_x]",
        ),
    ] {
        let path = file(&place, name, text.as_bytes());
        let told = refused(&["config", "from", &path], 2);
        assert!(told.contains(words) && told.contains(name), "{told}");
    }
}
