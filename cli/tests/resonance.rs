//! `corehbot resonance`: files of an accelerometer in, modes, shapers, belts and profiles out.

#[path = "../../resonance/tests/plant/mod.rs"]
mod plant;

use corehbot_resonance::recording::Recording;
use corehbot_resonance::sweep::Sweep;
use plant::{Mode, Noise, recording, text};
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A short sweep, and the words for it.
const SWEEP: Sweep = Sweep {
    from_hz: 20.0,
    to_hz: 100.0,
    accel_per_hz: 40.0,
    hz_per_s: 2.0,
    swing_accel: 0.0,
    swing_period_s: 0.0,
    resolution_mm: 0.0,
};
const SWEPT: [&str; 4] = ["--sweep", "20-100", "--growth", "2"];

fn scratch(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("resonance");
    std::fs::create_dir_all(&place).unwrap();
    place.join(name)
}

fn file(name: &str, text: &str) -> PathBuf {
    let path = scratch(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn swept(name: &str, modes: &[Mode]) -> PathBuf {
    file(name, &text(&recording(modes, &SWEEP, 3200.0, 50.0, 9)))
}

fn resonance(files: &[&Path], words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("resonance").args(files).args(words).output().unwrap()
}

fn said(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

fn json(files: &[&Path], words: &[&str]) -> Value {
    let output = resonance(files, &[words, &["--json", "-"]].concat());
    let (out, err) = said(&output);
    assert!(output.status.success(), "{err}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn a_sweep_becomes_modes_two_rankings_a_line_and_a_page() {
    let (x, page) = (swept("raw_data_x_20260101.csv", &[(48.6, 0.06, 1.0)]), scratch("x.html"));
    let answer = json(&[&x], &[&SWEPT[..], &["--report", page.to_str().unwrap()]].concat());
    let axis = &answer["axes"][0];
    assert_eq!(axis["axis"], "X");
    let mode = &axis["recordings"][0]["fit"]["modes"][0];
    assert!((mode["frequency_Hz"].as_f64().unwrap() / 48.6 - 1.0).abs() < 0.005, "{mode}");
    assert!((mode["damping_ratio"].as_f64().unwrap() / 0.06 - 1.0).abs() < 0.1, "{mode}");
    assert_eq!(axis["klipper"]["suggestion"]["shaper"], "MZV");
    assert_eq!(axis["klipper"]["shapers"].as_array().unwrap().len(), 6);
    let tool = &axis["tool"];
    assert!(tool["shapers"].as_array().unwrap().iter().all(|s| s["in_firmware"] == true), "{tool}");
    assert!(tool["nearest"]["worst_wall"]["rms_um"].as_f64().unwrap() > 0.0, "{tool}");
    let line = axis["suggestion"]["line"].as_str().unwrap();
    assert!(line.starts_with("M593 X F") && line.ends_with(" D0.100 T2"), "{line}");
    let html = std::fs::read_to_string(page).unwrap();
    assert!(html.contains(line) && html.contains("prefers-color-scheme") && html.ends_with("</html>\n"));
    // The table for people has the line too, and marks what the firmware lacks.
    let (out, _) = said(&resonance(&[&x], &SWEPT));
    assert!(out.contains(line) && out.contains("(not in this firmware)") && out.contains("one mode only"), "{out}");
}

/// The line is taken by the firmware as it is printed.
#[test]
fn the_firmware_takes_the_line() {
    let y = swept("raw_data_y.csv", &[(60.0, 0.05, 1.0)]);
    let answer = json(&[&y], &SWEPT);
    let line = answer["axes"][0]["suggestion"]["line"].as_str().unwrap().to_owned();
    let gcode = file("line.gcode", &format!("{line}\nG1 X101 F600\n"));
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    let run = run.arg("run").arg(gcode).args(["--assume-homed", "100,100,1"]).output().unwrap();
    let (out, err) = said(&run);
    assert!(run.status.success() && !out.contains("ignored") && !err.contains("ignored"), "{line}: {out}{err}");
}

#[test]
fn a_name_without_an_axis_asks_for_it() {
    let plain = swept("sweep.csv", &[(48.6, 0.06, 1.0)]);
    let (out, _) = said(&resonance(&[&plain], &SWEPT));
    assert!(out.contains("give --axis") && !out.contains("M593"), "{out}");
    let (out, _) = said(&resonance(&[&plain], &[&SWEPT[..], &["--axis", "y"]].concat()));
    assert!(out.contains("M593 Y F"), "{out}");
    // Names that tell the axis keep it.
    let x = swept("raw_data_x_named.csv", &[(48.6, 0.06, 1.0)]);
    let (out, _) = said(&resonance(&[&plain, &x], &[&SWEPT[..], &["--axis", "y"]].concat()));
    assert!(out.contains("M593 X F") && out.contains("M593 Y F"), "{out}");
    // The default sweep is longer, which is remarked.
    let (out, _) = said(&resonance(&[&plain], &["--axis", "y"]));
    assert!(out.contains("it lasts 40 s, a sweep from 5 to 135 Hz 130 s"), "{out}");
}

/// A frame of zstd (RFC 8878) with one raw block.
fn packed(line: &str) -> Vec<u8> {
    let block = (1 | (line.len() as u32) << 3).to_le_bytes();
    [&b"\x28\xb5\x2f\xfd\0\x58"[..], &block[..3], line.as_bytes()].concat()
}

#[test]
fn a_short_run_of_an_stdata_is_a_remark() {
    let short = packed(
        "{\"name\": \"vib_an0_00sp300_00n1\", \"samples\": [[0, 1, 2, 3], [0.001, 2, 2, 3], [0.002, 1, 2, 3]]}\n",
    );
    let runs = include_bytes!("../../resonance/tests/files/two_runs.stdata");
    let (path, alone) = (scratch("with_short.stdata"), scratch("short.stdata"));
    std::fs::write(&path, [&short[..], runs].concat()).unwrap();
    std::fs::write(&alone, &short).unwrap();
    let answer = json(&[&path], &[]);
    assert_eq!(answer["profile"]["runs"].as_array().unwrap().len(), 2, "{answer}");
    assert!(answer["left_out"][0].as_str().unwrap().starts_with("with_short.stdata: vib_an0_00sp300_00n1: it lasts"));
    let (out, _) = said(&resonance(&[&path], &[]));
    assert!(out.contains("remark: left out, with_short.stdata: vib_an0"), "{out}");
    let refused = resonance(&[&alone], &[]);
    assert!(!refused.status.success() && said(&refused).1.contains("it lasts 0.00 s"));
}

#[test]
fn a_calibration_of_the_sensor_is_refused_in_words() {
    let map = swept("axesmap_20260101_X.csv", &[(48.6, 0.06, 1.0)]);
    for words in [&SWEPT[..], &[&SWEPT[..], &["--axis", "x"]].concat()] {
        let refused = resonance(&[&map], words);
        assert!(!refused.status.success() && said(&refused).1.contains("calibration of the sensor's axes"));
    }
}

#[test]
fn two_belt_paths_are_compared() {
    let a = swept("raw_data_axis=1.000,-1.000_a.csv", &[(60.0, 0.05, 1.0)]);
    let b = swept("raw_data_axis=1.000,1.000_b.csv", &[(66.0, 0.05, 1.0)]);
    let answer = json(&[&b, &a], &SWEPT);
    let belts = &answer["belts"]["comparison"];
    assert!(answer["axes"].as_array().unwrap().is_empty());
    assert!((belts["frequency_difference_percent"].as_f64().unwrap() + 9.1).abs() < 0.5, "{belts}");
    assert!(belts["verdict"].as_str().unwrap().starts_with("Path A rings 9."), "{belts}");
    assert!(belts["similarity_percent"].as_f64().unwrap() < 95.0, "{belts}");
    let page = scratch("belts.html");
    assert!(resonance(&[&a, &b], &[&SWEPT[..], &["--report", page.to_str().unwrap()]].concat()).status.success());
    let refused = resonance(&[&a, &a, &b], &SWEPT);
    assert!(!refused.status.success() && said(&refused).1.contains("one recording of each belt path"));
}

#[test]
fn runs_become_a_profile() {
    let run = |angle: u32, speed: u32| {
        let (f, mut noise) = (f64::from(speed) / 2.0, Noise(u64::from(angle + speed)));
        let gain = 1.0 / ((1.0 - (f / 60.0).powi(2)).powi(2) + (0.1 * f / 60.0).powi(2)).sqrt();
        let x = (0..4000).map(|i| 100.0 * gain * (TAU * f * f64::from(i) / 3200.0).sin() + noise.normal()).collect();
        let still: Vec<f64> = (0..4000).map(|_| noise.normal()).collect();
        let recording = Recording { rate_hz: 3200.0, axes: [x, still.clone(), still], remarks: Vec::new() };
        file(&format!("vib_an{angle}_00sp{speed}_00n1.csv"), &text(&recording))
    };
    let files: Vec<PathBuf> =
        [0, 45].into_iter().flat_map(|a| (60..=180).step_by(20).map(move |s| run(a, s))).collect();
    let files: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let page = scratch("profile.html");
    let answer = json(&files, &["--report", page.to_str().unwrap()]);
    let profile = &answer["profile"];
    assert_eq!(profile["angles_deg"], serde_json::json!([0.0, 45.0]));
    assert!(profile["loud_mm_s"].as_array().unwrap().contains(&120.0.into()), "{profile}");
    assert_eq!(profile["runs"].as_array().unwrap().len(), 14);
    let (out, _) = said(&resonance(&files, &[]));
    assert!(out.contains("120.0 mm/s") && out.contains("loud"), "{out}");
}

/// Motors of one side are twice as loud as those of the other, once an electrical turn, and the tool rings at 60 Hz.
#[test]
fn runs_along_both_diagonals_tell_the_motors_and_the_symmetry() {
    let run = |angle: u32, speed: f64| {
        // Electrical turns of 0.8 mm of belt, and the belt runs by 2^(1/2) of the tool's way: amplitudes of 4 and 2 um.
        let (hz, mm) = (std::f64::consts::SQRT_2 * speed / 0.8, if angle == 45 { 0.004 } else { 0.002 });
        let gain = 1.0 / ((1.0 - (hz / 60.0).powi(2)).powi(2) + (0.1 * hz / 60.0).powi(2)).sqrt();
        let w = TAU * hz;
        let x = (0..2000).map(|i| mm * gain * w * w * (w * f64::from(i) / 1600.0).sin()).collect();
        let still = vec![0.0; 2000];
        let recording = Recording { rate_hz: 1600.0, axes: [x, still.clone(), still], remarks: Vec::new() };
        file(&format!("motors_an{angle}_00sp{speed:.0}_00n1.csv"), &text(&recording))
    };
    let speeds = || (16..=60).step_by(2).map(f64::from);
    let files: Vec<PathBuf> = [45, 135].into_iter().flat_map(|angle| speeds().map(move |v| run(angle, v))).collect();
    let files: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let page = scratch("motors.html");
    let profile = &json(&files, &["--report", page.to_str().unwrap()])["profile"];
    let symmetry = &profile["symmetry"];
    // 1 - (2 - 1) / (2 + 1), and 20 log 2.
    assert!((symmetry["symmetry_percent"].as_f64().unwrap() - 66.7).abs() < 0.5, "{symmetry}");
    assert!((symmetry["level_difference_dB"].as_f64().unwrap() - 6.02).abs() < 0.05, "{symmetry}");
    for (side, um) in [(0, 4.0), (1, 2.0)] {
        let motors = &profile["motors"][side];
        let mode = &motors["modes"][0];
        assert!((mode["frequency_Hz"].as_f64().unwrap() / 60.0 - 1.0).abs() < 0.005, "{motors}");
        assert!((mode["damping_ratio"].as_f64().unwrap() / 0.05 - 1.0).abs() < 0.1, "{motors}");
        assert_eq!(motors["orders"][0]["repeats"], "electrical_turn");
        assert!((motors["orders"][0]["slow_um"].as_f64().unwrap() / um - 1.0).abs() < 0.1, "{motors}");
    }
    let (out, _) = said(&resonance(&files, &[]));
    assert!(out.contains("mirror each other: 67 %") && out.contains("electrical turns: at most"), "{out}");
    // On a Cartesian machine both motors turn along a diagonal.
    let cartesian = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machines/cartesian.toml");
    let profile = &json(&files, &["--machine", cartesian])["profile"];
    assert!(profile["motors"].as_array().unwrap().is_empty() && !profile["symmetry"].is_null(), "{profile}");
}

/// The firmware's own steps swing the tool as often as the sweep says, and end where they began.
#[test]
fn a_sweep_as_g_code_shakes_the_simulated_machine() {
    let (gcode, trace) = (scratch("sweep.gcode"), scratch("steps.csv"));
    let words = ["sweep", "--axis", "x", "--at", "150,150", "--sweep", "10-60", "--growth", "10", "-o"];
    let made = resonance(&[], &[&words[..], &[gcode.to_str().unwrap()]].concat());
    assert!(made.status.success() && said(&made).1.contains("mm/s2: M201 must allow that"), "{:?}", said(&made));
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    run.arg("run").arg(&gcode).args(["--assume-homed", "150,150,1", "--trace"]).arg(&trace);
    let (out, err) = said(&run.output().unwrap());
    assert!(!out.contains("ignored") && !err.contains("ignored"), "{out}{err}");
    let trace = std::fs::read_to_string(trace).unwrap();
    let ticks: Vec<f64> = trace.lines().filter_map(|line| line.split(',').next()?.parse().ok()).collect();
    let lasts = (ticks[ticks.len() - 1] - ticks[0]) / 1e7;
    assert!((lasts / 5.0 - 1.0).abs() < 0.02, "the sweep lasts {lasts} s");
    let refused = resonance(&[], &["sweep", "--axis", "z", "--at", "1,1", "-o", "-"]);
    assert!(!refused.status.success() && said(&refused).1.contains("z is not swept"));
}

#[test]
fn bad_input_is_answered_with_its_file_and_line() {
    let header = "#time,accel_x,accel_y,accel_z\n";
    for (name, text, known) in [
        ("empty.csv", String::new(), "the file is empty"),
        ("none.csv", header.to_owned(), "no samples"),
        ("psd.csv", "freq,psd_x,psd_y,psd_z,psd_xyz\n".to_owned(), "the frequencies of this spectrum are too few"),
        ("columns.csv", format!("{header}0,1,2\n"), "line 2: expected 4 columns, found 3"),
        ("nan.csv", format!("{header}0,1,nan,2\r\n"), "line 2: `nan` is not a number"),
        ("back.csv", format!("{header}1,1,1,2\n0.5,1,1,2\n"), "line 3: time does not grow"),
        ("words.csv", "hello\n".to_owned(), "expected the header"),
    ] {
        let output = resonance(&[&file(name, &text)], &[]);
        let (_, err) = said(&output);
        assert_eq!(output.status.code(), Some(2), "{err}");
        assert!(err.contains(known) && err.contains(name), "{name}: {err}");
    }
    let missing = resonance(&[Path::new("/nonexistent/x.csv")], &[]);
    assert!(missing.status.code() == Some(2) && said(&missing).1.contains("cannot read /nonexistent/x.csv"));
    for (words, known) in [
        (&["--sweep", "5"][..], "is no range like 5-135"),
        (&["--axis", "q"], "is no axis"),
        (&["--uncertainty", "70"], "not a number from 0 to 50"),
    ] {
        let refused = resonance(&[Path::new("x.csv")], words);
        assert!(refused.status.code() == Some(2) && said(&refused).1.contains(known), "{:?}", said(&refused));
    }
    let none = resonance(&[], &[]);
    assert_eq!(none.status.code(), Some(2));
}
