//! Eight motors: the trace of a machine with a third screw has a column more, and else is the prototype's.

use super::print::machines;
use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot_sim::host::FileHost;
use corehbot_sim::trace::{Header, TraceWriter};
use corehbot_sim::world::{Sink, run};

struct Trace<'t>(TraceWriter<&'t mut Vec<u8>>);

impl Sink for Trace<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.0.event(tick, steps, forward);
    }
}

/// The rows of a machine's trace, the header first.
fn trace(s: &Settings) -> Vec<String> {
    let mut bytes = Vec::new();
    let mut trace = Trace(TraceWriter::new(Some(&mut bytes), Header::from(s)));
    let mut host = FileHost::new("G28\nG1 X40 Y25 Z3 E2 F6000\nG2 X60 Y45 I20 J0\nG1 Z1 F300\nM400\n");
    let outcome = run(s, None, &mut host, &mut trace).unwrap();
    assert!(!outcome.halted);
    trace.0.finish().unwrap();
    let text = String::from_utf8(bytes).unwrap();
    text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect()
}

#[test]
fn a_third_screw_is_an_eighth_column_that_turns_as_the_others_do() {
    let machines = machines();
    let of = |name: &str| trace(&machines.iter().find(|(file, _)| file == name).unwrap().1);
    let (with, without) = (of("corehbot-three-screws"), of("prototype"));
    assert_eq!(with[0], "tick,m1,m4,m8,m11,z1,z2,e0,z3");
    assert_eq!(without[0], "tick,m1,m4,m8,m11,z1,z2,e0");
    let mut raised = 0;
    for (row, expected) in with.iter().zip(&without).skip(1) {
        let (others, third) = row.rsplit_once(',').unwrap();
        assert_eq!(others, expected);
        assert_eq!(Some(third), others.split(',').nth(5), "{row}");
        raised += third.parse::<i32>().unwrap().abs();
    }
    assert!(with.len() == without.len() && raised > 1000, "{} rows, {raised} steps of z", with.len());
}
