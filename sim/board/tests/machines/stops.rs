//! Stops between positions: the reported place is where the motors are.

use super::print::{Steps, machines};
use corehbot::motors::{MOTORS, MotorSet};
use corehbot::units::Mm;
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Host, Sink, run};
use std::cell::Cell;
use std::collections::VecDeque;

/// Stops slanted moves by M410 wherever they are, and asks for the position each time.
struct Stopper<'t> {
    lines: VecDeque<String>,
    /// Events so far, and at how many the next stop comes.
    events: &'t Cell<u64>,
    stop: u64,
    stops: u64,
    is_under_way: bool,
    awaiting: u32,
    heard: Vec<String>,
}

impl Host for Stopper<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting > 0 {
            return;
        }
        if let Some(line) = self.lines.pop_front() {
            if line.starts_with("G1 X1") || line.starts_with("G1 X3") {
                self.stops += 1;
                (self.stop, self.is_under_way) = (self.events.get() + 700 + 97 * self.stops, true);
            }
            out.extend(line.bytes());
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.is_under_way && self.events.get() >= self.stop {
            self.is_under_way = false;
            self.awaiting += 1;
            out.extend(b"M410\n");
        }
    }

    fn hear(&mut self, line: &str) {
        self.awaiting -= u32::from(line.starts_with("ok"));
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && self.awaiting == 0
    }
}

/// A sink that counts how many events there were.
pub struct Counted<'t>(pub Steps, pub &'t Cell<u64>);

impl Sink for Counted<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.0.event(tick, steps, forward);
        self.1.set(self.0.events);
    }

    fn stopped(&mut self, tick: u64) {
        self.0.stopped(tick);
    }
}

/// After a quick stop the motors of a slanted move stand between positions. The reported place is the true one, and no
/// error adds up over many stops.
#[test]
fn quick_stops_leave_the_position_true() {
    for (name, s) in machines() {
        let mut limits = Limits::new(&s, None, "");
        limits.of.iter_mut().for_each(|limit| (limit.hard_stop, limit.hard_stop_up) = (0.0, 0.0));
        let events = Cell::new(0);
        let mut counted =
            Counted(Steps { checker: Checker::new(&s, &limits), counts: [0; MOTORS], events: 0 }, &events);
        let mut lines = VecDeque::new();
        for i in 0..20 {
            let slanted = if i % 2 == 0 { "G1 X150 Y170.37 Z9.123 F6000" } else { "G1 X31 Y12.37 Z2.123 F6000" };
            lines.extend([slanted, "M400", "M114 R"].map(str::to_owned));
        }
        // An axis alone counts from wherever the last stop was.
        lines.extend(["G91", "G1 Y7 F3000", "M400", "M114 R"].map(str::to_owned));
        let heard = Vec::new();
        let mut host = Stopper { lines, events: &events, stop: 0, stops: 0, is_under_way: false, awaiting: 0, heard };
        let start = [60.0, 60.0, 5.0];
        let outcome = run(&s, Some(start.map(Mm::from_num)), &mut host, &mut counted).unwrap();
        let Counted(Steps { checker, counts, .. }, _) = counted;
        assert_eq!(checker.finish(Some(outcome.counts)), Findings::default(), "{name}");
        let positions: Vec<&String> = host.heard.iter().filter(|line| line.starts_with("X:")).collect();
        assert_eq!(positions.len(), 21, "{name}");
        let stopped = positions.iter().filter(|line| !line.contains("X:150.0 ") && !line.contains("X:31.00 ")).count();
        assert!(stopped > 15, "{name}: {positions:?}");
        let back =
            s.mechanism.forward_kinematics().unwrap().fractions(&counts).map(|(sum, over)| sum as f64 / over as f64);
        let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
        let mut last = positions[20].split([' ', ':']);
        for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            assert_eq!(last.next(), Some(letter), "{name}");
            let said: f64 = last.next().unwrap().parse().unwrap();
            let real = start[axis] + back[axis] / pitch[axis];
            assert!((said - real).abs() < 0.00501, "{name}: {letter}{said} is said, the motors say {real}");
        }
    }
}
