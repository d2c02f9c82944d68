//! Replies: which lines of the printer are answers, and which are warnings for the author of the file.

use crate::file_line::words;
use corehbot_machine_file::short::{short, shortened};
use serde::Serialize;

/// A line of this firmware is kept whole: it repeats at most 60 characters of a line (`protocol::reply`), and has about
/// as many of its own.
pub(super) const LONGEST_REPLY: usize = 240;

/// Commands with an answer that are kept; the others are only counted.
const KEPT: usize = 50;

/// Lines of one answer that are kept. M503, the longest one, has 43 on the prototype.
const LINES: usize = 200;

/// What a line is that is not an `ok`, an error or an action.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum ReplyKind {
    /// A part of the answer to a command.
    Answer,
    /// Trouble.
    Warning,
    /// A sign of life, a report that no command asked for, or a list for programs.
    Plain,
}

/// First words of plain lines. The summary counts the commands for heaters that do not exist.
const PLAIN: [&str; 5] = ["echo:busy:", "echo:no heaters configured", "T:", "Cap:", "start"];

/// First words of echoes that answer a question or report no trouble.
const EXPECTED: [&str; 27] = [
    "  G",
    "  M",
    ";",
    "M113 S",
    "E0 Flow:",
    "Cold extrudes",
    "Advance K=",
    "Power-loss recovery OFF",
    "overload:",
    "fault: none",
    "sensor ",
    "Settings Stored",
    "stored settings",
    "Hardcoded Default",
    "probe ",
    "Bed Leveling ",
    "Fade Height ",
    "Mesh stored",
    "Stored mesh moved",
    "mesh forgotten",
    "measures X",
    "Probe Offset Z",
    "Babystep",
    "Z offset",
    "swept ",
    "it leaves ",
    "one mode only",
];

impl ReplyKind {
    /// The kind of a reply to this command.
    pub(super) fn of(reply: &str, command: &str) -> Self {
        let is_code = |number: f64| words(command).next() == Some(('M', Some(number)));
        if reply.is_empty() || PLAIN.iter().any(|begin| reply.starts_with(begin)) {
            return Self::Plain;
        }
        // M154 reports positions all the time. M118 repeats words of the file.
        match reply.strip_prefix("echo:") {
            None if reply.starts_with("X:") && !is_code(114.0) => Self::Plain,
            Some(text) if !EXPECTED.iter().any(|begin| text.starts_with(begin)) && !is_code(118.0) => Self::Warning,
            _ => Self::Answer,
        }
    }
}

/// The printer's answer to a command.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Answer {
    /// Line in the file, 0 for a command that the host added.
    pub line: u32,
    /// The command.
    pub command: String,
    /// The printer's lines.
    pub replies: Vec<String>,
}

/// The answers of a print.
#[derive(Default)]
pub(super) struct Answers {
    pub(super) first: Vec<Answer>,
    pub(super) total: u32,
    /// Index of the command that was answered last.
    last: Option<i64>,
}

impl Answers {
    /// Notes a line of the answer to the command with this index, which is in this line of the file.
    pub(super) fn note(&mut self, index: i64, line: u32, command: &str, reply: &str) {
        if self.last != Some(index) {
            self.last = Some(index);
            self.total += 1;
            if self.first.len() < KEPT {
                self.first.push(Answer { line, command: short(command).into_owned(), replies: Vec::new() });
            }
        }
        let is_kept = self.total as usize <= KEPT;
        if let Some(answer) = self.first.last_mut().filter(|answer| is_kept && answer.replies.len() < LINES) {
            answer.replies.push(shortened(reply, LONGEST_REPLY).into_owned());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reply_is_an_answer_or_a_warning_by_its_words_and_its_command() {
        use ReplyKind::{Answer, Plain, Warning};
        for (command, reply, kind) in [
            ("M503", "echo:  M92 X80 Y80 Z800 E400", Answer),
            ("M119", "x_min: open", Answer),
            ("M114", "X:1.00 Y:2.00 Z:3.00 E:0.00", Answer),
            ("G4 P2000", "X:1.00 Y:2.00 Z:3.00 E:0.00", Plain),
            ("M109 S200", "T:20.00 /200.00 B:20.00 /0.00 @:127 B@:0", Plain),
            ("M115", "Cap:EEPROM:0", Plain),
            ("G28", "echo:busy: processing", Plain),
            ("M104 S200", "echo:no heaters configured", Plain),
            ("M118 E1 layer 2", "echo:layer 2", Answer),
            ("G1 X5", "echo:layer 2", Warning),
            ("M122", "echo:fault: none", Answer),
            ("M122", "echo:fault: the hotend is too hot", Warning),
        ] {
            assert_eq!(ReplyKind::of(reply, command), kind, "{command}: {reply}");
        }
    }

    #[test]
    fn the_first_answers_are_kept_and_the_others_are_counted() {
        let mut answers = Answers::default();
        for index in 0..60 {
            for number in 0..2 {
                answers.note(index, 3, "M119", &format!("{number}"));
            }
        }
        assert_eq!((answers.first.len(), answers.total), (KEPT, 60));
        assert!(answers.first.iter().all(|answer| answer.replies == ["0", "1"]));
        let mut long = Answers::default();
        (0..1000).for_each(|_| long.note(7, 1, "M503", "echo:  G21"));
        assert_eq!((long.first[0].replies.len(), long.total), (LINES, 1));
    }
}
