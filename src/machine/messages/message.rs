//! M117, M118: messages, for a display that is not there, and for hosts.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Mark, Nature};
use crate::text::{trim_end, trim_start};
use core::fmt::{self, Write};

/// Rows without a grammar: a text stands behind them.
pub(in crate::machine) const DISPLAY: Entry = Entry::m("Reports and messages", &[117])
    .nature(Nature::Report)
    .mark(Mark::SaidOnConnecting)
    .does("", "message for a display: none here")
    .examples(&[("M117 any; text *", &[])]);

pub(in crate::machine) const HOSTS: Entry = Entry::m("Reports and messages", &[118])
    .nature(Nature::Report)
    .does("A E P", "says the text to hosts")
    .examples(&[
        ("M118 A1 action:notification hi", &["//action:notification hi"]),
        ("M118 E1 hi", &["echo:hi"]),
        ("M118 hi", &["hi"]),
        ("M118 ok", &["echo:ok"]),
    ]);

/// How a message of M118 is dressed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Form {
    /// As it is.
    Plain,
    /// E1: `echo:` in front.
    Echo,
    /// A1: `//` in front, for an action command to the host.
    Action,
}

/// Forbidden beginnings of a message, in lower case: a host would take it for an answer (printcore, OctoPrint comm.py).
const RESERVED: [&[u8]; 10] =
    [b"ok", b"start", b"rs", b"resend", b"wait", b"error", b"fatal", b"!!", b"debug_", b"cap:"];

/// A message; displayed, it is the line. A text that a host would take for an answer is an echo.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Message<'a> {
    form: Form,
    text: &'a [u8],
}

impl fmt::Display for Message<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.form {
            Form::Action => "//",
            Form::Plain if !self.is_reserved() => "",
            Form::Plain | Form::Echo => "echo:",
        })?;
        match str::from_utf8(self.text) {
            Ok(text) => f.write_str(text),
            Err(_) => {
                self.text.iter().try_for_each(|&byte| f.write_char(if byte.is_ascii() { byte as char } else { '?' }))
            }
        }
    }
}

impl Message<'_> {
    fn is_reserved(&self) -> bool {
        RESERVED.iter().any(|begin| self.text.get(..begin.len()).is_some_and(|text| text.eq_ignore_ascii_case(begin)))
    }
}

/// The receivers of a message.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Audience {
    /// The host that sent it.
    Sender,
    /// P0: all hosts.
    All,
    /// P1 to P9: the host on that serial line, if there is one.
    Line(u8),
}

/// The message after A1, E1 and P, which precede it (Marlin M118.cpp). The bytes of a no-break space are parts of
/// letters too (`à`, `°`).
fn read(text: &[u8]) -> (Message<'_>, Audience) {
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
    (Message { form, text: trim_end(after, is_space) }, to)
}

/// A serial line that does not exist stands for the sender's, as in Marlin (M118.cpp).
pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    if command.code() == 117 {
        return Answer::Nothing;
    }
    let (message, to) = read(command.text());
    match to {
        Audience::Sender => {}
        Audience::All => main_loop.hosts.notify_others(format_args!("{message}")),
        Audience::Line(line) => {
            if main_loop.hosts.notify_other(usize::from(line).wrapping_sub(1), format_args!("{message}")) {
                return Answer::Nothing;
            }
        }
    }
    // Not as a text: what a host said is not unpacked.
    main_loop.tell(|to, _| to.put(&|replies| replies.line(format_args!("{message}"))));
    Answer::Said
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;

    #[test]
    fn messages_and_how_they_are_dressed() {
        let tell = |form, text| (Message { form, text }, Audience::Sender);
        assert_eq!(read(b" hello E1 "), tell(Form::Plain, b"hello E1"));
        assert_eq!(read(b" A1 action:pause"), tell(Form::Action, b"action:pause"));
        assert_eq!(read(b" E1 Layer 3"), tell(Form::Echo, b"Layer 3"));
        let to = |form, to| (Message { form, text: b"Layer 3".as_slice() }, to);
        assert_eq!(read(b" E1 P0 Layer 3"), to(Form::Echo, Audience::All));
        assert_eq!(read(b" P2 A1 Layer 3"), to(Form::Action, Audience::Line(2)));
        assert_eq!(read(b" Layer P0"), tell(Form::Plain, b"Layer P0"));
        assert_eq!(read(b" A1 E1 x"), tell(Form::Action, b"x"));
        assert_eq!(read(b" A0 A12"), tell(Form::Plain, b"A12"));
        assert_eq!(read(b""), tell(Form::Plain, b""));
    }
    #[test]
    fn an_answer_is_not_forged() {
        let line = |text: &str| format!("{}", Message { form: Form::Plain, text: text.as_bytes() });
        for text in ["ok", "OK T:20", "Start", "rs 5", "Resend: 5", "wait", "Error:x", "!! x", "DEBUG_X", "Cap:X"] {
            assert_eq!(line(text), format!("echo:{text}"));
        }
        for text in ["", "o", "not ok", "//action:pause", "Layer 5"] {
            assert_eq!(line(text), text);
        }
    }
}
