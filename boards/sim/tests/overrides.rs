//! M220: how long it takes until a change of the feed override reaches the tool.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motion::WINDOW;
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::{Host, Sink, run};
use std::cell::Cell;

/// Watches the speed along x, averaged over 2 ms.
struct Speed<'a> {
    tick: &'a Cell<u64>,
    slow_at: &'a Cell<Option<u64>>,
    changed_at: &'a Cell<Option<u64>>,
    window: (u64, u32),
}

impl Sink for Speed<'_> {
    fn event(&mut self, tick: u64, steps: MotorSet, _forward: MotorSet) {
        self.tick.set(tick);
        let (since, count) = self.window;
        let count = count + u32::from(steps.has(Motor::M8));
        if tick - since < 20_000 {
            self.window = (since, count);
            return;
        }
        let speed = f64::from(count) / 80.0 / ((tick - since) as f64 / 1e7);
        if self.changed_at.get().is_some() && self.slow_at.get().is_none() && speed < 60.0 {
            self.slow_at.set(Some(tick));
        }
        self.window = (tick, 0);
    }
}

/// Sends moves of one length, one for each ok, and once M220.
struct Stream<'a> {
    length: f64,
    x: f64,
    tick: &'a Cell<u64>,
    changed_at: &'a Cell<Option<u64>>,
    awaiting: u32,
    is_done: bool,
}

impl Host for Stream<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting > 0 || self.is_done {
            return;
        }
        self.x += self.length;
        if self.x < 380.0 {
            out.extend(format!("G1 X{:.3} F6000\n", self.x).bytes());
        } else {
            self.is_done = true;
            out.extend(b"M400\n");
        }
        self.awaiting += 1;
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.changed_at.get().is_none() && self.tick.get() > 10_000_000 {
            self.changed_at.set(Some(self.tick.get()));
            out.extend(b"M220 S50\n");
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        if line.starts_with("ok") {
            self.awaiting -= 1;
        }
    }

    fn is_done(&self) -> bool {
        self.is_done && self.awaiting == 0
    }
}

#[test]
fn an_override_reaches_the_tool_behind_the_moves_that_are_planned() {
    for length in [0.1, 0.2, 0.5, 1.0] {
        let (tick, slow_at, changed_at) = (Cell::new(0), Cell::new(None), Cell::new(None));
        let mut host = Stream { length, x: 0.0, tick: &tick, changed_at: &changed_at, awaiting: 0, is_done: false };
        let mut speed = Speed { tick: &tick, slow_at: &slow_at, changed_at: &changed_at, window: (0, 0) };
        let start = Some([0, 100, 10].map(Mm::from_num));
        run(&Settings::prototype(), start, &mut host, &mut speed).unwrap();
        let ms = (slow_at.get().unwrap() - changed_at.get().unwrap()) as f64 / 1e4;
        // The window, the 32 moves of the queue behind it and what is made, at 100 mm/s; and a ramp.
        let planned = (WINDOW as f64 + 32.0) * length / 100.0 * 1e3;
        println!("moves of {length} mm: {ms:.0} ms, {planned:.0} ms are planned");
        assert!(ms < planned + 40.0, "{length}: {ms} ms");
    }
}
