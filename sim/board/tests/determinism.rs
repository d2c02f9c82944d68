//! Same input, same steps: how bytes are cut into packets, and delays that do not run the queue dry, do not
//! change the trace.

use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Host, Outcome, Sink, run};
use proptest::prelude::*;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

/// Keeps a hash of every event.
#[derive(Default)]
struct Print(DefaultHasher, u64);

impl Sink for Print {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        (tick, steps, forward).hash(&mut self.0);
        self.1 += 1;
    }
}

/// A host at a line that delivers bytes in pieces, sometimes nothing for a while.
struct Line {
    host: FileHost,
    held: Vec<u8>,
    /// Sizes of the pieces, over and over; 0 is a pause.
    pieces: Vec<u8>,
    turn: usize,
}

impl Host for Line {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.held.is_empty() {
            self.host.send(&mut self.held);
        }
        let piece = self.pieces[self.turn % self.pieces.len()];
        self.turn += 1;
        let size = usize::from(piece).min(self.held.len());
        out.extend(self.held.drain(..size));
    }

    fn hear(&mut self, line: &str) {
        self.host.hear(line);
    }

    fn is_done(&self) -> bool {
        self.host.is_done()
    }
}

fn print(gcode: &str, pieces: Option<Vec<u8>>) -> (Outcome, u64, u64) {
    let mut sink = Print::default();
    let host = FileHost::new(gcode);
    let settings = Settings::prototype();
    let outcome = match pieces {
        None => {
            let mut host = host;
            run(&settings, None, &mut host, &mut sink)
        }
        Some(pieces) => {
            let mut line = Line { host, held: Vec::new(), pieces, turn: 0 };
            run(&settings, None, &mut line, &mut sink)
        }
    };
    (outcome.unwrap(), sink.0.finish(), sink.1)
}

fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name);
    std::fs::read_to_string(path).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn packets_and_pauses_leave_no_trace(
        pieces in proptest::collection::vec(prop_oneof![1 => Just(0u8), 30 => 1..=60u8], 1..40),
        file in prop_oneof![
            Just("tiny.gcode"), Just("circle.gcode"), Just("reversals.gcode"), Just("retractions.gcode"),
        ],
    ) {
        prop_assume!(pieces.iter().any(|p| *p > 0));
        let gcode = example(file);
        let (whole, whole_hash, events) = print(&gcode, None);
        let (cut, cut_hash, _) = print(&gcode, Some(pieces));
        prop_assert!(events > 1000);
        prop_assume!(cut.underruns == 0);
        prop_assert_eq!(whole_hash, cut_hash);
        prop_assert_eq!(whole.counts, cut.counts);
        prop_assert_eq!(whole.ticks, cut.ticks);
    }
}

/// The same with bytes one by one, which is as cut as it gets.
#[test]
fn a_print_sent_byte_by_byte_is_the_same_print() {
    let gcode = example("first-print.gcode");
    let (whole, whole_hash, _) = print(&gcode, None);
    let (cut, cut_hash, _) = print(&gcode, Some(vec![1]));
    assert_eq!(cut.underruns, 0);
    assert_eq!((whole.ticks, whole_hash), (cut.ticks, cut_hash));
}

/// A look-ahead that is full of moves which all still accelerate lets some of them go unfinished. Which ones
/// must not depend on how soon the queue after it has room.
#[test]
fn moves_that_leave_unfinished_are_the_same_for_slow_hosts() {
    for count in [288, 300, 350, 415] {
        let moves: String = (1..=count).map(|i| format!("G1 X{:.1} F18000\n", f64::from(i) * 0.9)).collect();
        let gcode = format!("G28\nM201 X100 Y100\nM204 S100\n{moves}M400\n");
        let (whole, whole_hash, _) = print(&gcode, None);
        assert_eq!(whole.underruns, 0);
        let mut clean = 0;
        for pauses in 1..8usize {
            let pieces = std::iter::repeat_n(0u8, pauses).chain([60]).collect();
            let (slow, slow_hash, _) = print(&gcode, Some(pieces));
            if slow.underruns == 0 {
                clean += 1;
                assert_eq!((whole.ticks, whole_hash), (slow.ticks, slow_hash), "{count} moves, {pauses} pauses");
            }
        }
        assert!(clean >= 3, "{count} moves: only {clean} hosts were fast enough");
    }
}

/// Running the queue dry is another thing: it shows, and it is counted.
#[test]
fn a_host_that_is_too_slow_is_counted() {
    let gcode = example("tiny.gcode");
    let pauses = [0u8; 60].into_iter().chain([60; 3]).collect();
    let (slow, _, _) = print(&gcode, Some(pauses));
    let (whole, _, _) = print(&gcode, None);
    assert!(slow.underruns > 0);
    assert_eq!(slow.counts, whole.counts, "late, but not lost");
}
