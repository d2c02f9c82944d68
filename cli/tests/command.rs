//! The `corehbot` command as a user sees it: files in, files out, and the exit status.

mod accidents;
mod belt;
mod klipper_words;

use corehbot::connectors::BoardConnectors;
use corehbot::storage::{BLOCK, blank_block, machine_of};
use corehbot_boards::{nucleo, octopus};
use corehbot_machine_file as machine_file;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn corehbot() -> Command {
    Command::new(env!("CARGO_BIN_EXE_corehbot"))
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

/// A place for one test's files.
fn scratch(test: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn print_text(gcode: &str) -> Output {
    let mut child = corehbot()
        .args(["run", "-", "--assume-homed", "0,0,0"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(gcode.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn a_print_leaves_a_trace_a_summary_and_a_report() {
    let place = scratch("outputs");
    let [trace, vcd, json, report] = ["t.csv", "t.vcd", "s.json", "r.html"].map(|name| place.join(name));
    let output = corehbot()
        .arg("run")
        .arg(example("axes.gcode"))
        .arg("--trace")
        .arg(&trace)
        .arg("--vcd")
        .arg(&vcd)
        .arg("--json")
        .arg(&json)
        .arg("--report")
        .arg(&report)
        .arg("--machine")
        .arg(example("machines/prototype.toml"))
        .output()
        .unwrap();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{out}{err}");
    assert!(out.contains("trace sha256") && err.is_empty(), "{err}");

    let summary: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    for key in [
        "lines",
        "commands",
        "moves",
        "print_time_s",
        "motion_time_s",
        "heating_time_s",
        "waiting_time_s",
        "path_mm",
        "steps",
        "peak_speed_mm_s",
        "peak_event_rate_hz",
        "underruns",
        "events",
        "trace_sha256",
        "look_ahead_low_water",
        "warnings",
    ] {
        assert!(summary.get(key).is_some(), "{key}");
    }
    let csv = std::fs::read_to_string(trace).unwrap();
    let mut rows = csv.lines();
    let first = "# corehbot-trace v1 tick_hz=10000000 kinematics=corehbot steps_per_mm=80/800/400";
    assert_eq!(rows.next(), Some(first));
    assert_eq!(rows.next(), Some("tick,m1,m4,m8,m11,z1,z2,e0"));
    assert_eq!(rows.count() as u64, summary["events"].as_u64().unwrap());
    for motor in ["m1", "m4", "m8", "m11", "z1", "z2", "e0"] {
        assert!(summary["steps"][motor].as_u64().unwrap() > 0, "{motor} never moved");
    }
    assert!(std::fs::read_to_string(vcd).unwrap().contains("$timescale 100 ns $end"));
    assert!(std::fs::read_to_string(report).unwrap().contains("axes.gcode"));
}

#[test]
fn a_summary_has_the_motors_that_there_are() {
    let (circle, machine) = (example("circle.gcode"), example("machines/cartesian.toml"));
    let output = corehbot().args(["run", "--json", "-", "--machine"]).arg(machine).arg(circle).output().unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for list in ["steps", "net_steps"] {
        let names: Vec<_> = summary[list].as_object().unwrap().keys().collect();
        assert_eq!(names, ["e0", "m1", "m4", "z1", "z2"], "{list}");
    }
    assert!(!String::from_utf8(output.stderr).unwrap().contains("\nm8 "));
}

#[test]
fn every_example_prints_without_a_remark() {
    let place = scratch("examples");
    let mut printed = 0;
    for entry in std::fs::read_dir(example("")).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_none_or(|e| e != "gcode") {
            continue;
        }
        let json = place.join("summary.json");
        let output = corehbot().arg("run").arg(&file).arg("--json").arg(&json).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}: {}", file.display(), text(&output.stdout));
        let summary: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
        // The prototype has no heaters, and the first print heats as a sliced file does.
        let warnings = u32::from(file.ends_with("first-print.gcode"));
        assert_eq!(summary["warnings_total"], warnings, "{}: {summary}", file.display());
        assert_eq!(summary["underruns"], 0, "{}", file.display());
        let is_small = summary["events"].as_u64().unwrap() < 300_000;
        assert!(is_small || file.ends_with("first-print.gcode"), "{}", file.display());
        printed += 1;
    }
    assert!(printed >= 13);
}

/// Reproducer: a print that asked a cold hotend for filament, and got nothing, was `ok`.
#[test]
fn filament_that_was_asked_for_and_did_not_move_is_a_failure() {
    let told = |gcode: &str| {
        let output = heat_text("no-filament", gcode, &[]);
        (output.status.code(), text(&output.stdout))
    };
    let (status, said) = told("G28\nG1 X20 E2 F3000\nG1 X40 E4\n");
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("failed: ") && said.contains("the hotend is too cold"), "{said}");
    // The extruder alone is no print: the line is left out, and the file has pushed nothing.
    let (status, said) = told("G28\nG1 E5 F300\n");
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("filament was commanded, but none moved: was the hotend cold?"), "{said}");
    for gcode in [
        "G28\nM302 P1\nG1 X20 E2 F3000\n",
        "G28\nG92 E5\nG1 X20 E-0.5 F3000\n",
        "G28\nM111 S8\nG1 X20 E2 F3000\n",
        "G28\nG1 X20 F3000\n",
    ] {
        let (status, said) = told(gcode);
        assert_eq!(status, Some(0), "{gcode}: {said}");
    }
}

#[test]
fn heat_that_no_heater_makes_is_counted_and_told_once() {
    let file = scratch("no-heaters").join("h.gcode");
    let lines = "M140 S60\nM104 S215\nM190 S60\nM109 R215\n";
    std::fs::write(&file, format!("{}G28\nG1 X20 F3000\nM104 S0\nM140 S0\n", lines.repeat(3))).unwrap();
    let output = corehbot().arg("run").arg(&file).output().unwrap();
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains(": 12 heating commands ignored: no heater fitted, see [heaters]"), "{said}");
    assert!(said.contains("warnings: 1\n"), "{said}");
}

#[test]
fn the_time_of_a_print_is_all_of_it_and_its_parts_are_told() {
    let json = scratch("times").join("t.json");
    let gcode = "G28\nM109 S60\nG1 X100 F6000\nM400\nM0 Take it\nG1 X0\n";
    let output = heat_text("times", gcode, &["--json", json.to_str().unwrap()]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let summary: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    let [whole, motion, heating, waiting] =
        ["print_time_s", "motion_time_s", "heating_time_s", "waiting_time_s"].map(|key| summary[key].as_f64().unwrap());
    assert!((whole - motion - heating - waiting).abs() < 0.01, "{summary}");
    // From 25 to 60 C a hotend takes seconds, and holds for 3 s; the user takes 5 s.
    assert!(heating > 5.0 && (5.0..9.0).contains(&waiting) && motion > 3.0, "{summary}");
    assert!(said.contains(&format!("motion {motion:.3} s, heat {heating:.3} s, waits {waiting:.3} s")), "{said}");
}

#[test]
fn a_line_of_a_megabyte_is_not_printed_whole() {
    let place = scratch("megabyte");
    let (file, machine) = (place.join("m.gcode"), place.join("m.toml"));
    let long = "x".repeat(1_000_000);
    std::fs::write(&file, format!("G28\nFOO{long}\nG1 X20 F3000\n")).unwrap();
    let output = corehbot().arg("run").arg(&file).output().unwrap();
    assert!(output.stdout.len() + output.stderr.len() < 4_000, "{} bytes", output.stdout.len());
    assert!(text(&output.stdout).contains("... (1000003 bytes): echo:"), "{}", text(&output.stdout));
    for wrong in [
        format!("name = \"{long}\""),
        format!("{long} = 5"),
        format!("[motors]\nm1 = \"{long}\""),
        format!("board = \"{long}\""),
    ] {
        std::fs::write(&machine, wrong).unwrap();
        for command in [["config", "check"], ["run", "--machine"]] {
            let mut said = corehbot();
            said.args(command).arg(&machine);
            if command[0] == "run" {
                said.arg(example("axes.gcode"));
            }
            let output = said.output().unwrap();
            assert_ne!(output.status.code(), Some(0));
            assert!(output.stdout.len() + output.stderr.len() < 4_000, "{command:?}: {}", output.stdout.len());
        }
    }
}

/// Prints text on a machine with a hotend of 40 W.
fn heat_text(test: &str, gcode: &str, args: &[&str]) -> Output {
    let place = scratch(test);
    let (file, machine) = (place.join("h.gcode"), place.join("m.toml"));
    std::fs::write(&file, gcode).unwrap();
    std::fs::write(&machine, "[heaters.hotend]\nis_fitted = true\n").unwrap();
    corehbot().arg("run").arg(file).arg("--machine").arg(machine).args(args).output().unwrap()
}

#[test]
fn heaters_break_when_they_are_told_to() {
    let gcode = "G28\nM109 S200\nG4 S60\n";
    let whole = heat_text("break", gcode, &[]);
    assert_eq!(whole.status.code(), Some(0), "{}", text(&whole.stdout));
    let json = scratch("break").join("s.json");
    for (accident, cause, at, line) in
        [("open:hotend@20s", "E01", 20.0, 2), ("short@1.5m", "E02", 90.0, 2), ("converter@30s", "E14", 30.0, 2)]
    {
        let output = heat_text("break", gcode, &["--break", accident, "--json", json.to_str().unwrap()]);
        let out = text(&output.stdout);
        assert_eq!((output.status.code(), out.contains(&format!("[{cause}]"))), (Some(1), true), "{accident}: {out}");
        let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        let fault = &summary["fault"];
        assert_eq!(
            (fault["code"].as_str(), fault["page"].as_str()),
            (Some(cause), Some("docs/reference/errors.md#faults"))
        );
        // Guards wait for a second or two before they believe it.
        let late = fault["time_s"].as_f64().unwrap() - at;
        assert!((0.0..5.0).contains(&late), "{accident}: {fault}");
        assert!(
            fault["cure"].as_str().is_some_and(|cure| !cure.is_empty()) && fault["line"].as_u64() <= Some(line + 1)
        );
    }
    let wrong = heat_text("break", gcode, &["--break", "opne@20s"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        text(&wrong.stderr).contains("`opne` is not an accident; expected open, short, "),
        "{}",
        text(&wrong.stderr)
    );
    let missing = heat_text("break", gcode, &["--break", "open:bed@20s"]);
    assert!(text(&missing.stderr).contains("heaters.bed.is_fitted = true"), "{}", text(&missing.stderr));
}

#[test]
fn heaters_are_what_a_file_says() {
    let place = scratch("plant-heat");
    let truth = place.join("h.toml");
    let heated = |toml: &str| {
        std::fs::write(&truth, toml).unwrap();
        let args = ["--plant-heat", truth.to_str().unwrap()];
        let output = heat_text("plant-heat", "G28\nM109 S150\nM104 S0\n", &args);
        let out = text(&output.stdout);
        (output.status.code(), text(&output.stderr), out)
    };
    let (status, _, out) = heated("[hotend]\ncapacity = 12\n");
    assert_eq!(status, Some(0), "{out}");
    // No block is so heavy; the firmware finds a plant that is not its own.
    let (status, _, out) = heated("[hotend]\ncapacity = 200\n");
    assert_eq!((status, out.contains("[E08]")), (Some(1), true), "{out}");
    let (status, err, _) = heated("[hotend]\ncapacity = -12\n");
    assert_eq!(status, Some(2));
    assert!(err.contains("2:12: hotend.capacity = -12 is outside 1 to 100000 J/K"), "{err}");
    let bare = corehbot().arg("run").arg(example("axes.gcode")).arg("--plant-heat").arg(&truth).output().unwrap();
    assert!(text(&bare.stderr).contains("the machine has no heater; fit one"), "{}", text(&bare.stderr));
}

#[test]
fn the_same_file_gives_the_same_trace() {
    let digest = || {
        let output = corehbot().arg("run").arg(example("circle.gcode")).output().unwrap();
        text(&output.stdout).lines().find(|l| l.starts_with("trace sha256")).unwrap().to_owned()
    };
    assert_eq!(digest(), digest());
}

#[test]
fn settings_survive_in_an_image_file() {
    let place = scratch("storage");
    let image = place.join("eeprom.bin");
    let _ = std::fs::remove_file(&image);
    let run = |gcode: &str| {
        let file = place.join("print.gcode");
        std::fs::write(&file, gcode).unwrap();
        let output = corehbot().arg("run").arg(&file).arg("--storage").arg(&image).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}{}", text(&output.stdout), text(&output.stderr));
        text(&output.stdout)
    };
    let hurry = "G28\nG1 X300 F24000\n";
    let slow = run(hurry);
    assert_eq!(std::fs::metadata(&image).unwrap().len(), 4096);
    run("M203 X400\nM500\nG28\n");
    // The stored limit lets the same print go faster, and the checker knows it.
    let fast = run(hurry);
    assert_ne!(slow.lines().find(|l| l.contains("sha256")), fast.lines().find(|l| l.contains("sha256")));
    assert!(!fast.contains("echo:"), "{fast}");
    let lonely = print_text("M500\n");
    assert!(text(&lonely.stdout).contains("M500: echo:Settings not stored: no storage"), "{}", text(&lonely.stdout));
}

#[test]
fn a_print_that_halts_is_status_1_and_names_the_line() {
    let output = print_text("G1 X5 F3000\n\nM112\nG1 X0\n");
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("failed: stdin:3: M112: "), "{}", text(&output.stdout));
}

#[test]
fn an_unknown_command_is_a_warning_with_its_line() {
    let output = print_text("G1 X5 F3000\nM9999\n");
    assert_eq!(output.status.code(), Some(0));
    assert!(text(&output.stdout).contains("stdin:2: M9999: echo:Unknown command"), "{}", text(&output.stdout));
}

#[test]
fn what_cannot_be_printed_is_status_2_and_says_why() {
    let place = scratch("unusable");
    let machine = place.join("bad.toml");
    std::fs::write(&machine, "[axes.x]\nmax_speed = 5000\n").unwrap();
    let image = place.join("short.bin");
    std::fs::write(&image, [0; 100]).unwrap();
    let axes = example("axes.gcode");
    let axes = axes.to_str().unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&["run", "no-such.gcode"], "corehbot: cannot open no-such.gcode"),
        (&["run", axes, "--machine", "no-such.toml"], "corehbot: cannot open no-such.toml"),
        (
            &["run", axes, "--machine", machine.to_str().unwrap()],
            "bad.toml:2:13: axes.x.max_speed = 5000 is outside 0.01 to 3000",
        ),
        (&["run", axes, "--assume-homed", "1,2"], "three numbers"),
        (&["run", axes, "--storage", image.to_str().unwrap()], "is not an image of an EEPROM"),
        (&["run", axes, "--storage", "/no/such/place.bin"], "corehbot: cannot create /no/such/place.bin"),
        (&["run", axes, "--trace", "/no/such/place.csv"], "corehbot: cannot create /no/such/place.csv"),
        (&["run", axes, "--nonsense"], "--nonsense"),
    ];
    for (args, message) in cases {
        let output = corehbot().args(args).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(text(&output.stderr).contains(message), "{args:?}: {}", text(&output.stderr));
    }
}

