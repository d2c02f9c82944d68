//! M118: messages for hosts.

use core::fmt::{self, Write};

/// How a message of M118 is dressed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Form {
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
pub(in crate::machine) struct Message<'a> {
    pub form: Form,
    pub text: &'a [u8],
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

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;

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
