//! Text on its way: line ends, and a bound for what inflates.

use std::io::{self, Read, Write};

/// Bytes that are read at once.
const PIECE: usize = 64 << 10;

/// Writes carriage returns that end a line as line feeds. Those before a line feed belong to its line's end and are
/// left out.
pub(crate) struct LineFeeds<W> {
    into: W,
    /// Carriage returns of which the next byte is not known yet.
    pending: usize,
    buffer: Vec<u8>,
}

impl<W: Write> LineFeeds<W> {
    pub(crate) const fn new(into: W) -> Self {
        Self { into, pending: 0, buffer: Vec::new() }
    }

    fn end_lines(&mut self) {
        self.buffer.resize(self.buffer.len() + std::mem::take(&mut self.pending), b'\n');
    }
}

impl<W: Write> Write for LineFeeds<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.buffer.clear();
        for piece in bytes.chunk_by(|a, b| (*a == b'\r') == (*b == b'\r')) {
            match piece {
                [b'\r', ..] => self.pending += piece.len(),
                [b'\n', ..] => {
                    self.pending = 0;
                    self.buffer.extend_from_slice(piece);
                }
                _ => {
                    self.end_lines();
                    self.buffer.extend_from_slice(piece);
                }
            }
        }
        self.into.write_all(&self.buffer)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.buffer.clear();
        self.end_lines();
        self.into.write_all(&self.buffer)?;
        self.into.flush()
    }
}

/// Refuses more bytes than a bound.
pub(crate) struct Bounded<W> {
    into: W,
    most: u64,
    left: u64,
}

impl<W: Write> Bounded<W> {
    pub(crate) const fn new(into: W, most: u64) -> Self {
        Self { into, most, left: most }
    }
}

impl<W: Write> Write for Bounded<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(left) = self.left.checked_sub(bytes.len() as u64) else {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, self.most.to_string()));
        };
        self.into.write_all(bytes)?;
        self.left = left;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.into.flush()
    }
}

/// Whether carriage returns alone end lines of a text.
///
/// # Errors
/// It cannot be read.
pub(crate) fn has_old_ends(from: &mut impl Read) -> io::Result<bool> {
    let mut piece = vec![0; PIECE];
    let mut was_return = false;
    loop {
        let length = match from.read(&mut piece) {
            Ok(0) => return Ok(was_return),
            Ok(length) => length,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        let read = &piece[..length];
        if was_return && !matches!(read[0], b'\r' | b'\n') {
            return Ok(true);
        }
        if read.windows(2).any(|pair| pair[0] == b'\r' && !matches!(pair[1], b'\r' | b'\n')) {
            return Ok(true);
        }
        was_return = read.ends_with(b"\r");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(pieces: &[&[u8]]) -> Vec<u8> {
        let mut found = Vec::new();
        let mut into = LineFeeds::new(&mut found);
        pieces.iter().for_each(|piece| into.write_all(piece).unwrap());
        into.flush().unwrap();
        found
    }

    #[test]
    fn every_old_end_of_a_line_becomes_a_new_one_wherever_a_piece_ends() {
        let text = b";a\rG28\r\rG1\r\r\nM84\n\r\nend\r";
        for cut in 0..text.len() {
            assert_eq!(ends(&[&text[..cut], &text[cut..]]), b";a\nG28\n\nG1\nM84\n\nend\n", "{cut}");
        }
        for (text, is_old) in [
            (&b"a\nb"[..], false),
            (b"a\r\nb\r\r\n", false),
            (b"a\rb", true),
            (b"a\n\rb", true),
            (b"a\r", true),
            (b"", false),
        ] {
            assert_eq!(has_old_ends(&mut &*text).unwrap(), is_old, "{text:?}");
        }
    }

    #[test]
    fn more_than_the_bound_is_refused() {
        let mut into = Bounded::new(Vec::new(), 4);
        into.write_all(b"abcd").unwrap();
        assert_eq!(into.write_all(b"e").unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        assert_eq!(into.into, b"abcd");
    }
}
