//! Hosts as in their sources, within the line protocol.

use super::machine::numbered;

/// A host that prints a program.
pub trait Host {
    /// Takes one line.
    fn hear(&mut self, line: &str);
    /// The line that it sends now, if it does.
    fn speak(&mut self, ms: u32) -> Option<String>;
    /// Whether all of the program was sent and answered.
    fn is_done(&self) -> bool;
    /// Whether it has just given up waiting for an answer.
    fn has_lost_patience(&self) -> bool {
        false
    }
}

/// The first number of a resend request.
pub fn requested(line: &str) -> Option<i32> {
    line.strip_prefix("Resend: ").and_then(|number| number.parse().ok())
}

/// The time that a host takes before each new line of its program.
pub struct Pauses(pub Vec<u32>);

impl Pauses {
    pub fn before(&self, line: usize) -> u32 {
        self.0.get(line).copied().unwrap_or(0)
    }
}

/// Printrun 2.2.0, printcore.py: `_listen`, `_sendnext` and `_send`, after the M110 of `startprint`.
pub struct Printcore {
    program: Vec<String>,
    pauses: Pauses,
    clear: bool,
    lineno: i32,
    resendfrom: i32,
    /// A callback is running, and then the next line is sent.
    busy_until: Option<u32>,
}

impl Printcore {
    pub fn new(program: Vec<String>, pauses: Pauses) -> Self {
        Self { program, pauses, clear: true, lineno: 0, resendfrom: -1, busy_until: None }
    }

    fn line(&self, number: i32) -> String {
        numbered(number, &self.program[number as usize])
    }
}

impl Host for Printcore {
    fn hear(&mut self, line: &str) {
        self.clear |= line.starts_with("ok");
        if let Some(number) = requested(line) {
            self.resendfrom = number;
            self.clear = true;
        }
    }

    fn speak(&mut self, ms: u32) -> Option<String> {
        if self.busy_until.is_none() {
            if !self.clear || self.is_done() {
                return None;
            }
            self.clear = false;
            if self.resendfrom < self.lineno && self.resendfrom > -1 {
                self.resendfrom += 1;
                return Some(self.line(self.resendfrom - 1));
            }
            self.resendfrom = -1;
            self.busy_until = Some(ms + self.pauses.before(self.lineno as usize));
        }
        if self.busy_until.is_some_and(|until| ms < until) {
            return None;
        }
        self.busy_until = None;
        self.lineno += 1;
        Some(self.line(self.lineno - 1))
    }

    fn is_done(&self) -> bool {
        let is_repeating = self.resendfrom < self.lineno && self.resendfrom > -1;
        self.lineno as usize == self.program.len() && self.clear && !is_repeating
    }
}

/// A host that has several lines under way, starts again at a requested line, and then counts from there.
pub struct Windowed {
    program: Vec<String>,
    window: usize,
    next: usize,
    under_way: usize,
}

impl Windowed {
    pub const fn new(program: Vec<String>, window: usize) -> Self {
        Self { program, window, next: 0, under_way: 0 }
    }
}

impl Host for Windowed {
    fn hear(&mut self, line: &str) {
        if let Some(number) = requested(line) {
            (self.next, self.under_way) = (number as usize, 0);
        } else if line.starts_with("ok") {
            self.under_way = self.under_way.saturating_sub(1);
        }
    }

    fn speak(&mut self, _ms: u32) -> Option<String> {
        if self.under_way >= self.window || self.next == self.program.len() {
            return None;
        }
        self.under_way += 1;
        self.next += 1;
        Some(numbered(self.next as i32 - 1, &self.program[self.next - 1]))
    }

    fn is_done(&self) -> bool {
        self.next == self.program.len() && self.under_way == 0
    }
}
