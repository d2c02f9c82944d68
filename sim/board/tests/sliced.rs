//! Real sliced files, if their folder is next to the checkout, print to their end, and again on the same printer. So do
//! the examples and the prints of `cargo xtask clients`.

use crate::extent::is_all;
use corehbot::connectors::Heater;
use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot_machine_file as machine_file;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Host, Sink, run};
use std::path::{Path, PathBuf};

/// Counts events and checks them against the belt's law.
#[derive(Default)]
struct Count {
    events: u64,
    last: u64,
}

impl Sink for Count {
    fn event(&mut self, tick: u64, steps: MotorSet, _forward: MotorSet) {
        assert!(tick >= self.last && !steps.is_empty());
        assert_eq!((steps.0 & 1) << 2, steps.0 & 4, "motors 1 and 8 step together");
        assert_eq!((steps.0 & 2) << 2, steps.0 & 8, "motors 4 and 11 step together");
        self.last = tick;
        self.events += 1;
    }
}

/// The sliced files, if the folder with them is there.
fn sliced_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/gcode");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: no folder with sliced files at ../shared/gcode");
        return Vec::new();
    };
    let mut files: Vec<_> = entries.map(|e| e.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "gcode"));
    files.sort();
    assert!(!files.is_empty());
    files
}

/// Lines of a file before the end of a short print. They and the end have every form of line of the file: all codes
/// with all their letters, but for some arcs with a feed of their own. So `cargo xtask test --all` alone prints files
/// whole.
const LINES: usize = 3000;

#[test]
fn every_sliced_file_prints_to_its_end() {
    for file in sliced_files() {
        let whole = std::fs::read_to_string(&file).unwrap();
        let gcode = if is_all() { whole } else { short_print(&whole, LINES) };
        let mut host = FileHost::new(&gcode);
        let mut count = Count::default();
        let outcome = run(&Settings::prototype(), None, &mut host, &mut count).unwrap();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        assert!(host.is_done() && !outcome.halted, "{name} did not finish");
        assert!(host.failure().is_none(), "{name}: {:?}", host.failure());
        assert_eq!(outcome.underruns, 0, "{name}");
        let [n1, n4, n8, n11, z1, z2, ..] = outcome.counts;
        assert_eq!((n1, n4, z1), (-n8, -n11, z2), "{name}");
        println!("{name}: {} events, {} moves, {:.0} s", count.events, outcome.moves, outcome.ticks as f64 / 1e7);
    }
}

/// The head of a file, and its end without motion: a print that heats and ends as the whole one does. Slicers put their
/// settings behind the end, as comments.
fn short_print(gcode: &str, lines: usize) -> String {
    let is_motion = |line: &&str| ["G0", "G1", "G2", "G3"].iter().any(|code| line.starts_with(code));
    let rest: Vec<_> = gcode.lines().skip(lines).filter(|line| !line.is_empty() && !line.starts_with(';')).collect();
    let end = rest.iter().skip(rest.len().saturating_sub(60)).copied().filter(|line| !is_motion(line));
    gcode.lines().take(lines).chain(end).collect::<Vec<_>>().join("\n")
}

/// The second print comes at once, after a moment, and when the heaters have cooled.
#[test]
fn the_head_of_every_sliced_file_prints_twice_on_one_printer_that_heats() {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    for file in sliced_files() {
        // A minute.
        let print = short_print(&std::fs::read_to_string(&file).unwrap(), 400);
        for between in ["", "G4 S20", "M104 S0\nM140 S0\nM109 R60"] {
            let mut host = FileHost::new(&format!("{print}\n{between}\n{print}\n"));
            let outcome = run(&settings, None, &mut host, &mut Count::default()).unwrap();
            let name = file.file_name().unwrap().to_string_lossy().into_owned();
            assert!(host.failure().is_none(), "{name} {between:?}: {:?}", host.failure());
            assert!(host.is_done() && !outcome.halted, "{name} {between:?} did not finish");
        }
    }
}

