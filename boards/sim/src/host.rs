//! The host at the other end of the line: sends a G-code file the way printcore does.
//!
//! Comments and blank lines stay at home. `N-1 M110 N-1` resets the line number, then the commands follow as
//! `N0`, `N1`, ... with a checksum, each when the one before was answered with `ok`. A `Resend` goes back.
//! An `M400` is added, so that the last `ok` means that the motion is done. (Printrun, `printcore.py`.)

use crate::world::Host;
use std::borrow::Cow;
use std::fmt;

/// Remarks that are kept in words; the rest is counted.
const KEPT: usize = 20;

/// Resends of one command after which something is wrong for good.
const PATIENCE: u32 = 10;

/// A command of the file.
struct Command {
    text: String,
    /// Line in the file, from 1; 0 for what the host adds.
    line: u32,
}

/// Something the printer said about a command.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Remark {
    /// Line in the file, 0 for a command that the host added.
    pub line: u32,
    /// The command.
    pub command: String,
    /// The printer's words.
    pub reply: String,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "{}: ", self.line)?;
        }
        write!(f, "{}: {}", self.command, self.reply)
    }
}

/// Sends a file and listens to the answers.
pub struct FileHost {
    commands: Vec<Command>,
    lines: u32,
    /// Index of the next command to send; -1 is the reset of the line number.
    next: i64,
    is_awaiting_ok: bool,
    sent: u64,
    resends: u32,
    /// The number that was asked for last, and how often in a row.
    repeated: i64,
    repeats: u32,
    /// An `Error:` that may turn out to be the begin of a resend.
    error: Option<String>,
    warnings: Vec<Remark>,
    warnings_total: u32,
    failure: Option<Remark>,
}

impl FileHost {
    /// A host that will send the commands of `gcode`.
    #[must_use]
    pub fn new(gcode: &str) -> Self {
        let mut commands = Vec::new();
        let mut lines = 0;
        for line in gcode.lines() {
            lines += 1;
            let text = strip_comment(line);
            if !text.is_empty() {
                commands.push(Command { text: text.into_owned(), line: lines });
            }
        }
        commands.push(Command { text: "M400".to_owned(), line: 0 });
        Self {
            commands,
            lines,
            next: -1,
            is_awaiting_ok: false,
            sent: 0,
            resends: 0,
            repeated: -2,
            repeats: 0,
            error: None,
            warnings: Vec::new(),
            warnings_total: 0,
            failure: None,
        }
    }

    /// Lines of the file.
    #[must_use]
    pub const fn lines(&self) -> u32 {
        self.lines
    }

    /// Commands of the file.
    #[must_use]
    pub const fn commands(&self) -> u64 {
        self.commands.len() as u64 - 1
    }

    /// Commands answered so far.
    #[must_use]
    pub fn answered(&self) -> u64 {
        (self.next - i64::from(self.is_awaiting_ok)).clamp(0, self.commands.len() as i64 - 1) as u64
    }

    /// Commands that had to be sent again.
    #[must_use]
    pub const fn resends(&self) -> u32 {
        self.resends
    }

    /// What the printer found odd: the first few remarks.
    #[must_use]
    pub fn warnings(&self) -> &[Remark] {
        &self.warnings
    }

    /// How many remarks there were.
    #[must_use]
    pub const fn warnings_total(&self) -> u32 {
        self.warnings_total
    }

    /// Why the print failed, if it did.
    #[must_use]
    pub const fn failure(&self) -> Option<&Remark> {
        self.failure.as_ref()
    }

    /// The command that was sent last.
    fn current(&self) -> Remark {
        let index = usize::try_from(self.next - 1).ok();
        let (line, command) = match index.and_then(|i| self.commands.get(i)) {
            Some(command) => (command.line, command.text.clone()),
            None => (0, "M110 N-1".to_owned()),
        };
        Remark { line, command, reply: String::new() }
    }

    fn warn(&mut self, reply: &str) {
        self.warnings_total += 1;
        if self.warnings.len() < KEPT {
            let remark = Remark { reply: reply.to_owned(), ..self.current() };
            self.warnings.push(remark);
        }
    }

    fn fail(&mut self, reply: &str) {
        if self.failure.is_none() {
            self.failure = Some(Remark { reply: reply.to_owned(), ..self.current() });
        }
    }

    fn resend(&mut self, number: &str) {
        let Ok(number) = number.trim().parse::<i64>() else {
            self.fail("a Resend without a number");
            return;
        };
        self.error = None;
        // After a silence the printer asks for the next line; what was never sent is not sent again.
        if !self.is_awaiting_ok && number == self.next {
            return;
        }
        self.resends += 1;
        self.repeats = if self.repeated == number { self.repeats + 1 } else { 1 };
        self.repeated = number;
        if self.repeats > PATIENCE {
            self.fail("asks for the same line again and again");
        }
        self.next = number.clamp(-1, self.commands.len() as i64);
    }
}

impl Host for FileHost {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.is_awaiting_ok || self.is_done() {
            return;
        }
        let text = match usize::try_from(self.next) {
            Ok(index) => match self.commands.get(index) {
                Some(command) => format!("N{index} {}", command.text),
                None => return,
            },
            Err(_) => "N-1 M110 N-1".to_owned(),
        };
        let checksum = text.bytes().fold(0, |sum, b| sum ^ b);
        out.extend_from_slice(format!("{text}*{checksum}\n").as_bytes());
        self.next += 1;
        self.sent += 1;
        self.is_awaiting_ok = true;
    }

    fn hear(&mut self, line: &str) {
        let line = line.trim();
        if line == "ok" || line.starts_with("ok ") {
            if let Some(error) = self.error.take() {
                self.fail(&error);
            }
            self.is_awaiting_ok = false;
        } else if let Some(number) = line.strip_prefix("Resend:") {
            self.resend(number);
        } else if line.starts_with("Error:Printer halted") || line.starts_with("!!") {
            let why = self.error.take();
            self.fail(why.as_deref().unwrap_or(line));
        } else if line.starts_with("Error:") {
            self.error = Some(line.to_owned());
        } else if is_odd(line) && self.sent > 0 {
            // Before the first command it can only be the greeting.
            self.warn(line);
        }
    }

    fn is_done(&self) -> bool {
        self.failure.is_some() || self.next >= self.commands.len() as i64 && !self.is_awaiting_ok
    }
}

