//! Emergencies in every state: whatever the machine does or waits for, M112, M410 and M108 act as they arrive.

use corehbot::connectors::ConnectorName;
use corehbot::motors::MotorSet;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_sim::world::{Host, Outcome, Sink, run};
use std::cell::Cell;

/// The tick of the last step.
struct Last<'a>(&'a Cell<u64>);

impl Sink for Last<'_> {
    fn event(&mut self, tick: u64, _steps: MotorSet, _forward: MotorSet) {
        self.0.set(tick);
    }
}

/// Sends everything at once. Says the word at a place in motion time, or when the printer reports that it is busy. Asks
/// for the position when all is answered.
struct Shouter<'a> {
    last: &'a Cell<u64>,
    text: String,
    word: &'static str,
    at: u64,
    said: Option<u64>,
    awaiting: usize,
    has_asked: bool,
    heard: Vec<String>,
}

impl Host for Shouter<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if !self.text.is_empty() {
            self.awaiting += self.text.matches('\n').count();
            out.extend(std::mem::take(&mut self.text).bytes());
        } else if self.said.is_some() && self.awaiting == 0 && !self.has_asked {
            self.has_asked = true;
            self.awaiting = 2;
            out.extend(b"M114 R\nM114\n");
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        let is_busy = self.heard.iter().any(|line| line.starts_with("echo:busy"));
        if self.said.is_none() && self.text.is_empty() && (is_busy || self.last.get() >= self.at) {
            self.said = Some(self.last.get());
            out.extend(self.word.bytes());
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        if line.starts_with("ok") {
            self.awaiting -= 1;
        }
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.has_asked && self.awaiting == 0
    }
}

/// A state of the machine, the program that leads there, and the motion time of the state in ms. The time is "never" if
/// the busy message shows the state.
const STATES: [(&str, &str, u64); 13] = [
    ("moving", "G1 X200 F6000\nM114\n", 400),
    ("moving with many lines waiting", "", 400),
    ("waiting for the motion", "G1 X380 F6000\nM400\n", 900),
    ("homing fast", "G28 X\n", 900),
    ("homing slowly", "G28 X\n", 2900),
    ("homing after another axis", "G28\n", 3900),
    ("a probe going down fast", "G30\n", 1500),
    ("a probe going down slowly", "G30\n", 5000),
    ("one motor alone", "STEPPER_BUZZ STEPPER=m1\n", 100),
    ("shaking the tool", "TEST_RESONANCES\n", 3000),
    ("dwelling", "G4 S30\nG1 X110\n", u64::MAX),
    ("waiting for the user", "M600\nG1 X110\n", u64::MAX),
    ("waiting for the user for a time", "M0 S30\n", u64::MAX),
];

/// The state after the word.
struct Aftermath {
    outcome: Outcome,
    heard: Vec<String>,
    /// Motion time from the word to the last step.
    ms: f64,
}

fn shout(state: (&str, &str, u64), word: &'static str) -> Aftermath {
    let (_, text, at) = state;
    let many: String = (0..40).map(|i| format!("G1 X{} Y{}\n", 110 + i % 2, 100 + i)).collect();
    let text = if text.is_empty() { format!("G1 F1200\n{many}") } else { text.to_owned() };
    let last = Cell::new(0);
    let at = at.saturating_mul(10_000);
    let mut host =
        Shouter { last: &last, text, word, at, said: None, awaiting: 0, has_asked: false, heard: Vec::new() };
    let start = Some([100, 100, 10].map(Mm::from_num));
    let mut s = Settings::prototype();
    if state.0.contains("probe") {
        (s.probe_plug.connector, s.probe.kind) = (ConnectorName::lit("PROBE"), ProbeKind::Switch);
    }
    let outcome = run(&s, start, &mut host, &mut Last(&last)).unwrap();
    let ms = (last.get() - host.said.unwrap()) as f64 / 1e4;
    Aftermath { outcome, heard: host.heard, ms }
}

#[test]
fn an_emergency_stop_acts_in_every_state() {
    for state in STATES {
        let after = shout(state, "M112");
        assert!(after.outcome.halted, "{state:?}");
        assert!(after.heard.last().unwrap().starts_with("Error:Printer halted. kill() called!"), "{state:?}");
        // The Console is polled once a millisecond, and the time is counted from the step before the word.
        assert!(after.ms <= 1.5, "{state:?}: {} ms", after.ms);
    }
}

#[test]
fn a_quick_stop_acts_in_every_state_and_every_line_is_answered() {
    for state in STATES {
        let after = shout(state, "M410");
        assert!(!after.outcome.halted, "{state:?}");
        // In a touch the tool rises from the bed, at z's own speed.
        let most_ms = if state.0.contains("probe") { 400.0 } else { 50.0 };
        assert!(after.ms <= most_ms, "{state:?}: {} ms", after.ms);
        let positions: Vec<_> = after.heard.iter().rev().filter(|line| line.starts_with("X:")).take(2).collect();
        assert_eq!(positions[0], positions[1], "{state:?}");
    }
}

#[test]
fn going_on_ends_waits_and_nothing_else() {
    for state in STATES {
        let after = shout(state, "M108");
        let (name, ..) = state;
        let waits = name.contains("dwelling") || name.contains("user");
        assert!(!after.outcome.halted, "{name}");
        assert!(!waits || after.outcome.ticks < 60_000_000, "{name}: {} ticks", after.outcome.ticks);
        if name == "waiting for the motion" {
            assert!(after.heard.iter().any(|line| line.starts_with("X:380.00")), "{:?}", after.heard);
        }
        if name.starts_with("homing") {
            assert!(after.heard.iter().any(|line| line.starts_with("X:0.00")), "{name}: {:?}", after.heard);
        }
    }
}
