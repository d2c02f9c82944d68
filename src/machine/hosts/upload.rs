//! Uploads: the lines that a host sends between M28 and M29 are a file for a card. There is no card, and the lines are
//! not commands, so they are answered and not carried out: Pronsole sends them without waiting for the answer to M28.
//!
//! A host that never sends M29 must not block the printer for ever. Besides M29, these end an upload, and the host gets
//! a message:
//!
//! - The line is opened again (USB knows when), which the host sees as a reset.
//! - M110, the first word of a print. Pronsole says it once within an upload too, directly behind M28, because it sends
//!   the file as it prints one (pronsole.py, `do_upload`). That one counts as part of the upload if it comes before any
//!   line of the file, and soon. Its last word, before M29, is M110 again.
//! - M115 without words, the first word of a host that connects. In a file it has a version behind it (`M115 U3.1.0`).
//!
//! Time does not end it: a host may be slow, and the rest of its file would then be carried out.

use super::request::{Parse, Request};
use crate::gcode::{Command, Mark};
use crate::units::Instant;

/// Pronsole starts the file as soon as M28 is sent; this is more time than any computer takes.
const BEGINS_WITHIN_MS: u32 = 10_000;

/// An upload that is under way, if one is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Upload {
    state: State,
    /// Lines that were not carried out, of an upload that ended without M29 and was not reported.
    given_up: Option<u32>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum State {
    None,
    /// M28 came at this time, and nothing of the file.
    Begun(Instant),
    /// The file has started, or M110 before it: this many lines have come.
    Streaming(u32),
}

/// Whether a line begins or ends an upload. M410 makes none of them forgotten: the lines behind it would be carried
/// out.
pub(super) fn is_mark(parse: Parse, text: &[u8]) -> bool {
    matches!(parse(text), Command::Table(command) if command.is('M', 28) || command.is('M', 29))
}

/// Whether a line is M115 and nothing else.
fn is_greeting(text: &[u8]) -> bool {
    text.trim_ascii().eq_ignore_ascii_case(b"M115")
}

/// Whether a command acts in an upload as ever: it stops or reports, or acts before its turn anyway.
const fn acts(command: &Command<'_>) -> bool {
    matches!(command, Command::Table(command) if command.has_mark(Mark::ActsInUpload))
}

impl Upload {
    /// None.
    pub(super) const fn new() -> Self {
        Self { state: State::None, given_up: None }
    }

    /// M28.
    pub(super) const fn begin(&mut self, now: Instant) {
        self.state = State::Begun(now);
    }

    /// M29: the number of lines that were not carried out. `None` without M28.
    pub(super) const fn end(&mut self) -> Option<u32> {
        match core::mem::replace(&mut self.state, State::None) {
            State::None => None,
            State::Begun(_) => Some(0),
            State::Streaming(lines) => Some(lines),
        }
    }

    /// An upload that ended without M29, once.
    pub(super) const fn take_given_up(&mut self) -> Option<u32> {
        self.given_up.take()
    }

    /// Whether a line is one of the file, and needs but an `ok`. One that shows that the upload is over ends it.
    pub(super) fn takes(&mut self, asked: Request, text: &[u8], parse: Parse, now: Instant) -> bool {
        let lines = match self.state {
            State::None => return false,
            State::Begun(_) => 0,
            State::Streaming(lines) => lines,
        };
        match asked {
            Request::Command if is_greeting(text) => self.give_up(),
            Request::Command if acts(&parse(text)) => false,
            Request::Command | Request::TooLong => {
                self.state = State::Streaming(lines.saturating_add(1));
                true
            }
            Request::LineNumber(_) => match self.state {
                State::Begun(at) if now < at.after_ms(BEGINS_WITHIN_MS) => {
                    self.state = State::Streaming(0);
                    false
                }
                _ => self.give_up(),
            },
            Request::Nothing | Request::Resend(..) | Request::Question(_) => false,
        }
    }

    /// It is over; the line that shows it is carried out.
    const fn give_up(&mut self) -> bool {
        self.given_up = self.end();
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{Entry, Row, parse_with};

    static TABLE: [Row; 1] = [Entry::m("", &[28, 29, 105, 108, 112, 410]).mark(Mark::ActsInUpload).row()];

    fn parse(line: &[u8]) -> Command<'_> {
        parse_with(&TABLE, line)
    }

    fn begun() -> Upload {
        let mut upload = Upload::new();
        upload.begin(Instant(0));
        upload
    }

    #[test]
    fn without_m28_nothing_is_taken() {
        let mut upload = Upload::new();
        assert!(!upload.takes(Request::Command, b"G1 X5", parse, Instant(0)));
        assert!(!upload.takes(Request::LineNumber(None), b"", parse, Instant(0)));
        assert_eq!((upload.end(), upload.take_given_up()), (None, None));
    }

    #[test]
    fn lines_up_to_m29_are_taken_but_for_those_that_act_anyway() {
        let mut upload = begun();
        for line in ["G1 X5 E1", "M104 S200", "START_PRINT BED=60", "nonsense", "M110x", "M115 U3.1.0", "M25"] {
            assert!(upload.takes(Request::Command, line.as_bytes(), parse, Instant(0)), "{line}");
        }
        assert!(upload.takes(Request::TooLong, b"", parse, Instant(0)));
        for line in ["M105", "M112", "M108", "M410", "M29", "M29 a.gco", "M28 b.gco"] {
            assert!(!upload.takes(Request::Command, line.as_bytes(), parse, Instant(0)), "{line}");
        }
        assert!(!upload.takes(Request::Nothing, b"", parse, Instant(0)));
        assert_eq!((upload.end(), upload.end()), (Some(8), None));
    }

    #[test]
    fn pronsole_says_m110_directly_behind_m28_and_again_at_the_end() {
        let mut upload = begun();
        assert!(!upload.takes(Request::LineNumber(None), b"", parse, Instant(0).after_ms(200)));
        assert!(upload.takes(Request::Command, b"G28", parse, Instant(0).after_ms(300)));
        assert!(!upload.takes(Request::LineNumber(None), b"", parse, Instant(0).after_ms(400)));
        assert_eq!((upload.take_given_up(), upload.take_given_up(), upload.end()), (Some(1), None, None));
    }

    #[test]
    fn another_host_ends_it() {
        for asked in [Request::LineNumber(None), Request::Command] {
            let mut upload = begun();
            assert!(!upload.takes(asked, b"m115 ", parse, Instant(0).after_ms(BEGINS_WITHIN_MS)));
            assert_eq!(upload.take_given_up(), Some(0));
            assert!(!upload.takes(Request::Command, b"G1 X5", parse, Instant(0)));
        }
        // OctoPrint says it three times as it connects.
        let mut upload = begun();
        assert!(!upload.takes(Request::LineNumber(None), b"", parse, Instant(0)));
        assert!(!upload.takes(Request::LineNumber(None), b"", parse, Instant(0)));
        assert_eq!(upload.take_given_up(), Some(0));
    }
}
