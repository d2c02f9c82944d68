//! `corehbot config` as a user sees it: a machine file is begun, checked, and described to editors.

#[path = "common/json_schema.rs"]
mod json_schema;

use corehbot::settings::SHEETS;
use corehbot::storage::blank_block;
use json_schema::is_of;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn config(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("config").args(args).output().unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn machines() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines")
}

/// The files of all example machines.
fn examples() -> Vec<PathBuf> {
    let files = std::fs::read_dir(machines()).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect()
}

/// A file of that text, for one test.
fn file(test: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{test}.toml"));
    std::fs::write(&path, text).unwrap();
    path
}

fn schema() -> Value {
    let output = config(&["schema"]);
    assert_eq!(output.status.code(), Some(0));
    serde_json::from_str(&out(&output)).unwrap()
}

/// The schemas of all keys, by their paths.
fn keys(schema: &Value, path: &str, into: &mut Vec<(String, Value)>) {
    match schema.get("properties").and_then(Value::as_object) {
        Some(inner) => inner.iter().for_each(|(key, schema)| keys(schema, &format!("{path}.{key}"), into)),
        None => into.push((path.trim_start_matches('.').to_owned(), schema.clone())),
    }
}

#[test]
fn the_schema_beside_the_examples_is_of_today() {
    let path = machines().join("machine.schema.json");
    let today = out(&config(&["schema"]));
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &today).unwrap();
    }
    assert!(std::fs::read_to_string(path).unwrap() == today, "BLESS=1 writes it");
}

#[test]
fn every_example_is_of_the_schema_and_names_it() {
    let schema = schema();
    let examples = examples();
    assert!(examples.len() >= 9);
    for path in examples {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("#:schema ./machine.schema.json\n"), "{}", path.display());
        let machine = serde_json::to_value(toml::from_str::<toml::Table>(&text).unwrap()).unwrap();
        assert!(is_of(&schema, &machine), "{}", path.display());
    }
}

#[test]
fn what_the_reader_refuses_is_not_of_the_schema() {
    let schema = schema();
    for (text, is_machine) in [
        ("[axes.x]\nmax_speed = 3000", true),
        ("[axes.x]\nmax_speed = 3001", false),
        ("[axes.x]\nmax_sped = 1", false),
        ("board = 'octopuss'", false),
        ("[motors]\nm1 = '!M0'", true),
        ("[motors]\nm1 = 'M 0'", false),
        ("[motors]\nm1 = '!'", false),
        ("[mechanism]\nm1 = [1, 17, 0]", false),
        ("[heaters.bed]\nthermistor = { ohms = 100000, beta = 3950 }", true),
        ("[heaters.bed]\nthermistor = { ohms = 100000, beta = 1 }", false),
        ("[drivers.e]\nhold_percent = 50.5", false),
        ("[axes.z]\nrotation_distance = 0", false),
    ] {
        let machine = serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap();
        assert_eq!(is_of(&schema, &machine), is_machine, "{text}");
        assert_eq!(corehbot_machine_file::load(text).is_ok(), is_machine, "{text}");
    }
}

#[test]
fn every_key_is_explained_with_its_range() {
    let mut all = Vec::new();
    keys(&schema(), "", &mut all);
    assert!(all.len() > 190, "{}", all.len());
    for (path, schema) in all {
        let explained = schema["description"].as_str();
        assert!(explained.is_some_and(|text| text.ends_with('.') && !text.contains('\n')), "{path}: {explained:?}");
        if ["number", "integer"].contains(&schema["type"].as_str().unwrap_or_default()) {
            let has_range = schema.get("minimum").is_some() && schema.get("maximum").is_some();
            assert!(has_range || path.ends_with(".rotation_distance"), "{path}");
        }
    }
}

#[test]
fn a_new_file_is_a_machine_and_prints() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new.toml");
    let _ = std::fs::remove_file(&path);
    let name = path.to_str().unwrap();
    let new = ["new", "--board", "octopus", "--kinematics", "corexy", "--heaters", "-o", name];
    assert_eq!(config(&new).status.code(), Some(0));
    let check = config(&["check", name]);
    assert_eq!(check.status.code(), Some(0));
    assert_eq!(out(&check), format!("{name}: a machine of 4 motors for BTT Octopus; no errors, no warnings\n"));
    // An existing file stays.
    let again = config(&new);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("cannot create"));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), out(&config(&new[..6])));
    let print = Command::new(env!("CARGO_BIN_EXE_corehbot"))
        .arg("run")
        .arg(machines().join("../circle.gcode"))
        .args(["--machine", name])
        .output()
        .unwrap();
    assert_eq!(print.status.code(), Some(0), "{}", out(&print));
}

