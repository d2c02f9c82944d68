//! OctoPrint as in its source, within the line protocol.

use super::hosts::{Host, Pauses, requested};
use super::machine::numbered;
use std::collections::VecDeque;

/// Its timeout for an `ok` (`timeouts.communication`).
const TIMEOUT_MS: u32 = 30_000;

/// Its timeout for the `ok` of a request (`timeouts.resendOk`).
const RESEND_OK_MS: u32 = 500;

/// OctoPrint 1.11.8, util/comm.py: `_monitor`, `_send_loop`, `_handle_ok`, `_handle_resend_request` and
/// `_resendNextCommand`, `_handle_timeout`, after its M110.
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
    /// Only repetitions leave.
    resend_active: bool,
    /// A request is being met, and the `ok` after that has not come.
    is_resending: bool,
    /// When it takes the `ok` of a request as said.
    resend_ok_timer: Option<u32>,
    /// When it gives up waiting for an `ok`, and whether it has just done so.
    ok_timeout: u32,
    has_lost_patience: bool,
    /// It has sent the wrong line, as it does at a request for a future line while it repeats others.
    pub has_erred: bool,
    clear_to_send: i32,
    inbox: VecDeque<String>,
    /// The monitor waits in a plugin, and then puts this into the queue.
    hanging: Option<(u32, String)>,
}

impl OctoPrint {
    pub fn new(program: Vec<String>, pauses: Pauses) -> Self {
        Self {
            program,
            pauses,
            next: 0,
            current_line: 1,
            last_lines: VecDeque::from(["M110 N0".to_owned()]),
            resend_delta: None,
            last_resend: None,
            resend_count: 0,
            consecutive: (None, 0),
            comm_error: None,
            send_queue: VecDeque::new(),
            resend_queue: VecDeque::new(),
            resend_active: false,
            is_resending: false,
            resend_ok_timer: None,
            ok_timeout: TIMEOUT_MS,
            has_lost_patience: false,
            has_erred: false,
            clear_to_send: 0,
            // The answer to its M110.
            inbox: VecDeque::from(["ok".to_owned()]),
            hanging: None,
        }
    }

    fn handle(&mut self, line: &str, ms: u32) {
        let is_ok = line.starts_with("ok");
        if self.resend_ok_timer.take().is_some() && !is_ok {
            self.handle_ok(ms);
        }
        if let Some(number) = requested(line) {
            self.handle_resend_request(number);
            self.resend_ok_timer = Some(ms + RESEND_OK_MS);
        } else if line.starts_with("Error:") {
            self.comm_error = Some(line.to_lowercase());
        } else if is_ok {
            self.handle_ok(ms);
        }
    }

    fn handle_ok(&mut self, ms: u32) {
        self.clear_to_send = (self.clear_to_send + 1).min(1);
        self.ok_timeout = ms + TIMEOUT_MS;
        if self.resend_delta.is_some() {
            self.resend_next_command();
            return;
        }
        self.is_resending = false;
        if self.resend_queue.is_empty()
            && (self.resend_active || self.send_queue.is_empty())
            && let Some(line) = self.program.get(self.next)
        {
            self.hanging = Some((ms + self.pauses.before(self.next), line.clone()));
            self.next += 1;
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
        (self.resend_active, self.is_resending) = (true, true);
    }

    /// Only a repetition, or a poll.
    fn handle_timeout(&mut self, ms: u32) {
        self.has_lost_patience = true;
        self.ok_timeout = ms + TIMEOUT_MS;
        if self.is_resending {
            self.resend_delta = Some(self.resend_delta.unwrap_or(0) + 1);
            self.resend_next_command();
        } else {
            self.send_queue.push_back("M105".to_owned());
        }
        self.clear_to_send = 1;
    }

    /// `SendQueue._get` and its use in `_send_loop`.
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
        if delta == 0 {
            // `_lastLines[-0]` is its oldest line, which gets the number of the next one.
            self.has_erred = true;
            return;
        }
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
        self.has_lost_patience = false;
        if ms >= self.ok_timeout && !self.is_done() {
            self.handle_timeout(ms);
        }
        loop {
            if let Some((until, line)) = self.hanging.take() {
                if ms < until {
                    self.hanging = Some((until, line));
                } else {
                    self.send_queue.push_back(line);
                }
            }
            // The timer does not wait for the monitor, unless both would fetch the next line.
            if self.resend_ok_timer.is_some_and(|until| ms >= until)
                && (self.hanging.is_none() || self.resend_delta.is_some())
            {
                self.resend_ok_timer = None;
                self.handle_ok(ms);
            }
            // The loop that sends is faster than the one that reads: the worse order of the two.
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
        if self.has_erred {
            return true;
        }
        let is_sent = self.next == self.program.len() && self.hanging.is_none() && self.send_queue.is_empty();
        is_sent
            && self.resend_queue.is_empty()
            && self.resend_delta.is_none()
            && self.inbox.is_empty()
            && self.clear_to_send > 0
    }

    fn has_lost_patience(&self) -> bool {
        self.has_lost_patience
    }
}
