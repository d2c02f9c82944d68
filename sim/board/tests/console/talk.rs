//! A host that says one line after the other, and records the replies and the motors' steps.

use corehbot::motors::MotorSet;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::{Host, Outcome, Sink, run, run_with};
use std::collections::VecDeque;

#[derive(Default)]
pub struct Steps {
    pub count: u64,
    pub last: u64,
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, _steps: MotorSet, _forward: MotorSet) {
        self.count += 1;
        self.last = tick;
    }
}

/// Sends each line when the previous one is answered. A line that begins with `!` goes out together with the previous
/// one. A line that begins with `~` goes out when the printer has said that it is busy with that.
pub struct Talk {
    pub lines: VecDeque<String>,
    pub awaiting: u32,
    pub heard: Vec<String>,
    pub is_busy: bool,
}

impl Talk {
    pub fn new(lines: &[&str]) -> Self {
        let lines = lines.iter().map(|l| (*l).to_owned()).collect();
        Self { lines, awaiting: 0, heard: Vec::new(), is_busy: false }
    }
}

impl Host for Talk {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting > 0 {
            return;
        }
        if let Some(line) = self.lines.pop_front() {
            out.extend(line.as_bytes());
            out.push(b'\n');
            self.awaiting += 1;
            self.is_busy = false;
        }
        while self.lines.front().is_some_and(|l| l.starts_with('!')) {
            let line = self.lines.pop_front().unwrap();
            out.extend(&line.as_bytes()[1..]);
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.is_busy && self.lines.front().is_some_and(|l| l.starts_with('~')) {
            let line = self.lines.pop_front().unwrap();
            out.extend(&line.as_bytes()[1..]);
            out.push(b'\n');
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        self.is_busy |= line.starts_with("echo:busy");
        if line.starts_with("ok") {
            self.awaiting = self.awaiting.saturating_sub(1);
        }
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && self.awaiting == 0
    }
}

pub const HOMED: Option<[f64; 3]> = Some([0.0; 3]);

pub fn talk_to(settings: &Settings, start: Option<[f64; 3]>, lines: &[&str]) -> (Vec<String>, Outcome, Steps) {
    let mut host = Talk::new(lines);
    let mut steps = Steps::default();
    let start = start.map(|s| s.map(Mm::from_num));
    let outcome = run(settings, start, &mut host, &mut steps).unwrap();
    // The banner is not an answer.
    let heard = host.heard.into_iter().skip(2).collect();
    (heard, outcome, steps)
}

/// The answers of a homed machine at the origin, and its end.
pub fn talk(lines: &[&str]) -> (Vec<String>, Outcome, Steps) {
    talk_to(&Settings::prototype(), HOMED, lines)
}

/// The replies of a machine with storage to such lines, without the greeting, but with its report of the storage at the
/// start.
pub fn keep(eeprom: &mut Eeprom, settings: &Settings, lines: &[&str]) -> (Vec<String>, Outcome, Steps) {
    let mut host = Talk::new(lines);
    let mut steps = Steps::default();
    let outcome = run_with(settings, HOMED.map(|s| s.map(Mm::from_num)), eeprom, &mut [&mut host], &mut steps).unwrap();
    assert_eq!(host.heard[0], "start");
    (host.heard.into_iter().skip(2).collect(), outcome, steps)
}
