//! The command: the output of `--plant belt`, and its refusals.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const PRINT: &[u8] = b"G1 X120 F6000\nG1 Y120\nG1 X100 Y100\n";

fn examples(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(file)
}

fn corehbot(arguments: &[&str]) -> Output {
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"))
        .args(["run", "-"])
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // It may have refused before it reads.
    let _ = run.stdin.take().unwrap().write_all(PRINT);
    run.wait_with_output().unwrap()
}

#[test]
fn a_bad_value_is_one_line_and_nothing_is_begun() {
    let folder = tempfile::tempdir().unwrap();
    let unbelted = folder.path().join("machine.toml");
    let cartesian = std::fs::read_to_string(examples("machines/cartesian.toml")).unwrap();
    std::fs::write(&unbelted, cartesian + "\n[twin]\nrouting = \"corehbot\"\n").unwrap();
    for (arguments, said) in [
        (&["--hit", "1,2,3"][..], "--hit 1,2,3: expected X,Y,N,MS"),
        (&["--brake", "z1,3"], "--brake z1,3: `z1` is not a belt motor: m1, m4, m8, m11"),
        (&["--brake", "m1,-3"], "--brake m1,-3: `-3` is not a force of 0 to 10,000 N"),
        (
            &["--machine", unbelted.to_str().unwrap()],
            "--plant belt: twin.routing = \"corehbot\": no motor turns (-1, 1, 0) for x, y and z, as its motor 1 must",
        ),
        (&["--assume-homed", "389,900,1"], "--plant belt: the belt plant's tool cannot begin at X389.00 Y900.00"),
    ] {
        let mut all = vec!["--plant", "belt"];
        all.extend(arguments);
        let output = corehbot(&all);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!((complaint.trim_end(), output.status.code()), (format!("corehbot: {said}").as_str(), Some(2)));
    }
}

#[test]
fn figures_are_in_the_json_with_a_plant_alone() {
    let figures = |arguments: &[&str]| -> serde_json::Value {
        let output = corehbot(&[&["--assume-homed", "100,100,10", "--json", "-"], arguments].concat());
        assert!(output.status.success());
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (rigid, belt) = (figures(&[]), figures(&["--plant", "belt", "--seed", "2"]));
    assert!(rigid.get("belt").is_none());
    assert_eq!(rigid["trace_sha256"], belt["trace_sha256"]);
    assert_eq!((&belt["belt"]["machine"], &belt["belt"]["seed"]), (&"CoreH-bot".into(), &2.into()));
    assert_eq!(belt["belt"]["motors"][3]["motor"], "m11");
    assert!(belt["belt"]["largest_off_mm"].as_f64().unwrap() > 0.01);
    assert_eq!(belt["belt"]["skips"].as_array().unwrap().len(), 0);
}
