//! M118: messages for the host.

use crate::gcode::Form;
use crate::machine::answers::speaker::Speaker;
use core::fmt::{self, Write};

/// What a message may not begin with, in lower case: a host would take it for an answer (printcore, OctoPrint comm.py).
const RESERVED: [&[u8]; 10] =
    [b"ok", b"start", b"rs", b"resend", b"wait", b"error", b"fatal", b"!!", b"debug_", b"cap:"];

/// A message in printable ASCII.
struct Message<'a>(&'a [u8]);

impl fmt::Display for Message<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|&byte| f.write_char(if matches!(byte, b' '..=b'~') { byte as char } else { '?' }))
    }
}

impl Message<'_> {
    fn is_reserved(&self) -> bool {
        RESERVED.iter().any(|begin| self.0.get(..begin.len()).is_some_and(|text| text.eq_ignore_ascii_case(begin)))
    }
}

/// M118. A text that a host would take for an answer is told as an echo.
pub(in crate::machine) fn say_message(to: &mut Speaker<'_>, form: Form, text: &[u8]) {
    let message = Message(text);
    match form {
        Form::Action => to.say(format_args!("//{message}")),
        Form::Plain if !message.is_reserved() => to.say(format_args!("{message}")),
        Form::Plain | Form::Echo => to.say(format_args!("echo:{message}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_not_forged() {
        for text in ["ok", "OK T:20", "Start", "rs 5", "Resend: 5", "wait", "Error:x", "!! x", "DEBUG_X", "Cap:X"] {
            assert!(Message(text.as_bytes()).is_reserved(), "{text}");
        }
        for text in ["", "o", "not ok", "//action:pause", "Layer 5"] {
            assert!(!Message(text.as_bytes()).is_reserved(), "{text}");
        }
    }
}