#[test]
fn every_example_is_checked_without_a_remark() {
    for path in examples() {
        let check = config(&["check", path.to_str().unwrap()]);
        assert_eq!(check.status.code(), Some(0), "{}", out(&check));
        // Examples with a board are for motion; their owners add the heaters.
        let said = out(&check);
        let others = said.lines().filter(|line| !line.contains("an extruder (e0) without a hotend")).count();
        assert!(others == 1 && said.contains("; no errors, "), "{said}");
    }
}

#[test]
fn a_file_with_errors_is_no_machine() {
    let path = file("errors", "board = \"octopus\"\nkeepalive_s = 99\n[axes.x]\n max_sped = 5\n");
    let check = config(&["check", path.to_str().unwrap()]);
    assert_eq!(check.status.code(), Some(1));
    let (said, name) = (out(&check), path.display());
    let range = format!("{name}:2:15: error: keepalive_s = 99 is outside the whole numbers 0 to 60\n");
    assert!(said.starts_with(&range), "{said}");
    assert!(said.contains(&format!("\n{name}:4:2: error: unknown field `max_sped`")), "{said}");
    assert!(said.contains("did you mean `max_speed`?\n"), "{said}");
    assert!(said.ends_with(&format!("{name}: no machine; 2 errors, no warnings\n")), "{said}");
}

#[test]
fn a_thermistor_that_is_none_is_told_which_there_are() {
    for wrong in ["\"104gt3\"", "{ ohms = 100000 }", "5"] {
        let path = file("thermistor", &format!("[heaters.hotend]\nthermistor = {wrong}\n"));
        let said = out(&config(&["check", path.to_str().unwrap()]));
        assert!(said.contains("error: thermistor is one of 104gt2, ") && !said.contains("untagged"), "{wrong}: {said}");
        assert!(
            said.contains(", or an NTC: { points = ") && said.contains("{ ohms = 100000, beta = 3950 }"),
            "{wrong}: {said}"
        );
        assert!(SHEETS.iter().all(|sheet| said.contains(sheet.name)), "{wrong}: {said}");
    }
}

#[test]
fn an_extruder_without_a_hotend_is_a_warning_on_a_board() {
    let path = file("no-hotend", "board = \"octopus\"\n");
    let said = out(&config(&["check", path.to_str().unwrap()]));
    assert!(said.contains("warning: an extruder (e0) without a hotend: heating is ignored"), "{said}");
}

#[test]
fn a_connector_that_the_board_has_not_is_an_error() {
    let path = file("connector", "board = \"octopus\"\n[motors]\nm1 = \"M8\"\n");
    let check = config(&["check", path.to_str().unwrap()]);
    assert_eq!(check.status.code(), Some(1));
    let text = "3:6: error: motor m1: the BTT Octopus has no connector M8; it has M0, M1, M2, M3, M4, M5, M6, M7\n";
    assert!(out(&check).contains(text), "{}", out(&check));
}

#[test]
fn what_is_unwise_is_a_warning_and_still_a_machine() {
    let path = file("unwise", "[drivers.z]\ncurrent_ma = 1500\n[endstops]\nz = \"!Z-STOP\"\n");
    let check = config(&["check", path.to_str().unwrap()]);
    assert_eq!(check.status.code(), Some(0));
    let said = out(&check);
    assert!(said.contains(":2:14: warning: drivers.z.current_ma = 1500: above 1414 mA"), "{said}");
    assert!(said.contains(":4:5: warning: endstops.z: a switch that closes"), "{said}");
    assert!(said.ends_with(": a machine of 7 motors for any board; no errors, 2 warnings\n"), "{said}");
}

/// docs/reference/machines.md has every board and every kind of machine.
#[test]
fn the_document_names_every_board_and_every_kind_of_machine() {
    let document = include_str!("../../docs/reference/machines.md");
    let rows = document.lines().filter(|line| line.starts_with("| `")).collect::<Vec<_>>();
    for board in corehbot_boards::all() {
        let name = format!("`{}`", board.key);
        let is_named = |row: &&str| row.split('|').nth(1).is_some_and(|cell| cell.contains(&name));
        assert!(rows.iter().any(is_named), "the table of connectors has no {name}");
        assert!(
            rows.iter().any(|row| row.starts_with("| `board`") && row.contains(&name)),
            "the key board has no {name}"
        );
    }
    let others = [
        ("README.md", include_str!("../../README.md")),
        ("prototype.toml", include_str!("../../examples/machines/prototype.toml")),
    ];
    for (file, text) in others {
        for board in corehbot_boards::all().filter(|board| board.key != "sim") {
            assert!(text.contains(board.key), "{file} does not name the board {}", board.key);
        }
    }
    for path in examples() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let kind = if name == "prototype" { "corehbot" } else { name };
        assert!(document.contains(&format!("`{kind}`")), "{kind}");
        assert_eq!(
            config(&["new", "--board", "octopus", "--kinematics", kind]).status.code(),
            Some(0),
            "`config new` does not know {kind}"
        );
    }
}

