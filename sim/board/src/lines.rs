//! Lines: a text of any size, read line by line in bounded memory.

use crate::file_line::command_of;
use anyhow::Result;
use std::borrow::Cow;
use std::io::{self, BufRead, Cursor, Read as _};

/// Longest line that is kept whole; of a longer one, which can only be a comment, the begin is.
pub const LONGEST_LINE: usize = 1 << 20;

/// The content of a file.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Survey {
    /// Its lines.
    pub lines: u32,
    /// Lines with a command.
    pub commands: u64,
}

/// Reads lines of any length in bounded memory.
pub struct Lines<R> {
    from: R,
    bytes: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    /// The lines of a text.
    #[must_use]
    pub const fn new(from: R) -> Self {
        Self { from, bytes: Vec::new() }
    }

    /// The next line without its end, `None` after the last. Bytes that are not UTF-8 are replaced; they can only stand
    /// in comments.
    ///
    /// # Errors
    /// The file's error.
    pub fn next_line(&mut self) -> io::Result<Option<Cow<'_, str>>> {
        self.bytes.clear();
        if self.from.by_ref().take(LONGEST_LINE as u64).read_until(b'\n', &mut self.bytes)? == 0 {
            return Ok(None);
        }
        if self.bytes.last() != Some(&b'\n') {
            // Too long, or the last one.
            self.from.skip_until(b'\n')?;
        }
        let line = self.bytes.strip_suffix(b"\n").unwrap_or(&self.bytes);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        Ok(Some(String::from_utf8_lossy(line)))
    }
}

/// Counts the commands of `lines`, and shows `each` line with its number and its command, which may be empty.
///
/// # Errors
/// If the file cannot be read, or the error from `each`.
pub fn survey(lines: &mut Lines<impl BufRead>, mut each: impl FnMut(u32, &str, &str) -> Result<()>) -> Result<Survey> {
    let mut survey = Survey::default();
    while let Some(line) = lines.next_line()? {
        survey.lines += 1;
        let (command, _) = command_of(&line);
        survey.commands += u64::from(!command.is_empty());
        each(survey.lines, &line, &command)?;
    }
    Ok(survey)
}

/// The lines of a text in memory.
#[must_use]
pub fn lines_of(text: &str) -> Lines<Box<dyn BufRead + Send>> {
    Lines::new(Box::new(Cursor::new(text.as_bytes().to_vec())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_those_that_an_editor_shows() {
        let mut lines = lines_of("a\r\n\n; \u{e9}\nlast");
        let mut seen = Vec::new();
        while let Some(line) = lines.next_line().unwrap() {
            seen.push(line.into_owned());
        }
        assert_eq!(seen, ["a", "", "; \u{e9}", "last"]);
    }

    #[test]
    fn a_comment_of_any_length_takes_no_memory() {
        let mut text = b"G28\nG1 X5 ;".to_vec();
        text.resize(5 << 20, b'x');
        text.extend(b"\nG1 X6\n");
        let mut lines = Lines::new(text.as_slice());
        while let Some(line) = lines.next_line().unwrap() {
            assert!(line.len() <= LONGEST_LINE);
        }
        assert!(lines.bytes.capacity() <= 2 * LONGEST_LINE, "{}", lines.bytes.capacity());
    }
}
