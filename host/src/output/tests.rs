//! Tests of output.

use super::*;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_file_has_its_name_only_when_it_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    fs::write(&path, "old").unwrap();
    let mut outputs = Outputs::new([], Stop::default());
    let mut out = outputs.open(&path).unwrap();
    out.write_all(b"new").unwrap();
    out.flush().unwrap();
    assert_eq!(names(folder.path()), ["t.csv", "t.csv.partial"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    outputs.keep().unwrap();
    assert_eq!((names(folder.path()), fs::read(&path).unwrap()), (vec!["t.csv".to_owned()], b"new".to_vec()));
}

#[test]
fn what_is_not_whole_is_left_by_another_name_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let mut outputs = Outputs::new([], Stop::default());
    let _ = outputs.open(&folder.path().join("a")).unwrap();
    assert_eq!(outputs.leave(), [folder.path().join("a.partial")]);
    let mut outputs = Outputs::new([], Stop::default());
    let _ = outputs.open(&folder.path().join("b")).unwrap();
    drop(outputs);
    assert_eq!(names(folder.path()), ["a.partial"]);
}

#[test]
fn an_output_is_no_input_and_no_other_output() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("in.gcode"), "G28").unwrap();
    fs::write(path("old.partial"), "G28").unwrap();
    fs::create_dir(path("sub")).unwrap();
    let inputs = [path("in.gcode"), path("old.partial")];
    let refused = |name: &str| {
        let mut outputs = Outputs::new(inputs.iter().map(PathBuf::as_path), Stop::default());
        let _ = outputs.open(&path("first")).unwrap();
        outputs.open(&path(name)).unwrap_err().to_string()
    };
    assert!(refused("in.gcode").contains("would overwrite the input"));
    assert!(refused("sub/../in.gcode").contains("would overwrite the input"));
    assert!(refused("old").contains("would overwrite the input"));
    assert!(refused("sub/../first").contains("another output"));
    assert!(refused("first.partial").contains("another output"));
    assert!(refused("sub").contains("directory"));
    assert_eq!(fs::read(path("in.gcode")).unwrap(), b"G28");
    let mut outputs = Outputs::new([], Stop::default());
    let _ = outputs.open(Path::new(STANDARD)).unwrap();
    assert!(outputs.open(Path::new(STANDARD)).is_err());
}

#[cfg(unix)]
#[test]
fn links_are_the_file_that_they_lead_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("in.gcode"), "G28").unwrap();
    fs::hard_link(path("in.gcode"), path("hard")).unwrap();
    std::os::unix::fs::symlink("in.gcode", path("soft")).unwrap();
    std::os::unix::fs::symlink("new", path("dangling")).unwrap();
    for name in ["hard", "soft"] {
        assert!(Outputs::new([path("in.gcode").as_path()], Stop::default()).open(&path(name)).is_err(), "{name}");
    }
    let mut outputs = Outputs::new([], Stop::default());
    outputs.open(&path("dangling")).unwrap().write_all(b"x").unwrap();
    outputs.keep().unwrap();
    assert!(fs::symlink_metadata(path("dangling")).unwrap().is_symlink());
    assert_eq!(fs::read(path("new")).unwrap(), b"x");
}

#[cfg(unix)]
#[test]
fn a_device_is_written_as_it_is() {
    let mut outputs = Outputs::new([], Stop::default());
    for _ in 0..2 {
        outputs.open(Path::new("/dev/null")).unwrap().write_all(b"x").unwrap();
    }
    outputs.keep().unwrap();
    assert!(!Path::new("/dev/null.partial").exists() && !fs::metadata("/dev/null").unwrap().is_file());
}