#[test]
fn a_host_that_may_be_silent_for_longer_than_the_look_ahead_lasts_is_a_warning() {
    let path = file("patience", "patience_ms = 2000\nlookahead_time = 2\n");
    let said = out(&config(&["check", path.to_str().unwrap()]));
    assert!(said.contains(":1:15: warning: patience_ms = 2000: not below lookahead_time = 2 s"), "{said}");
}

#[test]
fn a_file_that_is_not_there_is_status_2() {
    let check = config(&["check", "no-such.toml"]);
    assert_eq!(check.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&check.stderr).contains("corehbot: cannot open no-such.toml"));
}

/// A configuration of Klipper among the tests of machine files.
/// Marlin's two sources lie beside each other; a config.g is told by its commands.
#[test]
fn sources_of_other_firmwares_are_known_by_their_content() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sources");
    std::fs::create_dir_all(&folder).unwrap();
    let first = "#define MOTHERBOARD BOARD_RAMPS_14_EFB\n#define DEFAULT_AXIS_STEPS_PER_UNIT { 80, 80, 400, 93 }\n\
                 #define X_DRIVER_TYPE TMC2209\n";
    let texts = [
        ("Configuration.h", first),
        ("Configuration_adv.h", "#if AXIS_IS_TMC_CONFIG(X)\n#define X_CURRENT 580\n#endif\n"),
        ("config.g", "M584 X0 Y1 Z2 E3\nM92 X81 Y80 Z400 E90\nM669 K1\n"),
    ];
    for (name, text) in texts {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let from = |name: &str, more: &[&str]| {
        let path = folder.join(name);
        config(&[&["from", path.to_str().unwrap()], more].concat())
    };
    let marlin = from("Configuration.h", &["--board", "octopus"]);
    assert_eq!(marlin.status.code(), Some(0), "{}", String::from_utf8_lossy(&marlin.stderr));
    assert!(
        out(&marlin).contains("current_ma = 580") && out(&marlin).contains("steps_per_mm = 93"),
        "{}",
        out(&marlin)
    );
    let told = String::from_utf8_lossy(&marlin.stderr).into_owned();
    assert!(told.contains("taken") && told.contains("DEFAULT_AXIS_STEPS_PER_UNIT"), "{told}");
    assert_eq!(from("Configuration.h", &[]).status.code(), Some(1), "its board is not here");
    let reprap = from("config.g", &[]);
    assert_eq!(reprap.status.code(), Some(0), "{}", String::from_utf8_lossy(&reprap.stderr));
    assert!(out(&reprap).contains("x = [1, 1, 0]") && out(&reprap).contains("steps_per_mm = 81"), "{}", out(&reprap));
}

fn klipper(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../machine-file/tests/klipper").join(name).to_str().unwrap().to_owned()
}

#[test]
fn a_configuration_of_klipper_becomes_a_machine() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gantry.toml");
    let _ = std::fs::remove_file(&path);
    let name = path.to_str().unwrap();
    let from = config(&["from", &klipper("gantry.cfg"), "-o", name]);
    let report = out(&from);
    assert_eq!(from.status.code(), Some(0), "{report}{}", String::from_utf8_lossy(&from.stderr));
    assert!(report.starts_with("for the BTT Octopus\n"), "{report}");
    // Included files by a pattern, and in a folder of their own.
    for told in ["parts/tool.cfg:1", "parts/heat/heat.inc:1", "[bed_mesh default]", " 0 to decide\n"] {
        assert!(report.contains(told), "{told}: {report}");
    }
    assert_eq!(config(&["check", name]).status.code(), Some(0));
    let text = std::fs::read_to_string(&path).unwrap();
    // Without -o the file is standard output, and the report standard error.
    let other = config(&["from", &klipper("gantry.cfg")]);
    assert_eq!(out(&other), text);
    assert!(String::from_utf8_lossy(&other.stderr).contains("for the BTT Octopus\n"));
    // An existing file stays.
    assert_eq!(config(&["from", &klipper("gantry.cfg"), "-o", name]).status.code(), Some(2));
}

