//! Files of the `corehbot` command: inputs that are read or refused, and the files left when a run ends early.

use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn corehbot() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    command.arg("run");
    command
}

/// An empty place for one test's files.
fn scratch(test: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("files").join(test);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    place
}

fn print(gcode: &[u8], args: &[&str]) -> Output {
    let mut child = corehbot()
        .args(["-", "--assume-homed", "100,100,1"])
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(gcode).unwrap();
    child.wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn waits_for_a_user_are_answered_and_reported() {
    let place = scratch("pauses");
    let json = place.join("s.json");
    let gcode = b"G1 X110 F6000\nM0 Take it off\nG1 X120\nM600\nG1 X130\nM601\nM1\nM0 S2\nG1 X140\n";
    let output = print(gcode, &["--json", json.to_str().unwrap()]);
    let out = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{out}{}", text(&output.stderr));
    for line in ["stdin:2: M0 Take it off", "stdin:4: M600", "stdin:6: M601", "stdin:7: M1"] {
        assert!(out.contains(&format!("{line}: went on by itself after 5 s (M108)")), "{out}");
    }
    assert!(out.contains("pauses: 4") && !out.contains("M0 S2"), "{out}");
    let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
    assert_eq!((&summary["pauses_total"], &summary["commands"]), (&4.into(), &9.into()));
    // All 40 mm were moved.
    assert_eq!(summary["net_steps"]["m8"], 3200);
}

#[test]
fn nothing_printed_is_a_failure() {
    for (gcode, why) in [
        ("", "the file holds no commands"),
        ("; only words\n\n", "the file holds no commands"),
        ("Dear printer,\nplease print.\n", "no motor made a step"),
    ] {
        let output = print(gcode.as_bytes(), &[]);
        assert_eq!(output.status.code(), Some(1), "{gcode}");
        assert!(text(&output.stdout).contains(&format!("failed: nothing was printed: {why}")), "{gcode}");
    }
}

#[test]
fn an_output_may_go_to_standard_output() {
    let output = print(b"G1 X100.1 F600\n", &["--trace", "-"]);
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert!(out.starts_with("# corehbot-trace v1") && out.lines().count() == 2 + 8, "{out}");
    assert!(err.contains("trace sha256"), "{err}");
    let output = print(b"G1 X101 F600\n", &["--json", "-"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["ok"], true);
    let output = print(b"G1 X101 F600\n", &["--json", "-", "--vcd", "-"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("only one output"), "{}", text(&output.stderr));
}

#[test]
fn a_reader_that_has_read_enough_ends_the_run() {
    let mut child = corehbot()
        .args(["-", "--assume-homed", "100,100,1", "--trace", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all("G1 X200 F6000\nG1 X100\n".repeat(2000).as_bytes()).unwrap();
    let mut begin = [0; 100];
    child.stdout.take().unwrap().read_exact(&mut begin).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(128 + 13));
}

/// Reports that the disk is full at the first byte; it is written while the print goes on, or at its end. Each line
/// makes 8,000 rows, far more than a writer's buffer.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_in_an_error_that_says_so() {
    for (option, what) in [("--trace", "the trace"), ("--vcd", "the VCD file")] {
        for moves in [1, 50] {
            let gcode = "G1 X200 F6000\nG1 X100\n".repeat(moves);
            let output = print(gcode.as_bytes(), &[option, "/dev/full"]);
            let err = text(&output.stderr);
            assert_eq!(output.status.code(), Some(1), "{err}");
            assert!(err.contains(&format!("cannot write {what}")) && err.contains("No space left"), "{err}");
        }
    }
}

#[test]
fn an_output_never_is_an_input_or_another_output() {
    let place = scratch("same");
    let path = |name: &str| place.join(name).to_str().unwrap().to_owned();
    let (gcode, machine) = (path("in.gcode"), path("m.toml"));
    std::fs::write(&gcode, "G1 X101 F600\n").unwrap();
    std::fs::write(&machine, "").unwrap();
    std::fs::hard_link(&gcode, path("hard")).unwrap();
    let (hard, other) = (path("hard"), path("other"));
    let cases: [&[&str]; 5] = [
        &["--trace", &gcode],
        &["--json", &hard],
        &["--report", &machine],
        &["--trace", &other, "--vcd", &other],
        &["--storage", &other, "--json", &other],
    ];
    for args in cases {
        let output = corehbot().arg(&gcode).args(["--machine", &machine]).args(args).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert_eq!(std::fs::read(&gcode).unwrap(), b"G1 X101 F600\n", "{args:?}");
    }
    let left = names(&place);
    assert!(!left.iter().any(|name| name.ends_with("partial")), "{left:?}");
}

#[test]
fn what_is_no_gcode_is_refused_in_one_line_and_leaves_nothing() {
    let place = scratch("binary");
    for (bytes, way_out) in [
        (&b"GCDE\x01\0\0\0\x01\0"[..], "no block of G-code"),
        (b"PK\x03\x04\x14\0\0\0", "no whole ZIP archive"),
        (b"\x1f\x8b\x08\0\0\0\0\0", "its end is missing"),
        (b"\xff\xfeG\x002\x008\x00", "iconv -f UTF-16"),
        (b"G28\nG1 \0\n", "binary data"),
    ] {
        let output = print(bytes, &["--trace", place.join("t.csv").to_str().unwrap()]);
        let err = text(&output.stderr);
        assert_eq!((output.status.code(), err.lines().count()), (Some(2), 1), "{err}");
        assert!(err.contains(way_out), "{err}");
        assert!(names(&place).is_empty(), "{:?}", names(&place));
    }
}

#[test]
fn a_file_in_place_of_a_command_is_told_with_its_command() {
    let place = scratch("no_command");
    for (text, words) in [
        ("G28\nG1 X5\n", "x.gcode is G-code: `corehbot run "),
        ("[printer]\nkinematics: none\n", "x.gcode is Klipper's printer.cfg: `corehbot config from "),
    ] {
        let path = place.join("x.gcode");
        std::fs::write(&path, text).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_corehbot")).arg(&path).output().unwrap();
        let told = text_of(&output);
        assert!(output.status.code() == Some(2) && told.lines().count() == 1, "{told}");
        assert!(told.contains(&format!("{words}{}`", path.display())), "{told}");
    }
    let output = Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("prin").output().unwrap();
    assert!(text_of(&output).contains("unrecognized subcommand"), "{}", text_of(&output));
}

fn text_of(output: &Output) -> String {
    text(&output.stderr)
}

/// The step trace of a file, by its SHA-256.
fn digest(file: &Path, args: &[&str]) -> String {
    let output = corehbot().arg(file).args(args).args(["--json", "-"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    summary["trace_sha256"].as_str().unwrap().to_owned()
}

#[test]
fn packed_g_code_makes_the_steps_of_the_plain_one_and_its_report_has_the_text() {
    let place = scratch("packed");
    let plain = include_bytes!("../../examples/tiny.gcode");
    let pack = |text: &[u8]| {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        packed.write_all(text).unwrap();
        packed.finish().unwrap()
    };
    let binary = {
        let mut block = [&1_u16.to_le_bytes()[..], &[0; 2], &(plain.len() as u32).to_le_bytes(), &[0; 2]].concat();
        block.extend(plain);
        [&b"GCDE"[..], &1_u32.to_le_bytes(), &[0; 2], &block].concat()
    };
    let old = text(plain).replace('\n', "\r").into_bytes();
    let [first, second, third, fourth] =
        ["a.gcode", "a.gcode.gz", "a.bgcode", "old.gcode"].map(|name| place.join(name));
    for (path, bytes) in [(&first, &plain.to_vec()), (&second, &pack(plain)), (&third, &binary), (&fourth, &old)] {
        std::fs::write(path, bytes).unwrap();
    }
    let expected = digest(&first, &[]);
    let page = place.join("r.html");
    assert_eq!(digest(&second, &["--report", page.to_str().unwrap()]), expected);
    assert_eq!(digest(&third, &[]), expected);
    assert_eq!(digest(&fourth, &[]), expected);
    // Of the plain file the page says the same, apart from its name and the time.
    let size = std::fs::metadata(&page).unwrap().len();
    digest(&first, &["--report", page.to_str().unwrap()]);
    assert!(size.abs_diff(std::fs::metadata(&page).unwrap().len()) < 100);
    std::fs::write(&second, &pack(plain)[..200]).unwrap();
    let cut = corehbot().arg(&second).output().unwrap();
    let told = text(&cut.stderr);
    assert!(cut.status.code() == Some(2) && told.contains("the file is damaged: its end is missing"), "{told}");
}

#[test]
fn control_bytes_are_never_echoed() {
    let place = scratch("control");
    let file = place.join("evil\x1b[2J.gcode");
    std::fs::write(&file, "G1 X101 F600\nM9999 \x1b]0;owned\x07\nM112 \x1b[31m\n").unwrap();
    let output = corehbot().arg(&file).args(["--assume-homed", "100,100,1"]).output().unwrap();
    let gone = corehbot().arg(place.join("gone\x1b[2J")).output().unwrap();
    let machine = place.join("m.toml");
    std::fs::write(&machine, "\"a\\u001b[2J\" = 1\n").unwrap();
    let refused = corehbot().arg(&file).arg("--machine").arg(&machine).output().unwrap();
    for output in [output, gone, refused] {
        for bytes in [output.stdout, output.stderr] {
            assert!(bytes.iter().all(|byte| *byte == b'\n' || !byte.is_ascii_control()), "{:?}", text(&bytes));
        }
    }
}

/// The emulator does this with `--machine`: a machine stored in the EEPROM of another one is that machine.
#[test]
fn a_stored_machine_prints_as_one_that_was_made_so() {
    let place = scratch("stored");
    let (machine, image, gcode) = (place.join("m.toml"), place.join("e.bin"), place.join("p.gcode"));
    std::fs::write(&machine, "travel_acceleration = 1500\n[axes.x]\nmax_speed = 90\n").unwrap();
    std::fs::write(&gcode, "G28\nG1 X60 Y30 F18000\nG1 X20\n").unwrap();
    let settings = corehbot_machine_file::read(&machine).unwrap().settings;
    let mut eeprom = corehbot_sim::eeprom::Eeprom::blank();
    eeprom.save(&settings).unwrap();
    assert_eq!(eeprom.settings(), Some(settings));
    std::fs::write(&image, eeprom.cells()).unwrap();
    let digest = |args: [&str; 2]| {
        let output = corehbot().arg(&gcode).args(args).output().unwrap();
        let line = text(&output.stdout).lines().find(|line| line.starts_with("trace sha256")).unwrap().to_owned();
        (output.status.code(), line)
    };
    let stored = digest(["--storage", image.to_str().unwrap()]);
    assert_eq!(stored, digest(["--machine", machine.to_str().unwrap()]));
    assert_ne!(stored, digest(["--assume-homed", "0,0,0"]));
}

/// Ctrl-C, as a terminal would send it.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_what_there_is_by_another_name() {
    let place = scratch("interrupted");
    let path = |name: &str| place.join(name);
    std::fs::write(path("long.gcode"), "G1 X200 F6000\nG1 X100\n".repeat(100_000)).unwrap();
    std::fs::write(path("t.csv"), "an older one").unwrap();
    let child = corehbot()
        .arg(path("long.gcode"))
        .args(["--assume-homed", "100,100,1", "--trace"])
        .arg(path("t.csv"))
        .arg("--json")
        .arg(path("s.json"))
        .arg("--report")
        .arg(path("r.html"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The first rows are there, so it is printing.
    while std::fs::metadata(path("t.csv.partial")).map_or(0, |there| there.len()) == 0 {
        std::thread::yield_now();
    }
    let id = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(id, rustix::process::Signal::INT).unwrap();
    let output = child.wait_with_output().unwrap();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(130), "{out}{err}");
    assert!(out.contains("interrupted after ") && err.contains("t.csv.partial"), "{out}{err}");
    let partial = ["long.gcode", "r.html.partial", "s.json.partial", "t.csv", "t.csv.partial"];
    assert_eq!(names(&place), partial);
    assert_eq!(std::fs::read(path("t.csv")).unwrap(), b"an older one");
    let trace = std::fs::read_to_string(path("t.csv.partial")).unwrap();
    assert!(trace.ends_with('\n') && trace.lines().last().unwrap().matches(',').count() == 7, "a whole row");
    let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(path("s.json.partial")).unwrap()).unwrap();
    assert_eq!(summary["ok"], false);
    assert_eq!(summary["events"], trace.lines().count() - 2);
}

/// Address space is limited to less than the file has.
#[cfg(target_os = "linux")]
#[test]
fn a_file_larger_than_the_memory_is_printed() {
    const LIMIT_KIB: usize = 120_000;
    let place = scratch("large");
    let file = place.join("large.gcode");
    let mut out = std::io::BufWriter::new(std::fs::File::create(&file).unwrap());
    let comment = format!("; {}\n", "thumbnail ".repeat(400)).repeat(10);
    for i in 0..4000 {
        let x = 100.0 + f64::from(i % 2);
        writeln!(out, "{comment}G1 X{x} E0.01 F6000\nM204 P{}", 1000 + i % 2).unwrap();
    }
    drop(out);
    let size = std::fs::metadata(&file).unwrap().len() as usize;
    assert!(size > 1024 * LIMIT_KIB, "{size}");
    let script = format!("ulimit -v {LIMIT_KIB} && exec \"$0\" \"$@\"");
    let output = Command::new("sh")
        .args(["-c", &script, env!("CARGO_BIN_EXE_corehbot"), "run"])
        .arg(&file)
        .args(["--assume-homed", "100,100,1", "--report"])
        .arg(place.join("r.html"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}{}", text(&output.stdout), text(&output.stderr));
    assert!(text(&output.stdout).contains("8000 commands"), "{}", text(&output.stdout));
    std::fs::remove_file(file).unwrap();
}

/// Its screws turn alone, and z follows the bed: the checker knows both, and nothing that was asked for is a warning.
#[test]
fn a_bed_is_levelled_and_measured_without_a_violation_or_a_warning() {
    let machine = scratch("bed").join("probed.toml");
    std::fs::write(&machine, "[endstops]\nprobe = \"PROBE\"\n[probe]\nkind = \"switch\"\n").unwrap();
    let gcode = b"G28\nG34\nG29 V4\nG1 X60 Y60 Z0.3 F9000\nG1 X300 Y350\nM420 S0\n";
    let bed = "bowl=0.2,screw=-25/200/0.2,screw=415/200/-0.2";
    let run = print(gcode, &["--machine", machine.to_str().unwrap(), "--bed", bed]);
    let said = text(&run.stdout);
    assert!(run.status.success(), "{said}{}", text(&run.stderr));
    assert!(!said.contains("warnings") && !said.contains("violations"), "{said}");
}

/// Reproducer: the answer to a sweep was in no output.
#[test]
fn answers_of_the_printer_are_in_the_summary_and_on_the_page() {
    let place = scratch("answers");
    let [json, page] = ["s.json", "r.html"].map(|name| place.join(name));
    let gcode = b"G1 X150 Y150 F6000\nTEST_RESONANCES AXIS=X FREQ_START=40 FREQ_END=50 HZ_PER_SEC=2\nM119\nM122\n";
    let run = print(gcode, &["--json", json.to_str().unwrap(), "--report", page.to_str().unwrap()]);
    let said = text(&run.stdout);
    assert!(run.status.success(), "{said}{}", text(&run.stderr));
    assert!(said.contains("\nanswers: 3\n") && !said.contains("\nwarnings"), "{said}");
    let swept = "FREQ_END=50 HZ_PER_SEC=2\n    echo:swept X; no accelerometer configured";
    assert!(said.contains(swept), "{said}");
    let summary: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(summary["answers"][1]["command"], "M119", "{summary}");
    assert_eq!(
        (&summary["answers"][1]["line"], &summary["answers"][1]["replies"][1]),
        (&3.into(), &"x_min: open".into())
    );
    assert!(std::fs::read_to_string(page).unwrap().contains("nothing was measured"));
}
