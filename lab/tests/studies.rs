//! `corehbot-lab sweep STUDY.toml` as a user sees it: interrupted, killed, in parts, and its refusals.
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A corner with rotors: some hundredths of a second a sample.
const STUDY: &str = "\
compute = [\"stiffness\", \"run\"]
method = \"latin-hypercube\"
samples = 24
seed = 3
[vary]
belt_EA_N = { from = 20000, to = 56000 }
head_mass_kg = { from = 0.4, to = 0.8 }
[run]
file = \"corner.gcode\"
assume_homed = [100, 100, 0]
";

/// A folder of a test with a study in it.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("studies").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("study.toml"), STUDY).unwrap();
    fs::write(folder.join("corner.gcode"), "G1 X120 F9000\nG1 Y120\nM400\n").unwrap();
    folder
}

fn sweep(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot-lab"));
    command.current_dir(folder).arg("sweep").args(words.split_whitespace());
    command
}

fn output(folder: &Path, words: &str) -> Output {
    sweep(folder, words).output().unwrap()
}

/// The bytes of the table after a command that must succeed.
fn table(folder: &Path, words: &str, name: &str) -> Vec<u8> {
    let output = output(folder, words);
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    assert!(!folder.join(format!("{name}.journal")).exists(), "the journal goes when the table is whole");
    fs::read(folder.join(name)).unwrap()
}

/// Whole lines of the journal.
fn kept(folder: &Path) -> usize {
    fs::read(folder.join("s.csv.journal")).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count())
}

