//! The host at the other end of the line: sends a G-code file the way printcore does.
//!
//! Comments and blank lines are not sent. Line numbers and checksums in the file are verified and not sent; an M110,
//! which would refer to them, is left out. `N-1 M110 N-1` resets the line number. Then the commands follow as `N0`,
//! `N1`, ... with a checksum, each after the `ok` for the previous one. A `Resend` goes back. An `M400` is added, so
//! that the last `ok` means that the motion is done. (Printrun, `printcore.py`.)
//!
//! Where the printer waits for a user (M0, M1, M600, M601), the host resumes it after [`USER_SECONDS`], as a user
//! would. The file is read as it is sent; only the last commands are kept, in case the printer asks for them again.

mod replies;

pub use replies::Answer;

use crate::file_line::{command_of, words};
use crate::lines::{Lines, Survey, lines_of, survey};
use crate::slicer::Notes;
use crate::world::Host;
use corehbot::protocol::ACTION;
use corehbot::units::TICKS_PER_SECOND;
use corehbot_machine_file::short::{short, shortened};
use replies::{Answers, LONGEST_REPLY, ReplyKind};
use std::collections::VecDeque;
use std::fmt;
use std::io::BufRead;

/// Remarks that are kept in words; the others are only counted.
const KEPT: usize = 20;

/// Resends of one command after which something is wrong for good.
const PATIENCE: u32 = 10;

/// Waits for temperatures that are kept: more would hide each other in a chart.
const MOST_HEAT_WAITS: usize = 200;

/// Commands that can be sent again: more than a printer of any kind has room for.
const RECENT: usize = 256;

/// How long a user takes to answer.
pub const USER_SECONDS: u32 = 5;

/// The same in ticks.
const USER_TICKS: u64 = (USER_SECONDS * TICKS_PER_SECOND) as u64;

/// A user's command to resume the print.
const GO_ON: &str = "M108";

/// A command of the file.
struct Command {
    text: String,
    /// Line in the file, from 1; 0 for a line that the host adds.
    line: u32,
    /// Its type for the slicer.
    kind: u16,
    /// Its checksum in the file does not match its text.
    is_damaged: bool,
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
        write!(f, "{}: {}", short(&self.command), shortened(&self.reply, LONGEST_REPLY))
    }
}

/// A command that waited for a temperature.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HeatWait {
    /// The command.
    pub command: String,
    /// When it was sent, and when it was answered, in ticks.
    pub time: [u64; 2],
}

/// Requests of the commands that were sent.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Requests {
    /// Commands that heat something.
    pub heating: u32,
    /// Filament: a move with an E above 0.
    pub filament: bool,
    /// M111 with its bit for a dry run, in which no filament moves.
    pub dry_run: bool,
}

impl Requests {
    /// Takes note of a command.
    fn note(&mut self, command: &str) {
        let mut words = words(command);
        let Some((letter, Some(code))) = words.next() else { return };
        let mut has = |letters: &str| {
            words.any(|(letter, value)| letters.contains(letter) && value.is_some_and(|value| value > 0.0))
        };
        match (letter, code) {
            ('G', 0.0..=3.0) => self.filament |= has("E"),
            ('M', 104.0 | 109.0 | 140.0 | 141.0 | 190.0 | 191.0) => self.heating += u32::from(has("SR")),
            ('M', 111.0) => {
                self.dry_run |= words.any(|(letter, value)| letter == 'S' && value.is_some_and(|s| s as u32 & 8 != 0));
            }
            _ => {}
        }
    }
}

