//! The rooms of the twin: each uses only those that stand before it in this list, as the head of the crate says.

use std::fs;
use std::path::{Path, PathBuf};

const ROOMS: [&str; 18] = [
    "math",
    "random",
    "params",
    "routing",
    "description",
    "geometry",
    "model",
    "solve",
    "torque",
    "shaping",
    "calibration",
    "ripple",
    "queries",
    "dynamics",
    "steps",
    "contour",
    "run",
    "stepped_machine",
];

fn sources(of: &Path) -> Vec<PathBuf> {
    if of.is_file() {
        return vec![of.to_owned()];
    }
    fs::read_dir(of).unwrap().flat_map(|entry| sources(&entry.unwrap().path())).collect()
}

#[test]
fn rooms_use_only_the_rooms_before_them() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut arrows = 0;
    for (place, room) in ROOMS.iter().enumerate() {
        let folder = src.join(room);
        let root = if folder.is_dir() { folder } else { src.join(format!("{room}.rs")) };
        for file in sources(&root).into_iter().filter(|file| file.extension().is_some_and(|e| e == "rs")) {
            let text = fs::read_to_string(&file).unwrap();
            // Tests of a file may ask any room.
            let code = text.split("#[cfg(test)]").next().unwrap();
            for line in code.lines().filter(|line| line.starts_with("use crate::")) {
                let rest = line.trim_start_matches("use crate::");
                let name = rest.split([':', ';', ' ']).next().unwrap();
                let used = ROOMS.iter().position(|known| *known == name);
                let is_before = used.is_some_and(|used| used < place) || name == *room;
                assert!(is_before, "{}: `{line}`, but {room} stands before {name}", file.display());
                arrows += 1;
            }
        }
    }
    assert!(arrows > 50, "only {arrows} found");
}
