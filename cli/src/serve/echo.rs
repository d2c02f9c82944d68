//! Echo: shows typed text, for terminals without an echo of their own.

/// Shows typed text on a line that the printer reads in raw mode.
#[derive(Default)]
pub(crate) struct Echo {
    /// Characters of the line that is being typed.
    column: usize,
    /// The last character was a carriage return; a line feed after it does not end another line.
    has_returned: bool,
}

impl Echo {
    /// The echo of `typed`: printable characters as they are, line ends as a terminal wants them, and a blank in place
    /// of an erased character.
    pub fn show(&mut self, typed: &[u8]) -> Vec<u8> {
        let mut shown = Vec::new();
        for &byte in typed {
            let had_returned = std::mem::replace(&mut self.has_returned, byte == b'\r');
            match byte {
                b'\n' if had_returned => {}
                b'\r' | b'\n' => {
                    shown.extend(b"\r\n");
                    self.column = 0;
                }
                0x08 | 0x7F if self.column > 0 => {
                    shown.extend(b"\x08 \x08");
                    self.column -= 1;
                }
                b' '..=b'~' => {
                    shown.push(byte);
                    self.column += 1;
                }
                _ => {}
            }
        }
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_is_shown_and_what_is_erased_is_gone() {
        let mut echo = Echo::default();
        assert_eq!(echo.show(b"M1\x0815\r"), b"M1\x08 \x0815\r\n");
        assert_eq!(echo.show(b"\n\x08\x7F\x1b"), b"");
        assert_eq!(echo.show(b"ab\x7F\x7F\x7F\n"), b"ab\x08 \x08\x08 \x08\r\n");
    }
}