/// An image as a build leaves it: something round a block that says which board it is for.
fn blank_image(place: &Path, board: &BoardConnectors) -> PathBuf {
    let path = place.join(format!("{}.bin", board.key));
    std::fs::write(&path, [&[7; 300][..], &blank_block(&[board]), &[9; 100]].concat()).unwrap();
    path
}

#[test]
fn an_image_gets_the_machine_of_a_file() {
    let place = scratch("image");
    let (blank, made) = (blank_image(&place, &octopus::CONNECTORS), place.join("firmware.bin"));
    let machine = example("machines/corexy.toml");
    let run = |args: &[&Path]| {
        let output = corehbot().arg("image").args(args).output().unwrap();
        (output.status.code().unwrap(), text(&output.stdout) + &text(&output.stderr))
    };
    let [from, with, to] = ["--from", "--machine", "-o"].map(Path::new);
    let (status, said) = run(&[from, &blank, with, &machine, to, &made]);
    assert!(status == 0 && said.contains("for the board octopus, CoreXY ("), "{status} {said}");
    let (before, after) = (std::fs::read(&blank).unwrap(), std::fs::read(&made).unwrap());
    assert_eq!(before.len(), after.len());
    let block = after[300..300 + BLOCK].try_into().unwrap();
    assert_eq!(machine_of(block), Ok(machine_file::read(&machine).unwrap().settings));
    assert!(before[..396] == after[..396] && before[300 + BLOCK..] == after[300 + BLOCK..]);
    // An image that has a machine may get another one, and one without a machine is a copy.
    let again = place.join("again.bin");
    assert_eq!(run(&[from, &made, with, &example("machines/hbot.toml"), to, &again]).0, 0);
    assert_eq!(run(&[from, &blank, to, &again]).0, 0);
    assert_eq!(std::fs::read(&again).unwrap(), before);
}