/// Sends a file and listens to the answers.
pub struct FileHost {
    file: Lines<Box<dyn BufRead + Send>>,
    survey: Survey,
    /// What the slicer says in the lines read so far.
    notes: Notes,
    /// Lines read so far.
    read: u32,
    /// The last commands that were read, and the index of the first of them.
    recent: VecDeque<Command>,
    first: i64,
    /// Index of the next command to send; -1 is the reset of the line number.
    next: i64,
    /// Commands that were not answered yet, a user's among them.
    awaiting: u32,
    sent: u64,
    resends: u32,
    /// The number that was asked for last, and how often in a row.
    repeated: i64,
    repeats: u32,
    /// An `Error:` that may turn out to be the begin of a resend.
    error: Option<String>,
    /// The last warning to the command under way: a print that ends says why before.
    said: Option<String>,
    warnings: Vec<Remark>,
    warnings_total: u32,
    answers: Answers,
    /// The time, in ticks.
    now: u64,
    /// Since when the printer has waited for an absent user.
    paused: Option<u64>,
    pauses: Vec<Remark>,
    pauses_total: u32,
    /// The first commands that waited for a temperature; the last one may still wait.
    heat_waits: Vec<HeatWait>,
    is_heat_awaited: bool,
    /// Since when a command has waited for a temperature, and for how long all of them did.
    heat_since: Option<u64>,
    heat_ticks: u64,
    asked: Requests,
    failure: Option<Remark>,
}

impl FileHost {
    /// A host that will send the commands of `gcode`.
    #[must_use]
    pub fn new(gcode: &str) -> Self {
        // Memory can always be read.
        let known = survey(&mut lines_of(gcode), |_, _, _| Ok(())).unwrap_or_default();
        Self::reading(lines_of(gcode), known)
    }

    /// A host that will send the commands of `file`; `survey` describes its content.
    #[must_use]
    pub fn reading(file: Lines<Box<dyn BufRead + Send>>, survey: Survey) -> Self {
        Self {
            file,
            survey,
            notes: Notes::default(),
            read: 0,
            recent: VecDeque::new(),
            first: 0,
            next: -1,
            awaiting: 0,
            sent: 0,
            resends: 0,
            repeated: -2,
            repeats: 0,
            error: None,
            warnings: Vec::new(),
            warnings_total: 0,
            answers: Answers::default(),
            now: 0,
            paused: None,
            pauses: Vec::new(),
            pauses_total: 0,
            heat_waits: Vec::new(),
            is_heat_awaited: false,
            heat_since: None,
            heat_ticks: 0,
            asked: Requests { heating: 0, filament: false, dry_run: false },
            said: None,
            failure: None,
        }
    }

    /// Commands to send: the file's commands and the added one.
    const fn total(&self) -> i64 {
        self.survey.commands as i64 + 1
    }

