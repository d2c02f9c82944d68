//! The exchanges of `tests/protocol`, with the whole firmware.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::script::Script;
use corehbot_sim::world::{Sink, run};
use std::path::Path;

struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

#[test]
fn every_exchange_goes_as_it_is_written() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/protocol");
    let mut failures = Vec::new();
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "txt") {
            continue;
        }
        count += 1;
        let mut script = Script::new(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let end = run(&Settings::prototype(), Some([Mm::ZERO; 3]), &mut script, &mut Deaf).err();
        let failure = script.failure().or_else(|| end.map(|error| error.to_string()));
        failures.extend(failure.map(|why| format!("{}: {why}", path.file_name().unwrap().display())));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(count >= 15, "only {count} files");
}