/// All events.
#[derive(Default)]
struct Events(Vec<(u64, MotorSet, MotorSet)>);

impl Sink for Events {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.0.push((tick, steps, MotorSet(forward.0 & steps.0)));
    }
}

impl Events {
    /// The last `count` of the first `length` events, with the ticks before the last of them.
    fn tail(&self, length: usize, count: usize) -> impl Iterator<Item = (u64, MotorSet, MotorSet)> {
        let end = self.0[length - 1].0;
        self.0[length - count..length].iter().map(move |&(tick, steps, forward)| (end - tick, steps, forward))
    }
}

/// Prints a file, which must come to its end.
fn print(name: &str, settings: &Settings, gcode: &str) -> Events {
    let mut host = FileHost::new(gcode);
    let mut events = Events::default();
    let outcome = run(settings, None, &mut host, &mut events).unwrap();
    assert!(host.failure().is_none(), "{name}: {:?}", host.failure());
    assert!(host.is_done() && !outcome.halted, "{name} did not finish");
    events
}

/// Modes that a file without words for them takes as it finds them.
const MODES: &str = "G21\nG90\nM82\nG92 E0\n";

/// The window of the pressure advance, which a file that sets it leaves behind: M502 brings back the one that the first
/// print began with.
const LEFT_BEHIND: &str = "M572 W";

/// The second print makes the steps of the first one at the same relative times, within a tick of rounding. That holds
/// from the end of the homing on, which begins where the first print has ended.
#[test]
fn examples_and_the_clients_file_that_heats_print_the_same_twice_on_one_printer() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let examples = std::fs::read_dir(root.join("examples")).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<_> = examples.filter(|file| file.extension().is_some_and(|e| e == "gcode")).collect();
    assert!(files.len() > 10);
    let mut prints: Vec<_> = files.into_iter().map(|file| (file, Settings::prototype())).collect();
    let heated = machine_file::read(&root.join("xtask/clients/heat.toml")).unwrap().settings;
    prints.push((root.join("xtask/clients/heat.gcode"), heated));
    for (file, settings) in prints {
        let gcode = std::fs::read_to_string(&file).unwrap();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let homing = gcode.find("\nG28").unwrap() + "\nG28\n".len();
        let length = |gcode: &str| print(&name, &settings, gcode).0.len();
        let (homed, once) = (length(&gcode[..homing]), length(&gcode));
        let settings_again = if gcode.contains(LEFT_BEHIND) { "M502\n" } else { "" };
        let twice = print(&name, &settings, &format!("{gcode}\n{settings_again}{MODES}{gcode}"));
        let count = once - homed;
        assert!(count > 1000 && twice.0.len() > once + count, "{name}");
        let pairs = twice.tail(once, count).zip(twice.tail(twice.0.len(), count));
        for (n, (first, second)) in pairs.enumerate() {
            let is_same = first.0.abs_diff(second.0) <= 1 && (first.1, first.2) == (second.1, second.2);
            assert!(is_same, "{name}, event {n} behind the homing: {first:?}, and the second time {second:?}");
        }
        println!("{name}: {count} of {once} events come again");
    }
}

/// The other file that clients print, if the folder with sliced files is there. Without it they print an example.
#[test]
fn the_clients_sliced_file_prints_whole_twice_on_one_printer() {
    let file = sliced_files().into_iter().find(|file| file.ends_with("prusaslicer292_cubehelix_small.gcode"));
    let Some(file) = file else { return };
    let print = std::fs::read_to_string(&file).unwrap();
    let mut host = FileHost::new(&format!("{print}\n{print}"));
    let mut count = Count::default();
    let outcome = run(&Settings::prototype(), None, &mut host, &mut count).unwrap();
    assert!(host.failure().is_none(), "{:?}", host.failure());
    assert!(host.is_done() && !outcome.halted && outcome.underruns == 0);
    println!("{} events, {} moves, {:.0} s", count.events, outcome.moves, outcome.ticks as f64 / 1e7);
}
