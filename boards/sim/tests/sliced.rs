//! Real sliced files, if the folder with them stands beside the checkout, print to their end.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::connectors::Heater;
use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Host, Sink, run};
use std::path::{Path, PathBuf};

/// Counts events and holds them to the belt's law.
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

#[test]
fn every_sliced_file_prints_to_its_end() {
    for file in sliced_files() {
        let gcode = std::fs::read_to_string(&file).unwrap();
        let mut host = FileHost::new(&gcode);
        let mut count = Count::default();
        let outcome = run(&Settings::prototype(), None, &mut host, &mut count).unwrap();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        assert!(host.is_done() && !outcome.halted, "{name} did not finish");
        assert!(host.failure().is_none(), "{name}: {:?}", host.failure());
        assert_eq!(outcome.underruns, 0, "{name}");
        let [n1, n4, n8, n11, z1, z2, _] = outcome.counts;
        assert_eq!((n1, n4, z1), (-n8, -n11, z2), "{name}");
        println!("{name}: {} events, {} moves, {:.0} s", count.events, outcome.moves, outcome.ticks as f64 / 1e7);
    }
}

/// The head of a file, and of its end what is no motion: a print of a minute that heats and ends as the whole one does.
fn short_print(gcode: &str) -> String {
    let lines: Vec<_> = gcode.lines().collect();
    let is_motion = |line: &&str| ["G0", "G1", "G2", "G3"].iter().any(|code| line.starts_with(code));
    let head = lines.iter().take(400).copied();
    let tail = lines.iter().skip(400.max(lines.len().saturating_sub(60))).filter(|line| !is_motion(line)).copied();
    head.chain(tail).collect::<Vec<_>>().join("\n")
}

/// The second print comes at once, after a moment, and when the heaters have cooled.
#[test]
fn the_head_of_every_sliced_file_prints_twice_on_one_printer_that_heats() {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    for file in sliced_files() {
        let print = short_print(&std::fs::read_to_string(&file).unwrap());
        for between in ["", "G4 S20", "M104 S0\nM140 S0\nM109 R60"] {
            let mut host = FileHost::new(&format!("{print}\n{between}\n{print}\n"));
            let outcome = run(&settings, None, &mut host, &mut Count::default()).unwrap();
            let name = file.file_name().unwrap().to_string_lossy().into_owned();
            assert!(host.failure().is_none(), "{name} {between:?}: {:?}", host.failure());
            assert!(host.is_done() && !outcome.halted, "{name} {between:?} did not finish");
        }
    }
}
