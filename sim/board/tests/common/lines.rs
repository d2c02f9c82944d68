//! A host that sends a line for each `ok`, and records the replies.

use corehbot_sim::world::Host;

pub struct Lines {
    lines: Vec<String>,
    next: usize,
    oks: usize,
    pub heard: Vec<String>,
}

impl Lines {
    pub fn new(lines: Vec<String>) -> Self {
        Self { lines, next: 0, oks: 0, heard: Vec::new() }
    }
}

impl Host for Lines {
    fn send(&mut self, out: &mut Vec<u8>) {
        if let Some(line) = self.lines.get(self.next).filter(|_| self.oks == self.next) {
            out.extend(line.bytes());
            out.push(b'\n');
            self.next += 1;
        }
    }

    fn hear(&mut self, line: &str) {
        self.oks += usize::from(line.starts_with("ok"));
        self.heard.push(line.to_owned());
    }

    fn is_done(&self) -> bool {
        self.oks == self.lines.len()
    }
}
