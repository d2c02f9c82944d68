//! The arrows between the rooms: every `use crate::room` in src/ must be in the table. And the files and folders of
//! each folder have no circle, in this crate and in all others.

use crate::arrows::{arrows_within, circle, paths_used};
use crate::sources::sources;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms that each room may use. A room uses itself without asking.
const ARROWS: [(&str, &[&str]); 20] = [
    ("units", &[]),
    ("text", &[]),
    ("checksum", &[]),
    ("surface", &["units"]),
    ("motors", &["text"]),
    ("connectors", &["text"]),
    ("accelerometer", &[]),
    ("fault", &["units", "text", "checksum", "connectors"]),
    ("status", &["units", "motors", "connectors", "fault"]),
    ("port", &["units", "motors", "connectors", "accelerometer"]),
    ("protocol", &["units", "text", "port"]),
    ("kinematics", &["units", "motors"]),
    ("settings", &["units", "motors", "connectors", "accelerometer", "kinematics"]),
    ("gcode", &["units", "text", "connectors", "motors", "settings"]),
    ("motion", &["units", "surface", "motors", "fault", "status", "port", "settings", "kinematics"]),
    ("driver", &["units", "motors", "port", "settings"]),
    ("storage", &["units", "checksum", "connectors", "port", "kinematics", "settings", "surface"]),
    ("thermal", &["units", "connectors", "fault", "status", "port", "settings"]),
    (
        "machine",
        &[
            "units",
            "text",
            "surface",
            "motors",
            "status",
            "port",
            "protocol",
            "gcode",
            "settings",
            "surface",
            "kinematics",
            "motion",
            "driver",
            "storage",
            "connectors",
            "fault",
            "thermal",
            "accelerometer",
        ],
    ),
    ("app", &["units", "motors", "status", "port", "settings", "kinematics", "motion", "thermal", "machine"]),
];