/// Begins of echoes that answer a question, show life or say what is no trouble.
const EXPECTED: [&str; 9] = [
    " ",
    "busy:",
    "M113 S",
    "E0 Flow:",
    "Cold extrudes",
    "no heaters",
    "Settings Stored",
    "stored settings",
    "Hardcoded Default",
];

/// Whether a reply tells of something that the author of the file should know.
fn is_odd(reply: &str) -> bool {
    reply.strip_prefix("echo:").is_some_and(|text| !EXPECTED.iter().any(|begin| text.starts_with(begin)))
}

/// A line without its comments and outer blanks, in ASCII as the wire wants it.
#[must_use]
pub fn strip_comment(line: &str) -> Cow<'_, str> {
    let line = line.split(';').next().unwrap_or_default().trim();
    if !line.contains('(') && line.is_ascii() {
        return Cow::Borrowed(line);
    }
    let mut text = String::new();
    let mut is_comment = false;
    for c in line.chars() {
        match c {
            '(' => is_comment = true,
            ')' => is_comment = false,
            _ if is_comment => {}
            _ if c.is_ascii() => text.push(c),
            _ => text.push('?'),
        }
    }
    Cow::Owned(text.trim().to_owned())
}

/// The words of a command: a letter, in upper case, and its number.
pub fn words(command: &str) -> impl Iterator<Item = (char, Option<f64>)> + '_ {
    let mut rest = command;
    std::iter::from_fn(move || {
        let start = rest.find(|c: char| c.is_ascii_alphabetic())?;
        let letter = rest.as_bytes()[start].to_ascii_uppercase() as char;
        let value = &rest[start + 1..];
        let end = value.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(value.len());
        rest = &value[end..];
        Some((letter, value[..end].trim().parse().ok()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sent(host: &mut FileHost) -> String {
        let mut out = Vec::new();
        host.send(&mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn lines_are_numbered_checked_and_sent_one_by_one() {
        let mut host = FileHost::new("; a comment\n\nG28 ; home\n G1 X5 (to the right) Y2\n");
        assert_eq!((host.lines(), host.commands()), (4, 2));
        assert_eq!(sent(&mut host), "N-1 M110 N-1*125\n");
        assert_eq!(sent(&mut host), "");
        host.hear("echo:busy: processing");
        host.hear("ok");
        assert_eq!(sent(&mut host), "N0 G28*19\n");
        host.hear("ok");
        assert!(sent(&mut host).starts_with("N1 G1 X5  Y2*"));
        host.hear("ok T:20.0 /0.0");
        assert!(sent(&mut host).starts_with("N2 M400*"));
        assert!(!host.is_done());
        host.hear("ok");
        assert!(host.is_done() && host.failure().is_none() && host.warnings().is_empty());
        assert_eq!(host.answered(), 2);
    }

    #[test]
    fn a_resend_goes_back_and_is_no_failure() {
        let mut host = FileHost::new("G28\nG1 X5\n");
        for _ in 0..3 {
            let _ = sent(&mut host);
            host.hear("ok");
        }
        let _ = sent(&mut host);
        host.hear("Error:checksum mismatch, Last Line: 0");
        host.hear("Resend: 1");
        assert_eq!(sent(&mut host), "");
        host.hear("ok");
        assert!(sent(&mut host).starts_with("N1 G1 X5*"));
        assert_eq!((host.resends(), host.failure()), (1, None));
    }

    #[test]
    fn a_question_for_what_comes_next_is_no_resend() {
        let mut host = FileHost::new("G28\n");
        while !host.is_done() {
            let _ = sent(&mut host);
            host.hear("ok");
        }
        host.hear("Error:checksum mismatch, Last Line: 1");
        host.hear("Resend: 2");
        host.hear("ok");
        assert_eq!((host.resends(), host.failure()), (0, None));
        assert!(host.is_done());
    }

    #[test]
    fn a_printer_that_asks_for_ever_is_given_up() {
        let mut host = FileHost::new("G28\n");
        for _ in 0..20 {
            let _ = sent(&mut host);
            host.hear("Resend: -1");
            host.hear("ok");
        }
        assert!(host.is_done() && host.failure().is_some());
    }

    #[test]
    fn odd_replies_name_the_line_and_errors_end_the_print() {
        let mut host = FileHost::new("\n\nM9999\nG1 X1\n");
        for reply in ["", "echo:Unknown command: \"M9999\"", "Error:Printer halted. kill() called!"] {
            let _ = sent(&mut host);
            host.hear(reply);
            host.hear("ok");
        }
        assert_eq!(host.warnings()[0].to_string(), "3: M9999: echo:Unknown command: \"M9999\"");
        assert_eq!(host.failure().unwrap().line, 4);
        assert!(host.is_done());
    }

    #[test]
    fn words_are_letters_with_numbers() {
        let words: Vec<_> = words("g1x-.5 Y2 F").collect();
        assert_eq!(words, [('G', Some(1.0)), ('X', Some(-0.5)), ('Y', Some(2.0)), ('F', None)]);
    }
}
