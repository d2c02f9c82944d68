//! The command: files in Klipper's words keep the limits, whatever their words home and move.

use std::process::Command;

const PRINT: &str = "START_PRINT BED_TEMP=60 EXTRUDER_TEMP=210\nM83\nG1 X50 Y50 Z0.3 F6000\nG1 X90 E2 F1800\nG1 Y90 E2\n\
                     SWEEP SPEED=120\nEND_PRINT\n";

#[test]
fn a_print_in_words_is_checked_like_one_in_codes() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let machine = "../examples/machines/corexy.toml";
    let machine = std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(machine)).unwrap();
    let sweep = "SWEEP = \"\"\"\nG28 X\nG1 X60 Y60 F{SPEED:100}\n\"\"\"\n";
    let start = "START_PRINT = \"\"\"\nG28\nM109 S{EXTRUDER_TEMP}\n\"\"\"\n";
    for (name, texts) in [("built-in", sweep.to_owned()), ("own", format!("{sweep}{start}"))] {
        let machine = file("m.toml", &format!("{machine}\n[texts]\n{texts}"));
        let print = file("print.gcode", PRINT);
        let run =
            Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("run").arg(print).arg("--machine").arg(machine).output();
        let run = run.unwrap();
        let told = String::from_utf8(run.stdout).unwrap() + &String::from_utf8(run.stderr).unwrap();
        assert!(run.status.success() && !told.contains("violations"), "{name}: {told}");
    }
}