    /// A command by its index, if it is one of the last or the next; an error is the end of the print.
    fn command(&mut self, index: i64) -> Result<&Command, &'static str> {
        while self.first + self.recent.len() as i64 <= index {
            let command = self.read_command()?;
            self.recent.push_back(command);
            if self.recent.len() > RECENT {
                self.recent.pop_front();
                self.first += 1;
            }
        }
        let place = usize::try_from(index - self.first).ok();
        place.and_then(|place| self.recent.get(place)).ok_or("asks for a line that was sent long ago")
    }

    fn read_command(&mut self) -> Result<Command, &'static str> {
        while let Some(line) = self.file.next_line().map_err(|_| "the file cannot be read any further")? {
            self.read += 1;
            self.notes.read(&line);
            let (text, is_damaged) = command_of(&line);
            if !text.is_empty() {
                let kind = self.notes.current();
                return Ok(Command { text: text.into_owned(), line: self.read, kind, is_damaged });
            }
        }
        if self.first + self.recent.len() as i64 != self.total() - 1 {
            return Err("the file has become shorter");
        }
        Ok(Command { text: "M400".to_owned(), line: 0, kind: self.notes.current(), is_damaged: false })
    }

    /// What the slicer says in the lines that were sent.
    #[must_use]
    pub const fn notes(&self) -> &Notes {
        &self.notes
    }

    /// Lines of the file.
    #[must_use]
    pub const fn lines(&self) -> u32 {
        self.survey.lines
    }

    /// Commands of the file.
    #[must_use]
    pub const fn commands(&self) -> u64 {
        self.survey.commands
    }

    /// Commands answered so far.
    #[must_use]
    pub fn answered(&self) -> u64 {
        (self.next - i64::from(self.awaiting > 0)).clamp(0, self.total() - 1) as u64
    }

    /// Commands that had to be sent again.
    #[must_use]
    pub const fn resends(&self) -> u32 {
        self.resends
    }

    /// Warnings of the printer: the first few remarks.
    #[must_use]
    pub fn warnings(&self) -> &[Remark] {
        &self.warnings
    }

    /// How many remarks there were.
    #[must_use]
    pub const fn warnings_total(&self) -> u32 {
        self.warnings_total
    }

    /// Answers of the printer: those to the first commands.
    #[must_use]
    pub fn answers(&self) -> &[Answer] {
        &self.answers.first
    }

    /// How many commands had an answer.
    #[must_use]
    pub const fn answers_total(&self) -> u32 {
        self.answers.total
    }

    /// Where it went on instead of a user: the first few places.
    #[must_use]
    pub fn pauses(&self) -> &[Remark] {
        &self.pauses
    }

    /// How often it went on instead of a user.
    #[must_use]
    pub const fn pauses_total(&self) -> u32 {
        self.pauses_total
    }

    /// Where it waited for temperatures: the first places.
    #[must_use]
    pub fn heat_waits(&self) -> &[HeatWait] {
        &self.heat_waits
    }

    /// Requests of the commands so far.
    #[must_use]
    pub const fn asked(&self) -> Requests {
        self.asked
    }

    /// The time, and how much of it commands have waited for a temperature, in ticks.
    #[must_use]
    pub fn time(&self) -> (u64, u64) {
        (self.now, self.heat_ticks + self.heat_since.map_or(0, |since| self.now - since))
    }

    /// Why the print failed, if it did.
    #[must_use]
    pub const fn failure(&self) -> Option<&Remark> {
        self.failure.as_ref()
    }

    /// The command that was sent last.
    fn current(&self) -> Remark {
        let place = usize::try_from(self.next - 1 - self.first).ok();
        let (line, command) = match place.and_then(|place| self.recent.get(place)) {
            Some(command) => (command.line, command.text.clone()),
            None => (0, "M110 N-1".to_owned()),
        };
        Remark { line, command, reply: String::new() }
    }

    /// It fails for what the printer said before, or, if it said nothing, for this.
    fn fail_as_said(&mut self, otherwise: &str) {
        let said = self.said.take();
        let why = said.as_deref().map_or(otherwise, |said| said.strip_prefix("echo:").unwrap_or(said));
        self.fail(why);
    }

    fn warn(&mut self, reply: &str) {
        self.said = Some(reply.to_owned());
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

    /// The command `index` has been sent: it may wait for a temperature.
    fn await_heat(&mut self, index: i64) {
        let now = self.now;
        if let Ok(command) = self.command(index) {
            let text = command.text.clone();
            self.asked.note(&text);
        }
        let known = self.command(index).ok().filter(|command| is_heat_wait(&command.text));
        let Some(command) = known.map(|command| command.text.clone()) else { return };
        self.heat_since = Some(now);
        if self.heat_waits.len() < MOST_HEAT_WAITS {
            self.heat_waits.push(HeatWait { command, time: [now; 2] });
            self.is_heat_awaited = true;
        }
    }

    fn resend(&mut self, number: &str) {
        let Ok(number) = number.trim().parse::<i64>() else {
            self.fail("a Resend without a number");
            return;
        };
        self.error = None;
        // After a silence the printer asks for the next line; a line that was never sent is not sent again.
        if self.awaiting == 0 && number == self.next {
            return;
        }
        self.resends += 1;
        self.repeats = if self.repeated == number { self.repeats + 1 } else { 1 };
        self.repeated = number;
        if self.repeats > PATIENCE {
            self.fail("asks for the same line again and again");
        }
        self.next = number.clamp(-1, self.total());
    }

    /// The printer sends text that hosts show a user.
    fn hear_action(&mut self, action: &str) {
        match action {
            "pause action:pause" => self.fail_as_said("the printer holds this line until it is heated or homed"),
            "cancel action:cancel" => self.fail_as_said("the printer has ended the print"),
            // Waits that end by themselves need no user.
            "prompt_show" if !is_timed(&self.current().command) => self.paused = Some(self.now),
            "prompt_end" => self.paused = None,
            _ => {}
        }
    }
}

