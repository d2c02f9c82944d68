//! M117, M118: messages, for a display that is not there, and for hosts.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Mark, Nature};
use crate::machine::answers::message::{Form, Message};
use crate::text::{trim_end, trim_start};

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
    Answer::Message(message)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
