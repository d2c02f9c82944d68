//! Real sliced files, if the folder with them stands beside the checkout, print to their end.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Host, Sink, run};
use std::path::Path;

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

#[test]
fn every_sliced_file_prints_to_its_end() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/gcode");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("skipped: no folder with sliced files at ../shared/gcode");
        return;
    };
    let mut files: Vec<_> = entries.map(|e| e.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "gcode"));
    files.sort();
    assert!(!files.is_empty());
    for file in files {
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