/// A running study, with at least this many samples.
fn begun(folder: &Path, samples: usize) -> Child {
    let mut command = sweep(folder, "study.toml -o s.csv --jobs 1");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let begin = Instant::now();
    while kept(folder) < 1 + samples {
        assert!(begin.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

#[test]
fn a_study_that_was_killed_again_and_again_has_the_same_table() {
    let folder = folder("killed");
    let expected = table(&folder, "study.toml -o whole.csv --jobs 2", "whole.csv");
    for samples in [3, 9, 15] {
        let mut child = begun(&folder, samples);
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!folder.join("s.csv").exists());
    }
    assert_eq!(table(&folder, "study.toml -o s.csv", "s.csv"), expected);
    assert_eq!(String::from_utf8(expected).unwrap().lines().count(), 1 + 24);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_finished_and_says_where() {
    let folder = folder("interrupted");
    let expected = table(&folder, "study.toml -o whole.csv", "whole.csv");
    let child = begun(&folder, 3);
    let pid = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(pid, rustix::process::Signal::INT).unwrap();
    let ended = child.wait_with_output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(130), "{said}");
    assert!(said.contains("s.csv.journal keeps") && said.contains("of 24 samples"), "{said}");
    assert_eq!(table(&folder, "study.toml -o s.csv", "s.csv"), expected);
}

#[test]
fn samples_of_many_computers_make_the_same_table() {
    let folder = folder("parts");
    let expected = table(&folder, "study.toml -o whole.csv", "whole.csv");
    let plan = output(&folder, "study.toml --plan").stdout;
    let samples = serde_json::from_slice::<Value>(&plan).unwrap()["samples"].as_u64().unwrap();
    let lines = (0..samples).rev().map(|i| output(&folder, &format!("study.toml --sample {i}")).stdout);
    let journal: Vec<u8> = std::iter::once(plan.clone()).chain(lines).flatten().collect();
    fs::write(folder.join("s.csv.journal"), &journal).unwrap();
    assert_eq!(table(&folder, "study.toml -o s.csv", "s.csv"), expected);
    let line: Value = serde_json::from_slice(&output(&folder, "study.toml --sample 5").stdout).unwrap();
    assert_eq!((&line["sample"], &line["machine"]), (&Value::from(5), &Value::from("corehbot")));
    assert!(line["figures"]["contour_max_mm"].as_f64().unwrap() > 0.001 && line["values"]["head_mass_kg"].is_f64());
    let beyond = output(&folder, "study.toml --sample 24");
    assert_eq!(beyond.status.code(), Some(1));
    assert!(String::from_utf8(beyond.stderr).unwrap().contains("has 0 to 23"));
}

#[test]
fn the_table_can_go_to_standard_output_and_a_page_shows_it() {
    let folder = folder("page");
    let expected = table(&folder, "study.toml -o s.csv --report r.html --json s.json", "s.csv");
    assert_eq!(output(&folder, "study.toml -o -").stdout, expected);
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("s.json")).unwrap()).unwrap();
    let stiffness = &summary["figures"][0];
    // Stiffness goes with the belt's, and with nothing else.
    assert_eq!((&stiffness["name"], summary["failed"].as_u64()), (&Value::from("Kxx_N_per_mm"), Some(0)));
    assert!((stiffness["rank_correlation"]["belt_EA_N"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{summary}");
    let page = fs::read_to_string(folder.join("r.html")).unwrap();
    // One comment, of uPlot, names its project; the name of SVG's elements is no address.
    assert_eq!(page.replace("\"http://www.w3.org/2000/svg\"", "").matches("://").count(), 1);
    assert!(!["/*STYLE*/", "/*SHARED*/", "/*DATA*/", "/*PAGE*/"].iter().any(|mark| page.contains(mark)));
    let data = page.split_once("const D = ").unwrap().1.split_once(";\n").unwrap().0;
    let data: Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["points"].as_array().unwrap().len(), 24);
    assert_eq!(data["points"][0]["figures"].as_array().unwrap().len(), data["figures"].as_array().unwrap().len());
}

/// Hours of computing are not to end in an output that cannot be.
#[test]
fn outputs_are_judged_before_anything_is_computed() {
    let folder = folder("outputs");
    let hours = STUDY.replace("samples = 24", "samples = 900000");
    fs::write(folder.join("study.toml"), &hours).unwrap();
    let cases = [
        ("-o - --json -", "only one output can go to standard output"),
        ("-o - --report -", "only one output can go to standard output"),
        ("-o s.csv --report nowhere/r.html", "cannot create nowhere/r.html"),
        ("-o s.csv --json nowhere/s.json", "cannot create nowhere/s.json"),
        ("-o nowhere/s.csv", "nowhere/s.csv"),
        ("-o s.csv --report s.csv", "s.csv is another output already"),
        ("-o study.toml", "study.toml would overwrite the input"),
        ("-o s.csv --json corner.gcode", "corner.gcode would overwrite the input"),
        ("-o s.csv --json s.csv.journal", "s.csv.journal would overwrite the input"),
    ];
    for (words, why) in cases {
        let ended = output(&folder, &format!("study.toml {words}"));
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(1), "{words}: {said}");
        assert!(said.contains(why) && said.lines().count() == 1, "{words}: {said}");
        let names = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort_unstable();
        assert_eq!(names, ["corner.gcode", "study.toml"], "{words}");
    }
    assert_eq!(fs::read_to_string(folder.join("study.toml")).unwrap(), hours);
}

#[test]
fn what_cannot_be_is_said_in_one_line() {
    let folder = folder("refused");
    let said = |words: &str, status: i32| {
        let output = output(&folder, words);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{words}: {text}");
        text
    };
    assert!(said("study.toml", 1).contains("needs an output"));
    assert!(said("nothing.toml -o s.csv", 1).contains("cannot open nothing.toml"));
    assert!(said("", 2).contains("FILE"));
    // Options that the study sets conflict with it.
    assert!(said("study.toml -o s.csv --routing corexy", 2).contains("cannot be used with"));
    assert!(said("study.toml -o s.csv --assume-homed 1,2,3", 2).contains("cannot be used with"));
    assert!(said("--vary belt_EA_N=1:2:3 -o s.csv", 2).contains("cannot be used with"));
    assert!(said("study.toml -o s.csv --jobs 0", 2).contains("--jobs"));
    fs::write(folder.join("s.csv.journal"), "my notes\n").unwrap();
    assert!(said("study.toml -o s.csv", 1).contains("s.csv.journal: is not a journal"));
    fs::remove_file(folder.join("s.csv.journal")).unwrap();
    fs::remove_file(folder.join("corner.gcode")).unwrap();
    assert!(said("study.toml -o s.csv", 1).contains("corner.gcode"));
    fs::write(folder.join("corner.gcode"), "M112\n").unwrap();
    // The first line of a journal needs no steps.
    assert!(said("study.toml --plan", 0).is_empty());
    for words in ["study.toml --sample 0", "study.toml -o s.csv"] {
        assert!(said(words, 1).contains("corner.gcode: the print failed"), "{words}");
    }
    assert!(!folder.join("s.csv.journal").exists());
    fs::write(folder.join("study.toml"), STUDY.replace("seed", "sed")).unwrap();
    let typo = said("study.toml -o s.csv", 1);
    assert!(typo.contains("study.toml:4:1: ") && typo.contains("did you mean `seed`?"), "{typo}");
}
