//! The owner: questions to a person at the terminal, or to a program at standard input, one line an answer.
//!
//! A question is one line, `? [key] text`, so a program knows by its key what is asked. Lines are read by a thread, so
//! Ctrl-C and a machine on its way can be looked after meanwhile.

use super::step_error::StepError;
use corehbot_host::say::println;
use corehbot_host::stop::Stop;
use std::io::BufRead as _;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// Between two looks at Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);

/// The person at the terminal.
pub(super) struct Owner {
    /// `None`: everything is as it should be (`--yes`).
    lines: Option<Receiver<String>>,
    stop: Stop,
}

impl Owner {
    /// The owner at standard input, or with `says_yes` one who finds everything as it should be.
    pub fn new(says_yes: bool, stop: Stop) -> Self {
        let lines = (!says_yes).then(|| {
            let (send, receive) = channel();
            std::thread::spawn(move || {
                for line in std::io::stdin().lock().lines().map_while(Result::ok) {
                    if send.send(line).is_err() {
                        return;
                    }
                }
            });
            receive
        });
        Self { lines, stop }
    }

    /// Says a line.
    pub fn tell(&self, line: &str) {
        // A closed pipe is ignored, and any other terminal that cannot be written to will not answer either.
        let _ = println(format_args!("{line}"));
    }

    /// Asks until the answer makes sense. An empty answer is the usual one, and `quit` leaves the guide.
    pub fn ask<T>(
        &self,
        key: &str,
        question: &str,
        usual: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<T, StepError> {
        loop {
            let hint = if usual.is_empty() { String::new() } else { format!(" (Enter: {usual})") };
            self.tell(&format!("? [{key}] {question}{hint}"));
            let line = self.line()?;
            let answer = line.trim().to_lowercase();
            if let Some(answer) = read(if answer.is_empty() { usual } else { &answer }) {
                return Ok(answer);
            }
            if answer == "quit" || self.lines.is_none() {
                return Err(StepError::Left);
            }
            self.tell(match usual {
                "" => "  That is none of the answers. Enter goes on, `quit` leaves.",
                _ => "  That is none of the answers.",
            });
        }
    }

    /// Waits for Enter. Any other word but a consent is none: what follows may move or heat something.
    pub fn wait(&self, key: &str, request: &str) -> Result<(), StepError> {
        self.ask(key, &format!("{request}, then Enter"), "", |answer| {
            ["", "y", "yes", "ok", "done"].contains(&answer).then_some(())
        })
    }

    /// Yes or no.
    pub fn agrees(&self, key: &str, question: &str) -> Result<bool, StepError> {
        self.ask(key, question, "yes", |answer| match answer {
            "y" | "yes" => Some(true),
            "n" | "no" => Some(false),
            _ => None,
        })
    }

    /// Whether no person is there (`--yes`): what only a hand can do is left out.
    pub const fn is_absent(&self) -> bool {
        self.lines.is_none()
    }

    /// Whether a line has come without a question.
    pub fn has_interrupted(&self) -> bool {
        self.lines.as_ref().is_some_and(|lines| lines.try_recv().is_ok())
    }

    /// Whether Ctrl-C was pressed.
    pub fn look_at_stop(&self) -> Result<(), StepError> {
        if self.stop.is_set() { Err(StepError::Stopped) } else { Ok(()) }
    }

    fn line(&self) -> Result<String, StepError> {
        let Some(lines) = &self.lines else { return Ok(String::new()) };
        loop {
            self.look_at_stop()?;
            match lines.recv_timeout(LOOK) {
                Ok(line) => return Ok(line),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(StepError::Left),
            }
        }
    }
}
