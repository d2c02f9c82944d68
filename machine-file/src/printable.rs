//! Printable text: text from a file or a printer must not control the terminal.

use std::borrow::Cow;
use std::fmt::Write as _;

/// A text without control characters: each is written as `\x1b` or `\u{202e}`. Line ends within are kept if `line_ends`
/// says so.
fn escaped(text: &str, line_ends: bool) -> Cow<'_, str> {
    let is_command = |c: char| (c.is_control() && !(line_ends && c == '\n')) || is_direction(c);
    if !text.contains(is_command) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::new();
    for c in text.chars() {
        let written = match c {
            '\t' => write!(shown, "\\t"),
            c if is_command(c) && c < '\u{100}' => write!(shown, "\\x{:02x}", u32::from(c)),
            c if is_command(c) => write!(shown, "\\u{{{:x}}}", u32::from(c)),
            c => {
                shown.push(c);
                Ok(())
            }
        };
        // A String takes everything.
        debug_assert!(written.is_ok());
    }
    Cow::Owned(shown)
}

/// Whether a character turns the direction of the text after it (Unicode, bidirectional formatting characters).
const fn is_direction(c: char) -> bool {
    matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// One line that is safe to show.
#[must_use]
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, false)
}

/// Lines that are safe to show.
#[must_use]
pub fn lines(text: &str) -> Cow<'_, str> {
    escaped(text, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_commands_a_terminal_gets_through() {
        assert_eq!(line("M9999 \x1b[31m\u{9b}2J\u{7f}\n\u{202e}ü\t"), "M9999 \\x1b[31m\\x9b2J\\x7f\\x0a\\u{202e}ü\\t");
        assert_eq!(lines("a\nb\r"), "a\nb\\x0d");
        assert!(matches!(line("plain"), Cow::Borrowed(_)));
    }
}
