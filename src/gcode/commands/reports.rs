//! Reports and messages.

use super::Command;
use super::row::Described;
use crate::gcode::parts::{Audience, Form};
use crate::text::{trim_end, trim_start};

/// Reports and messages.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ReportCommand<'a> {
    /// M110: set or, without a number, report the line number. The protocol room acts on it.
    LineNumber,
    /// M115: report the firmware.
    ReportFirmware,
    /// M117: a message for a display that is not there.
    Message,
    /// M118: a message for the host.
    Tell {
        /// Its form.
        form: Form,
        /// The receivers.
        to: Audience,
        /// The message as it came.
        text: &'a [u8],
    },
    /// M105: report temperatures.
    Temperatures,
    /// M119: report the endstops.
    ReportEndstops,
    /// M122: report the state of the machine's parts.
    Diagnose,
}

/// Rows without a grammar have a text behind them, take no words at all, or must act in any case.
pub(super) const ROWS: &[Described] = &[
    Described::m(&[110], |_, _| report(ReportCommand::LineNumber)).does("N", "sets or reports the line number"),
    Described::m(&[115], |_, _| report(ReportCommand::ReportFirmware)).does("", "name, version, capabilities"),
    Described::m(&[117], |_, _| report(ReportCommand::Message)).does("", "message for a display: none here"),
    Described::m(&[118], |_, text| report(tell(text))).does("A E P", "says the text to hosts"),
    Described::m(&[119], |_, _| report(ReportCommand::ReportEndstops)).does("", "endstops and probe"),
    Described::m(&[122], |_, _| report(ReportCommand::Diagnose)).does("", "drivers, heaters, faults, overload"),
];

const fn report(command: ReportCommand<'_>) -> Option<Command<'_>> {
    Some(Command::Report(command))
}

/// M118: the message after A1, E1 and P, which precede it (Marlin M118.cpp). The bytes of a no-break space are parts
/// of letters too (`à`, `°`).
fn tell(text: &[u8]) -> ReportCommand<'_> {
    let is_space = |byte: u8| byte.is_ascii_whitespace();
    let (mut form, mut to) = (Form::Plain, Audience::Sender);
    let mut after = trim_start(text, is_space);
    while let [letter, digit @ b'0'..=b'9', tail @ ..] = after
        && tail.first().is_none_or(|byte| is_space(*byte))
    {
        match (letter.to_ascii_uppercase(), digit) {
            (b'A', b'0') | (b'E', b'0') => {}
            (b'P', b'0') => to = Audience::All,
            (b'P', line) => to = Audience::Line(line - b'0'),
            (b'A', _) => form = Form::Action,
            (b'E', _) if form == Form::Plain => form = Form::Echo,
            (b'E', _) => {}
            _ => break,
        }
        after = trim_start(tail, is_space);
    }
    ReportCommand::Tell { form, to, text: trim_end(after, is_space) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::parse::parse;

    #[test]
    fn messages_and_how_they_are_dressed() {
        let tell = |form, text| Command::Report(ReportCommand::Tell { form, to: Audience::Sender, text });
        assert_eq!(parse(b"M118 hello E1 "), tell(Form::Plain, b"hello E1"));
        assert_eq!(parse(b"M118 A1 action:pause"), tell(Form::Action, b"action:pause"));
        assert_eq!(parse(b"M118 E1 Layer 3"), tell(Form::Echo, b"Layer 3"));
        let to = |form, to| Command::Report(ReportCommand::Tell { form, to, text: b"Layer 3" });
        assert_eq!(parse(b"M118 E1 P0 Layer 3"), to(Form::Echo, Audience::All));
        assert_eq!(parse(b"M118 P2 A1 Layer 3"), to(Form::Action, Audience::Line(2)));
        assert_eq!(parse(b"M118 Layer P0"), tell(Form::Plain, b"Layer P0"));
        assert_eq!(parse(b"M118 A1 E1 x"), tell(Form::Action, b"x"));
        assert_eq!(parse(b"M118 A0 A12"), tell(Form::Plain, b"A12"));
        assert_eq!(parse(b"M118"), tell(Form::Plain, b""));
    }
}
