//! A host that sends lines without numbers, each when the previous one was answered.

use corehbot_sim::world::Host;

/// Sends a file.
pub struct PlainHost {
    /// Lines still to be sent, the last line first.
    lines: Vec<String>,
    is_awaiting_ok: bool,
}

impl PlainHost {
    /// A host that will send `gcode` and wait for the motion.
    pub fn new(gcode: &str) -> Self {
        let lines = gcode.lines().chain(["M400"]).rev().map(|line| format!("{line}\n")).collect();
        Self { lines, is_awaiting_ok: false }
    }
}

impl Host for PlainHost {
    fn send(&mut self, out: &mut Vec<u8>) {
        if !self.is_awaiting_ok
            && let Some(line) = self.lines.pop()
        {
            out.extend_from_slice(line.as_bytes());
            self.is_awaiting_ok = true;
        }
    }

    fn hear(&mut self, line: &str) {
        if line.trim().starts_with("ok") {
            self.is_awaiting_ok = false;
        }
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && !self.is_awaiting_ok
    }
}