#[test]
fn no_image_is_made_of_what_is_none() {
    let place = scratch("no-image");
    let (blank, made) = (blank_image(&place, &nucleo::CONNECTORS), place.join("firmware.bin"));
    let wrong = |args: &[&str]| {
        let output = corehbot().arg("image").args(args).args(["-o", made.to_str().unwrap()]).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(!made.exists());
        text(&output.stderr)
    };
    let blank = blank.to_str().unwrap();
    let file = place.join("m.toml");
    std::fs::write(&file, "board = \"octopus\"\n[motors]\nm1 = \"M3\"\nm11 = \"M0\"\n").unwrap();
    let file = file.to_str().unwrap();
    let keys: Vec<_> = corehbot_boards::entries().map(|entry| entry.board.connectors.key).collect();
    let no_board = format!("no board is called printer: {}", keys.join(", "));
    for (args, told) in [
        (&["--from", blank, "--machine", file][..], "motor m1: the CNC shield has no connector M3"),
        (&["--from", blank, "--board", "octopus"], "an image for nucleo, not for octopus"),
        (&["--from", file], "not an image of this firmware"),
        (&["--board", "printer"], no_board.as_str()),
        (&["--board", "nucleo"], "name an image with --from"),
        (&[], "--board"),
        (&["--from", blank, "--machine", "nothing.toml"], "cannot open nothing.toml"),
    ] {
        let said = wrong(args);
        assert!(said.contains(told), "{args:?}: {said}");
    }
}
