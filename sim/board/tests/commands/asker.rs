//! A host that sends lines one by one, and the replies.

use super::deaf::Deaf;
use corehbot::protocol::{BUSY, BUSY_PAUSED};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::{Host, run};

/// Sends lines one by one; with the first busy message comes M108.
pub struct Asker {
    pub lines: Vec<String>,
    pub next: usize,
    pub awaiting: u32,
    pub has_gone_on: bool,
    pub heard: Vec<String>,
}

impl Host for Asker {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting == 0 && self.next < self.lines.len() {
            out.extend(self.lines[self.next].bytes());
            out.push(b'\n');
            self.next += 1;
            self.awaiting = 1;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        let is_paused = self.heard.last().is_some_and(|line| line == BUSY_PAUSED);
        if is_paused && !core::mem::replace(&mut self.has_gone_on, true) {
            out.extend(b"M108\n");
            self.awaiting += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        if line.starts_with("ok") {
            self.awaiting = self.awaiting.saturating_sub(1);
        }
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.next == self.lines.len() && self.awaiting == 0
    }
}

/// The answers of a homed machine to `lines`, without its greeting and without [`BUSY`].
pub fn answers(lines: &[&str]) -> Vec<String> {
    answers_of(&Settings::prototype(), lines)
}

/// The same of a machine of `settings`.
pub fn answers_of(settings: &Settings, lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().map(|line| (*line).to_owned()).collect();
    let mut host = Asker { lines, next: 0, awaiting: 0, has_gone_on: false, heard: Vec::new() };
    let outcome = run(settings, Some([100, 100, 50].map(Mm::from_num)), &mut host, &mut Deaf).unwrap();
    assert!(!outcome.halted, "{:?}", host.lines);
    host.heard.into_iter().skip(2).filter(|line| line != BUSY).collect()
}

/// The answers of a machine that has not been homed.
pub fn before_homing(settings: &Settings, lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().map(|line| (*line).to_owned()).collect();
    let mut host = Asker { lines, next: 0, awaiting: 0, has_gone_on: false, heard: Vec::new() };
    run(settings, None, &mut host, &mut Deaf).unwrap();
    host.heard.into_iter().skip(2).filter(|line| line != "ok" && line != BUSY).collect()
}
