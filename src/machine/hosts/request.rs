//! The request in a host's line.

use crate::gcode::Command;
use crate::protocol::ResendReason;

/// Makes the command of a line, by the machine's table.
pub(in crate::machine) type Parse = fn(&[u8]) -> Command<'_>;

/// The request of a line; a command's text is elsewhere.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Request {
    /// To carry out a command.
    Command,
    /// The reply is `ok`.
    Nothing,
    /// M110, with its line number.
    LineNumber(Option<i32>),
    /// Too much.
    TooLong,
    /// The line is requested again.
    Resend(ResendReason, i32),
    /// Nothing: the host is silent, and gets the question for the line after this one.
    Question(i32),
}
