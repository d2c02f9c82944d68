//! Accidents: one of each family in a print, every option that takes them, and the one list of their words.

use super::{heat_text, scratch, text};
use corehbot_sim::accident::{ROWS, words};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Prints on a machine file, or on the prototype, at X100 Y100.
fn print(machine: &str, gcode: &str, args: &[&str]) -> Output {
    static NUMBER: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
    let place = scratch(&format!("accident-{}", NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed)));
    let (file, description) = (place.join("a.gcode"), place.join("m.toml"));
    std::fs::write(&file, gcode).unwrap();
    std::fs::write(&description, machine).unwrap();
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    run.arg("run").arg(file).arg("--machine").arg(description).args(args).output().unwrap()
}

const PROBED: &str = "[endstops]\nprobe = \"PROBE\"\n[probe]\nkind = \"switch\"\n";

const BELTS: [&str; 4] = ["--plant", "belt", "--assume-homed", "100,100,10"];

#[test]
fn one_of_each_family_acts_in_a_print() {
    let told = |output: &Output| format!("{}{}", text(&output.stdout), text(&output.stderr));
    // Heat.
    let output = heat_text("family-heat", "G28\nM109 S200\n", &["--break", "stuck-on@20s"]);
    let out = told(&output);
    assert!(output.status.code() == Some(1) && out.contains("[E1"), "{out}");
    // Supply: a quarter of the power warms too slowly.
    let whole = heat_text("family-supply", "G28\nM109 S60\n", &[]);
    assert_eq!(whole.status.code(), Some(0), "{}", told(&whole));
    let low = heat_text("family-supply", "G28\nM109 S60\n", &["--break", "low-supply@0s"]);
    assert!(low.status.code() == Some(1) && told(&low).contains("[E08]"), "{}", told(&low));
    // The probe.
    let probing = "G28\nG1 X100 Y100 F6000\nG30\n";
    let whole = told(&print(PROBED, probing, &[]));
    assert!(whole.contains("Bed X"), "{whole}");
    let dead = told(&print(PROBED, probing, &["--break", "dead:probe@0s"]));
    assert!(!dead.contains("Bed X") && dead.contains("probe"), "{dead}");
    // Belts: in today's words, and in those of earlier options.
    let skips = |args: &[&str]| {
        let output = print("", "G1 X120 F6000\nG1 Y120\nG1 X100 Y100\n", &[&BELTS[..], args].concat());
        let out = told(&output);
        assert_eq!(output.status.code(), Some(0), "{out}");
        (out.contains("skips              0"), out)
    };
    let (is_quiet, _) = skips(&[]);
    assert!(is_quiet);
    let (is_quiet, today) = skips(&["--break", "rub:m8:300N@0.1s"]);
    assert!(!is_quiet && today.contains("accident           rub:m8:300N@0.1s: at 0.100 s"), "{today}");
    let skipped =
        |out: &str| out.lines().filter(|line| line.contains("full steps")).map(str::to_owned).collect::<Vec<_>>();
    for args in [["--brake", "m8,300,0.1"], ["--break", "m8,300,0.1"], ["--accident", "m8,300,0.1"]] {
        let (_, earlier) = skips(&args);
        assert!(earlier.contains("accident           rub:m8:300@0.1s: at 0.100 s"), "{earlier}");
        assert_eq!(skipped(&earlier), skipped(&today));
    }
    let (_, jumped) = skips(&["--accident", "jump:m4@0.1s", "--break", "loose:m1:+5N@0.1s+0.1s"]);
    assert!(jumped.contains("jump:m4@0.1s: at 0.100 s, belt 2.000 mm ahead of the motor"), "{jumped}");
}

#[test]
fn belts_that_do_not_stretch_say_what_to_do() {
    for (option, accident, of) in [
        ("--break", "seized:7@1s", "seized of 7"),
        ("--brake", "m1,5", "rub of m1"),
        ("--accident", "jump:m1@1s", "jump of m1"),
    ] {
        let output = print("", "G1 X1\n", &[option, accident]);
        let wanted = format!("corehbot: {option} {accident}: {of} needs belts that stretch: add --plant belt");
        assert_eq!((text(&output.stderr).trim_end(), output.status.code()), (wanted.as_str(), Some(2)));
    }
}

#[test]
fn help_has_every_word_with_its_meaning() {
    let output = Command::new(env!("CARGO_BIN_EXE_corehbot")).args(["run", "--help"]).output().unwrap();
    let help = text(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    for (word, says) in words::words() {
        assert!(help.contains(&format!("- {word}: {says}")), "{word}: {says} is not in {help}");
    }
    assert!(help.contains("--break <WHAT[:WHERE[:HOW]]@TIME[+TIME]>") && !help.contains("--brake"), "{help}");
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The tables of docs/reference/accidents.md are the program's; `BLESS=1` writes them.
#[test]
fn the_page_on_accidents_has_the_table() {
    let path = root().join("docs/reference/accidents.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (head, rest) = page.split_once("<!-- accidents -->\n").unwrap();
    let (_, tail) = rest.split_once("<!-- /accidents -->").unwrap();
    let today = format!("{head}<!-- accidents -->\n{}\n<!-- /accidents -->{tail}", words::markdown());
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &today).unwrap();
    }
    assert!(std::fs::read_to_string(&path).unwrap() == today, "BLESS=1 writes it");
}

/// Files in a folder with one of these endings.
fn files(folder: &Path, ends: &[&str], found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, ends, found);
        } else if path.extension().is_some_and(|end| ends.iter().any(|known| end == *known)) {
            found.push(path);
        }
    }
}

/// More words than this in one file would be a second list of them.
const MOST_WORDS: usize = 4;

#[test]
fn no_second_list_of_the_words_exists() {
    let mut found = Vec::new();
    for folder in
        ["sim/board/src", "sim/rig/src", "host/src", "cli/src", "lab/src", "emulator/src", "xtask/src", "report/src"]
    {
        files(&root().join(folder), &["rs", "js"], &mut found);
    }
    files(&root().join("page"), &["rs", "js", "html"], &mut found);
    files(&root().join("docs"), &["md"], &mut found);
    found.sort();
    let mut tables = Vec::new();
    for path in found.iter().filter(|path| !path.ends_with("tests.rs")) {
        let text = std::fs::read_to_string(path).unwrap();
        let source = text.split("\n#[cfg(test)]\nmod ").next().unwrap();
        let is_page = path.extension().is_some_and(|end| end == "md");
        let is_listed = |word: &&str| match is_page {
            true => source.contains(&format!("| `{word}` |")) || source.contains(&format!("`{word}`, `")),
            false => ["\"", "'"].iter().any(|quote| source.contains(&format!("{quote}{word}{quote}"))),
        };
        let listed: BTreeSet<&str> = ROWS.iter().map(|row| row.word).filter(is_listed).collect();
        if listed.len() > MOST_WORDS {
            tables.push((path.strip_prefix(root()).unwrap().to_owned(), listed));
        }
    }
    let names: Vec<&Path> = tables.iter().map(|(path, _)| path.as_path()).collect();
    let only = ["docs/reference/accidents.md", "sim/board/src/accident/table.rs"].map(Path::new);
    assert_eq!(names, only, "{tables:?}");
}
