//! Emergency commands: M112, M108, M410, M524, M999 and the answers to a pause act as they arrive, even while another
//! command blocks.
//!
//! The scanner reads every byte in parallel with the line layer (idea: Marlin's emergency_parser.h). It ignores numbers
//! and checksums, because a damaged stop is still meant. But it requires the start of a line and the end of the digits:
//! M1125 and `M117 M112` are harmless. The line then also takes its turn in the queue and gets its reply there.
//! RESUME and CANCEL_PRINT are M24 and M524 in Klipper's words.

use super::framing::is_erasing;
use super::syntax::is_blank;

/// A command that cannot wait for its turn.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Emergency {
    /// M112: stop everything until M999 or a reset.
    Stop,
    /// M108: end the current wait.
    Continue,
    /// M410: stop the motion now and discard the queue.
    QuickStop,
    /// M24, M602, M876 S: the user is ready.
    Resume,
    /// M524: cancel the print.
    Cancel,
    /// M999: restart, if the machine is halted.
    Restart,
}

impl Emergency {
    /// The emergency of an M-code.
    const fn of(code: u16) -> Option<Self> {
        match code {
            108 => Some(Self::Continue),
            112 => Some(Self::Stop),
            24 | 602 => Some(Self::Resume),
            410 => Some(Self::QuickStop),
            524 => Some(Self::Cancel),
            999 => Some(Self::Restart),
            _ => None,
        }
    }
}

/// Names of emergencies.
const NAMES: [(&[u8], Emergency); 2] = [(b"RESUME", Emergency::Resume), (b"CANCEL_PRINT", Emergency::Cancel)];

/// The name that begins with this letter.
const fn named(letter: u8) -> State {
    let mut names: &[(&[u8], Emergency)] = &NAMES;
    while let [([first, others @ ..], emergency), more @ ..] = names {
        if letter.eq_ignore_ascii_case(first) {
            return State::Name(others, *emergency);
        }
        names = more;
    }
    State::Other
}

/// The code of an answer; it needs S, because `M876 P1` means that the host can show questions.
const ANSWER: u16 = 876;

/// The scanner's place in a line.
#[derive(Clone, Copy)]
enum State {
    /// Nothing but blanks so far.
    Start,
    /// N, or a sign after it.
    Number,
    /// A digit of the line number, or blanks after it.
    Numbered,
    /// M.
    Letter,
    /// Digits after M; their value.
    Code(u16),
    /// M876, or blanks after it.
    Answer,
    /// The begin of a name; these bytes are still to come.
    Name(&'static [u8], Emergency),
    /// An emergency, complete; waits for the end of the line.
    Complete(Emergency),
    /// Anything else; waits for the end of the line.
    Other,
}

/// Finds emergency commands in a stream of bytes.
pub(super) struct Scanner {
    state: State,
}

impl Scanner {
    /// At the start of a line.
    pub(super) const fn new() -> Self {
        Self { state: State::Start }
    }

    /// Damage: the rest of this line is ignored.
    pub(super) const fn spoil(&mut self) {
        self.state = State::Other;
    }

    /// Reads a byte; an emergency is returned at the end of its line.
    pub(super) const fn read(&mut self, byte: u8) -> Option<Emergency> {
        if matches!(byte, b'\n' | b'\r') {
            let found = match self.state {
                State::Complete(emergency) | State::Name([], emergency) => Some(emergency),
                // Digits may go on up to the end of the line, so only now the code is whole.
                State::Code(code) => Emergency::of(code),
                _ => None,
            };
            self.state = State::Start;
            return found;
        }
        // Nearly every byte of a print.
        if matches!(self.state, State::Other) {
            return None;
        }
        self.state = match (self.state, byte) {
            // The line layer leaves out NUL, too.
            (state, 0) => state,
            // The erased character may be part of an emergency; the line then takes its turn like any other.
            (State::Start, byte) if is_erasing(byte) => State::Start,
            (_, byte) if is_erasing(byte) => State::Other,
            (State::Start | State::Numbered, b'M' | b'm') => State::Letter,
            (State::Start, b'N' | b'n') => State::Number,
            (State::Start | State::Numbered, b'A'..=b'Z' | b'a'..=b'z') => named(byte),
            // More behind it makes it another name.
            (State::Name([], _), b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'_') => State::Other,
            (State::Name([], emergency), _) => State::Complete(emergency),
            (State::Name([next, others @ ..], emergency), _) if byte.eq_ignore_ascii_case(next) => {
                State::Name(others, emergency)
            }
            (State::Number, b'-' | b'+') => State::Number,
            (State::Number | State::Numbered, b'0'..=b'9') => State::Numbered,
            (State::Letter, b'0'..=b'9') => State::Code((byte - b'0') as u16),
            (State::Code(code), b'0'..=b'9') => {
                // Saturated, so that no long number wraps to a code that stops.
                State::Code(code.saturating_mul(10).saturating_add((byte - b'0') as u16))
            }
            // A subcode or a longer name makes it another command.
            (State::Code(_), b'.' | b'_') => State::Other,
            (State::Answer, b'S' | b's') | (State::Code(ANSWER), b'S' | b's') => State::Complete(Emergency::Resume),
            (State::Code(ANSWER), _) if is_blank(byte) => State::Answer,
            (State::Code(code), _) => match Emergency::of(code) {
                Some(emergency) => State::Complete(emergency),
                None => State::Other,
            },
            (State::Complete(emergency), _) => State::Complete(emergency),
            (State::Start | State::Number | State::Numbered | State::Letter | State::Answer, _) if is_blank(byte) => {
                self.state
            }
            _ => State::Other,
        };
        None
    }
}

#[cfg(test)]
mod tests;
