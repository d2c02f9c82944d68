//! The exchanges of `tests/protocol`, with the whole firmware.

use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::script::{Script, scripts};
use corehbot_sim::world::{Sink, run};
use std::path::Path;

struct Deaf;

impl Sink for Deaf {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

#[test]
fn every_exchange_goes_as_it_is_written() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/protocol");
    let scripts = scripts(&folder).unwrap();
    let mut failures = Vec::new();
    for (name, text) in &scripts {
        let mut script = Script::new(text).unwrap();
        let end = run(&Settings::prototype(), Some([Mm::ZERO; 3]), &mut script, &mut Deaf).err();
        let failure = script.failure().or_else(|| end.map(|error| error.to_string()));
        failures.extend(failure.map(|why| format!("{name}: {why}")));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(scripts.len() >= 21, "only {} files", scripts.len());
}