impl Host for FileHost {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.awaiting > 0 || self.is_done() {
            return;
        }
        let index = self.next;
        let text = match self.command(index) {
            _ if index < 0 => "N-1 M110 N-1".to_owned(),
            Ok(Command { is_damaged: true, .. }) => {
                self.next += 1;
                return self.fail("its checksum is wrong, the file is damaged");
            }
            Ok(command) => format!("N{index} {}", command.text),
            Err(why) => return self.fail(why),
        };
        let checksum = text.bytes().fold(0, |sum, b| sum ^ b);
        out.extend_from_slice(format!("{text}*{checksum}\n").as_bytes());
        self.next += 1;
        self.sent += 1;
        self.awaiting = 1;
        self.await_heat(index);
    }

    fn sent(&self) -> Option<(u32, u16, &str)> {
        let place = usize::try_from(self.next - 1 - self.first).ok()?;
        self.recent.get(place).map(|command| (command.line, command.kind, command.text.as_str()))
    }

    fn clock(&mut self, tick: u64) {
        self.now = tick;
        if let Some(wait) = self.heat_waits.last_mut().filter(|_| self.is_heat_awaited) {
            wait.time[1] = tick;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        if self.paused.is_none_or(|since| self.now < since + USER_TICKS) {
            return;
        }
        self.paused = None;
        out.extend_from_slice(format!("{GO_ON}\n").as_bytes());
        self.awaiting += 1;
        self.pauses_total += 1;
        if self.pauses.len() < KEPT {
            let reply = format!("went on by itself after {USER_SECONDS} s ({GO_ON})");
            self.pauses.push(Remark { reply, ..self.current() });
        }
    }

    fn hear(&mut self, line: &str) {
        let line = line.trim();
        if line == "ok" || line.starts_with("ok ") {
            if let Some(error) = self.error.take() {
                self.fail(&error);
            }
            self.said = None;
            self.awaiting = self.awaiting.saturating_sub(1);
            self.is_heat_awaited &= self.awaiting > 0;
            if self.awaiting == 0
                && let Some(since) = self.heat_since.take()
            {
                self.heat_ticks += self.now - since;
            }
        } else if let Some(action) = line.strip_prefix(ACTION) {
            self.hear_action(action);
        } else if let Some(number) = line.strip_prefix("Resend:") {
            self.resend(number);
        } else if line.starts_with("Error:Printer halted") || line.starts_with("!!") {
            let why = self.error.take();
            self.fail(why.as_deref().unwrap_or(line));
        } else if line.starts_with("Error:") {
            self.error = Some(line.to_owned());
        } else if self.sent > 0 {
            // Before the first command it can only be the greeting.
            let Remark { line: number, command, .. } = self.current();
            match ReplyKind::of(line, &command) {
                ReplyKind::Warning => self.warn(line),
                ReplyKind::Answer => self.answers.note(self.next - 1, number, &command, line),
                ReplyKind::Plain => {}
            }
        }
    }

    fn is_done(&self) -> bool {
        self.failure.is_some() || self.next >= self.total() && self.awaiting == 0
    }
}

/// Whether a command waits for a temperature: of the hotend, of any heater, of the bed or the chamber.
fn is_heat_wait(command: &str) -> bool {
    matches!(words(command).next(), Some(('M', Some(109.0 | 116.0 | 190.0 | 191.0))))
}

/// Whether a wait for the user ends by itself: with a time, in seconds (S) or milliseconds (P).
fn is_timed(command: &str) -> bool {
    let mut words = words(command);
    matches!(words.next(), Some(('M', Some(0.0 | 1.0))))
        && words.any(|(letter, value)| matches!(letter, 'S' | 'P') && value.is_some_and(|time| time > 0.0))
}

#[cfg(test)]
mod tests;
