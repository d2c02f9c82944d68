//! Every machine file, and a print on one with every step checked.

use corehbot::motors::{MOTORS, Motor, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file as machine_file;
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::host::FileHost;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Host as _, Outcome, Sink, run};
use std::path::Path;

/// Every machine file, by name.
pub fn machines() -> Vec<(String, Settings)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    // The schema is in the same folder.
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    let named = files.into_iter().map(|file| {
        let machine = machine_file::parse(&std::fs::read_to_string(&file).unwrap());
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let machine = machine.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(machine.name.is_some(), "{name}");
        (name, machine.settings)
    });
    named.collect()
}

/// Checks every step, and counts.
pub struct Steps {
    pub checker: Checker,
    pub counts: [i64; MOTORS],
    pub events: u64,
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.checker.event(tick, steps, forward);
        for (motor, count) in Motor::ALL.into_iter().zip(&mut self.counts) {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
        self.events += u64::from(!steps.is_empty());
    }

    fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }
}

pub struct Print {
    pub outcome: Outcome,
    pub counts: [i64; MOTORS],
    pub events: u64,
    pub findings: Findings,
}

pub fn print(s: &Settings, start: Option<[Mm; 3]>, gcode: &str) -> Print {
    let checker = Checker::new(s, &Limits::new(s, None, gcode));
    let mut steps = Steps { checker, counts: [0; MOTORS], events: 0 };
    let mut host = FileHost::new(gcode);
    let outcome = run(s, start, &mut host, &mut steps).unwrap();
    assert!(host.is_done() && host.failure().is_none() && !outcome.halted, "{:?}", host.failure());
    let Steps { checker, counts, events } = steps;
    Print { findings: checker.finish(Some(outcome.counts)), outcome, counts, events }
}

/// A position in whole steps.
pub fn steps_of(s: &Settings, position: [f64; 4]) -> [i64; 4] {
    let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
    std::array::from_fn(|i| (position[i] * pitch[i]).round() as i64)
}