/// The rooms named behind `crate::` in a source text, comments apart.
fn rooms_used(text: &str) -> Vec<String> {
    let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    code.match_indices("crate::")
        .filter_map(|(at, found)| {
            let before = code[..at].chars().next_back();
            let is_path = before.is_none_or(|c| !(c.is_alphanumeric() || c == '_' || c == ':'));
            let name: String =
                code[at + found.len()..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            (is_path && !name.is_empty()).then_some(name)
        })
        .collect()
}

#[test]
fn rooms_use_only_the_rooms_to_their_left() {
    let allowed: BTreeMap<_, _> = ARROWS.into_iter().collect();
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src, &mut files);
    assert!(files.len() > 20, "only {} sources found", files.len());
    let mut wrong = Vec::new();
    for file in files {
        let relative = file.strip_prefix(&src).unwrap();
        let room = relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_owned();
        if room == "lib" {
            continue;
        }
        let may = allowed.get(room.as_str()).unwrap_or_else(|| panic!("room {room} is not in the table"));
        for used in rooms_used(&fs::read_to_string(&file).unwrap()) {
            if used != room && !may.contains(&used.as_str()) {
                wrong.push(format!("{}: {room} -> {used}", relative.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "arrows that the table does not hold:\n{}", wrong.join("\n"));
}

#[test]
fn the_table_has_no_cycle() {
    let order: Vec<&str> = ARROWS.iter().map(|(room, _)| *room).collect();
    for (at, (room, may)) in ARROWS.iter().enumerate() {
        for used in *may {
            let place = order.iter().position(|r| r == used);
            assert!(place.is_some_and(|p| p < at), "{room} uses {used}, which is not to its left");
        }
    }
}

/// The folders of all crates: those of the workspace, and those with a workspace of their own.
fn crates() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let list = |key: &str| {
        let begin = format!("\n{key} = [");
        manifest.split_once(&begin).unwrap_or_else(|| panic!("no {key}")).1.split(']').next().unwrap().to_owned()
    };
    let lists = [list("members"), list("exclude")].join(",");
    let folders = lists.split(',').map(|folder| root.join(folder.trim().trim_matches('"')));
    folders.chain([root.to_owned()]).filter(|folder| folder.join("src").is_dir()).collect()
}

#[test]
fn files_beside_each_other_do_not_use_each_other_in_a_circle() {
    let crates = crates();
    let (mut wrong, mut found) = (Vec::new(), 0);
    for src in crates.iter().map(|folder| folder.join("src")) {
        let mut files = Vec::new();
        sources(&src, &mut files);
        for (folder, arrows) in arrows_within(&src, &files) {
            found += arrows.values().map(BTreeSet::len).sum::<usize>();
            let circle = circle(&arrows);
            if !circle.is_empty() {
                wrong.push(format!("{}/{}: {circle:?}", src.display(), folder.join("/")));
            }
        }
    }
    assert!(crates.len() > 20 && found > 1000, "only {} crates and {found} arrows found", crates.len());
    assert!(wrong.is_empty(), "files that use each other in a circle:\n{}", wrong.join("\n"));
}

/// The parts of the room `machine` that each part may use, only those above it. A command gets the main loop and the
/// states that it names, and the Console passes them.
const WITHIN_MACHINE: [(&str, &[&str]); 24] = [
    ("apart", &[]),
    ("ports", &[]),
    ("interrupt", &[]),
    ("numbers", &[]),
    ("release", &[]),
    ("hosts", &[]),
    ("state", &["numbers"]),
    ("answers", &["hosts", "state"]),
    ("reports", &["answers", "numbers", "state"]),
    ("main_loop", &["answers", "apart", "hosts", "interrupt", "numbers", "ports", "release", "reports", "state"]),
    ("states", &["main_loop", "ports", "state"]),
    ("belt", &["answers", "apart", "interrupt", "main_loop", "numbers", "ports", "reports", "state"]),
    ("probe", &["answers", "apart", "interrupt", "main_loop", "numbers", "ports", "state"]),
    ("resonance", &["answers", "apart", "interrupt", "main_loop", "numbers", "ports", "reports", "state", "states"]),
    ("messages", &["answers", "hosts", "interrupt", "main_loop", "ports", "reports", "state", "states"]),
    (
        "heat",
        &[
            "answers",
            "apart",
            "hosts",
            "interrupt",
            "main_loop",
            "messages",
            "numbers",
            "ports",
            "reports",
            "state",
            "states",
        ],
    ),
    ("print", &["answers", "apart", "heat", "interrupt", "main_loop", "ports", "probe", "state", "states"]),
    (
        "travel",
        &[
            "answers",
            "apart",
            "belt",
            "heat",
            "interrupt",
            "main_loop",
            "numbers",
            "ports",
            "print",
            "reports",
            "state",
            "states",
        ],
    ),
    (
        "setup",
        &["answers", "apart", "heat", "interrupt", "main_loop", "numbers", "ports", "reports", "state", "states"],
    ),
    (
        "homing",
        &[
            "answers",
            "apart",
            "belt",
            "interrupt",
            "main_loop",
            "numbers",
            "ports",
            "probe",
            "reports",
            "setup",
            "state",
            "states",
            "travel",
        ],
    ),
    (
        "bed",
        &[
            "answers",
            "apart",
            "homing",
            "interrupt",
            "main_loop",
            "numbers",
            "ports",
            "probe",
            "reports",
            "setup",
            "state",
            "states",
        ],
    ),
    (
        "motors",
        &[
            "answers",
            "apart",
            "belt",
            "homing",
            "interrupt",
            "main_loop",
            "numbers",
            "ports",
            "print",
            "reports",
            "setup",
            "state",
            "states",
            "travel",
        ],
    ),
    (
        "commands",
        &[
            "answers",
            "apart",
            "bed",
            "heat",
            "homing",
            "interrupt",
            "main_loop",
            "messages",
            "motors",
            "ports",
            "print",
            "probe",
            "resonance",
            "setup",
            "state",
            "states",
            "travel",
        ],
    ),
    (
        "console",
        &[
            "answers",
            "apart",
            "belt",
            "commands",
            "hosts",
            "interrupt",
            "main_loop",
            "ports",
            "print",
            "probe",
            "setup",
            "state",
            "states",
        ],
    ),
];

/// The parts of the room `motion` that each part may use, only those above it. The planner, the generator and the
/// Stepper share formulas, entries and queues, but none of the three uses another one: each has a context of its own.
const WITHIN_MOTION: [(&str, &[&str]); 15] = [
    ("number", &[]),
    ("ticks", &[]),
    ("moves", &[]),
    ("ramps", &["moves", "number"]),
    ("surface", &["number"]),
    ("queue", &["ticks"]),
    ("step_counts", &["queue"]),
    ("z_limits", &["moves", "number"]),
    ("trajectory", &["moves", "number", "ramps", "surface", "ticks", "z_limits"]),
    ("sweep", &["moves", "ramps", "trajectory"]),
    ("work", &["moves", "surface", "sweep", "trajectory"]),
    ("planner", &["moves", "number", "ramps", "surface", "trajectory"]),
    ("link", &["moves", "step_counts", "work", "z_limits"]),
    ("stepgen", &["moves", "number", "queue", "ramps", "surface", "sweep", "ticks", "trajectory", "work", "z_limits"]),
    ("stepper", &["queue"]),
];

#[test]
fn the_parts_of_the_machine_use_only_those_above_them() {
    assert_arrows_within("machine", &WITHIN_MACHINE);
}

#[test]
fn the_parts_of_motion_use_only_those_above_them() {
    assert_arrows_within("motion", &WITHIN_MOTION);
}

/// Asserts that the parts of a room use only those that the table has for them, which are above them.
fn assert_arrows_within(room: &str, table: &[(&str, &[&str])]) {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&src.join(room), &mut files);
    let within = arrows_within(&src, &files);
    let (mut wrong, mut above) = (Vec::new(), BTreeSet::new());
    let arrows = &within[&vec![room.to_owned()]];
    for (part, may) in table {
        assert!(may.iter().all(|used| above.contains(used)), "{part} uses what is not above it: {may:?}");
        above.insert(*part);
        let used = arrows.get(*part).into_iter().flatten();
        wrong.extend(used.filter(|used| !may.contains(&used.as_str())).map(|used| format!("{part} -> {used}")));
    }
    wrong.extend(
        arrows.keys().filter(|part| !above.contains(part.as_str())).map(|part| format!("{part} is not in the table")),
    );
    assert!(wrong.is_empty(), "arrows that the table does not hold:\n{}", wrong.join("\n"));
}

#[test]
fn a_circle_is_found_through_names_that_are_handed_on() {
    let arrows = |list: &[(&str, &str)]| {
        let mut arrows = BTreeMap::<String, BTreeSet<String>>::new();
        for (from, to) in list {
            arrows.entry((*from).to_owned()).or_default().insert((*to).to_owned());
        }
        arrows
    };
    assert!(circle(&arrows(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    assert_eq!(circle(&arrows(&[("a", "b"), ("b", "c"), ("c", "b")])).keys().collect::<Vec<_>>(), ["a", "b", "c"]);
    let module = ["motion", "queue"].map(str::to_owned);
    let used =
        paths_used(&module, "pub use event::{A, B};\nuse super::ticks::{x::{Y, Z}, self};\nlet a = crate::units::Mm;");
    let used: Vec<String> = used.iter().map(|path| path.join("/")).collect();
    let expected = [
        "motion/queue/event/A",
        "motion/queue/event/B",
        "motion/ticks/x/Y",
        "motion/ticks/x/Z",
        "motion/ticks",
        "units/Mm",
    ];
    assert!(expected.iter().all(|path| used.contains(&(*path).to_owned())), "{used:?}");
}

#[test]
fn an_arrow_is_found_wherever_it_is_written() {
    let text = "use crate::units::Mm;\n// crate::app\nfn f(x: crate::port::Motor) { mycrate::machine() }";
    assert_eq!(rooms_used(text), ["units", "port"]);
}