#[test]
fn a_configuration_with_something_to_decide_is_status_1() {
    let from = config(&["from", &klipper("awd.cfg")]);
    let report = String::from_utf8_lossy(&from.stderr).into_owned();
    assert_eq!(from.status.code(), Some(1), "{report}");
    assert!(report.contains("EBBCan is another board") && report.contains("no machine yet: decide"), "{report}");
    assert!(report.contains("machine file:"), "problems of the file: {report}");
    // The board of the command line counts.
    let from = config(&["from", "--board", "octopus", &klipper("awd.cfg")]);
    assert!(out(&from).contains("board = \"octopus\"  # --board\n"), "{}", out(&from));
}

#[test]
fn a_folder_is_its_printer_cfg_and_bad_lines_are_told() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("klipper-folder");
    std::fs::create_dir_all(folder.join("sub")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    let from = || config(&["from", folder.to_str().unwrap()]);
    let said = || String::from_utf8_lossy(&from().stderr).into_owned();
    let _ = std::fs::remove_file(folder.join("printer.cfg"));
    assert!(said().contains("cannot open"), "{}", said());
    write("printer.cfg", "[include sub/one.cfg]\n[printer]\nkinematics: corexy\n");
    write("sub/one.cfg", "[include ../sub/*.cfg]\n");
    assert!(said().contains("one.cfg:1: error: ") && said().contains("includes itself"), "{}", said());
    write("sub/one.cfg", "[mcu]\nserial\n");
    assert_eq!(from().status.code(), Some(2));
    assert!(said().contains("one.cfg:2: error: \"serial\" is neither"), "{}", said());
    write("sub/one.cfg", "[mcu]\nserial:\n  /dev/ttyACM0\n");
    assert!(said().contains("cannot tell the board"), "{}", said());
}

/// The saved answers of a printer among the tests of machine files.
fn marlin(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../machine-file/tests/marlin").join(name).to_str().unwrap().to_owned()
}

#[test]
fn a_saved_answer_of_marlin_becomes_a_machine() {
    for (name, more) in [
        ("mega.log", &["--kinematics", "cartesian"][..]),
        ("core.log", &["--kinematics", "corexy"]),
        ("shaped.log", &[]),
    ] {
        for board in [&["--board", "octopus"][..], &[]] {
            let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).with_extension("toml");
            let _ = std::fs::remove_file(&path);
            let log = marlin(name);
            let from = config(&[&["from", &log, "-o", path.to_str().unwrap()], board, more].concat());
            let report = out(&from);
            // Z has an offset in one of them.
            let status = if name == "core.log" { 1 } else { 0 };
            assert_eq!(from.status.code(), Some(status), "{report}{}", String::from_utf8_lossy(&from.stderr));
            assert!(report.contains("to be filled in\n"), "{report}");
            let check = config(&["check", path.to_str().unwrap()]);
            assert_eq!(check.status.code(), Some(0), "{name}: {}", out(&check));
        }
    }
    // Without --kinematics the mechanism is to be decided, and with a configuration of Klipper it has no use.
    assert_eq!(config(&["from", &marlin("mega.log")]).status.code(), Some(1));
    let from = config(&["from", &klipper("gantry.cfg"), "--kinematics", "corexy"]);
    assert!(
        from.status.code() == Some(2) && String::from_utf8_lossy(&from.stderr).contains("--kinematics is for printers")
    );
}

/// The tutorials show what a reader gets: the check of a new machine, and its size in an image.
#[test]
fn the_tutorials_show_the_new_machine_as_it_is() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("my-machine.toml");
    let _ = std::fs::remove_file(&path);
    let name = path.to_str().unwrap();
    config(&["new", "--board", "octopus", "--kinematics", "corexy", "--heaters", "-o", name]);
    let check = out(&config(&["check", name])).replace(name, "my-machine.toml");
    for document in ["README.md", "docs/tutorial/first-machine-file.md"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(document);
        let text = std::fs::read_to_string(path).unwrap();
        assert!(text.contains(check.trim_end()), "{document} has no {check:?}");
    }
    let mut image = blank_block(&[&corehbot_boards::octopus::CONNECTORS]).to_vec();
    let mut machine = corehbot_machine_file::read(&path).unwrap();
    let receipt = corehbot_host::image::put(&mut image, &mut machine.settings).unwrap();
    let shown = format!("{} {receipt}\n", machine.name.unwrap());
    let document = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/tutorial/first-flash.md");
    let text = std::fs::read_to_string(&document).unwrap();
    let (before, rest) = text.split_once("bytes for the board octopus, ").unwrap();
    let whole = format!("{before}bytes for the board octopus, {shown}{}", rest.split_once('\n').unwrap().1);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&document, &whole).unwrap();
    }
    let is_shown = std::fs::read_to_string(&document).unwrap() == whole;
    assert!(is_shown, "first-flash.md does not show {shown:?}: BLESS=1 writes it");
}
