//! Hosts as their sources have them, as far as the line protocol goes.

use super::machine::numbered;
use std::collections::VecDeque;

/// A host that prints a program.
pub trait Host {
    /// Hears one line.
    fn hear(&mut self, line: &str);
    /// The line that it sends now, if it does.
    fn speak(&mut self, ms: u32) -> Option<String>;
    /// Whether all of the program was sent and answered.
    fn is_done(&self) -> bool;
}

/// The first number of a resend request.
fn requested(line: &str) -> Option<i32> {
    line.strip_prefix("Resend: ").and_then(|number| number.parse().ok())
}

/// How long a host takes before each new line of its program.
pub struct Pauses(pub Vec<u32>);

impl Pauses {
    fn before(&self, line: usize) -> u32 {
        self.0.get(line).copied().unwrap_or(0)
    }
}

/// Printrun 2.2.0, printcore.py: `_listen`, `_sendnext` and `_send`, behind the M110 of `startprint`.
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

/// OctoPrint 1.11.8, util/comm.py: `_monitor`, `_send_loop`, `_handle_ok`, `_handle_resend_request` and
/// `_resendNextCommand`, behind its M110. Its time-outs are left out: they must not be needed.
pub struct OctoPrint {
    program: Vec<String>,
    pauses: Pauses,
    next: usize,
    current_line: i32,
    last_lines: VecDeque<String>,
    resend_delta: Option<i32>,
    last_resend: Option<i32>,
    resend_count: i32,
    consecutive: (Option<i32>, u32),
    comm_error: Option<String>,
    send_queue: VecDeque<String>,
    resend_queue: VecDeque<(i32, String)>,
    /// Nothing but repetitions leaves.
    resend_active: bool,
    clear_to_send: i32,
    inbox: VecDeque<String>,
    /// The monitor hangs in a plugin, and then puts this into the queue.
    hanging: Option<(u32, String)>,
}

impl OctoPrint {
    pub fn new(program: Vec<String>, pauses: Pauses) -> Self {
        Self {
            program,
            pauses,
            next: 0,
            current_line: 1,
            last_lines: VecDeque::new(),
            resend_delta: None,
            last_resend: None,
            resend_count: 0,
            consecutive: (None, 0),
            comm_error: None,
            send_queue: VecDeque::new(),
            resend_queue: VecDeque::new(),
            resend_active: false,
            clear_to_send: 0,
            // The answer to its M110.
            inbox: VecDeque::from(["ok".to_owned()]),
            hanging: None,
        }
    }

    fn handle(&mut self, line: &str, ms: u32) {
        if let Some(number) = requested(line) {
            self.handle_resend_request(number);
        } else if line.starts_with("Error:") {
            self.comm_error = Some(line.to_lowercase());
        } else if line.starts_with("ok") {
            self.clear_to_send = (self.clear_to_send + 1).min(1);
            if self.resend_delta.is_some() {
                self.resend_next_command();
            } else if self.resend_queue.is_empty()
                && (self.resend_active || self.send_queue.is_empty())
                && let Some(line) = self.program.get(self.next)
            {
                self.hanging = Some((ms + self.pauses.before(self.next), line.clone()));
                self.next += 1;
            }
        }
    }

    fn handle_resend_request(&mut self, number: i32) {
        if self.resend_delta.is_none() && number == self.current_line {
            return;
        }
        let delta = self.current_line - number;
        let error = self.comm_error.take();
        if error.is_some_and(|error| error.contains("line number"))
            && self.last_resend == Some(number)
            && self.resend_delta.is_some()
            && self.resend_count < delta
        {
            self.resend_count += 1;
            return;
        }
        self.consecutive =
            if self.consecutive.0 == Some(number) { (Some(number), self.consecutive.1 + 1) } else { (Some(number), 0) };
        assert!(self.consecutive.1 < 10, "OctoPrint: printer keeps requesting line {number}");
        (self.resend_delta, self.last_resend, self.resend_count) = (Some(delta), Some(number), 0);
        self.check_possibility(delta);
        self.resend_active = true;
    }

    /// `SendQueue._get` and what `_send_loop` makes of it.
    fn next_in_queue(&mut self) -> Option<String> {
        if let Some((number, text)) = self.resend_queue.pop_front() {
            return Some(numbered(number, &text));
        }
        let text = if self.resend_active { None } else { self.send_queue.pop_front() }?;
        self.last_lines.push_back(text.clone());
        if self.last_lines.len() > 50 {
            self.last_lines.pop_front();
        }
        self.current_line += 1;
        Some(numbered(self.current_line - 1, &text))
    }

    fn check_possibility(&self, delta: i32) {
        assert!(delta >= 0 && delta as usize <= self.last_lines.len(), "OctoPrint: no sufficient history");
    }

    fn resend_next_command(&mut self) {
        self.comm_error = None;
        let Some(delta) = self.resend_delta else { return };
        self.check_possibility(delta);
        assert!(delta > 0, "OctoPrint: its oldest line instead of the next one");
        let text = self.last_lines[self.last_lines.len() - delta as usize].clone();
        self.resend_queue.push_back((self.current_line - delta, text));
        self.resend_delta = (delta > 1).then_some(delta - 1);
        if self.resend_delta.is_none() {
            (self.last_resend, self.resend_count, self.resend_active) = (None, 0, false);
        }
    }
}

impl Host for OctoPrint {
    fn hear(&mut self, line: &str) {
        self.inbox.push_back(line.to_owned());
    }

    fn speak(&mut self, ms: u32) -> Option<String> {
        loop {
            if let Some((until, line)) = self.hanging.take() {
                if ms < until {
                    self.hanging = Some((until, line));
                } else {
                    self.send_queue.push_back(line);
                }
            }
            // The loop that sends is quicker than the one that reads: the worse order of the two.
            if self.clear_to_send > 0
                && let Some(line) = self.next_in_queue()
            {
                self.clear_to_send -= 1;
                return Some(line);
            }
            if self.hanging.is_some() {
                return None;
            }
            let line = self.inbox.pop_front()?;
            self.handle(&line, ms);
        }
    }

    fn is_done(&self) -> bool {
        let is_sent = self.next == self.program.len() && self.hanging.is_none() && self.send_queue.is_empty();
        is_sent
            && self.resend_queue.is_empty()
            && self.resend_delta.is_none()
            && self.inbox.is_empty()
            && self.clear_to_send > 0
    }
}

/// A host that has several lines under way, begins again where it is asked to, and then counts anew.
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
