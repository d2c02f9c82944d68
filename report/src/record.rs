//! Record: everything of a print that a viewer shows. It is one JSON object and three streams of bytes.
//!
//! | stream | a blob is |
//! |---|---|
//! | `path` | a chunk of the [way of the tool](crate::path) |
//! | `moves` | a chunk of the [moves](crate::moves) |
//! | `gcode` | whole lines of the file, about [`BLOB`] bytes |
//!
//! A page in one file holds the blobs packed, and a page with the simulator in it takes them [as they
//! are](crate::print::Page::record).

use serde::Serialize;
use std::io::{self, BufRead, BufReader, Read, Seek};

/// Bytes of a blob of G-code, about.
pub const BLOB: usize = 256 << 10;

/// A print as a viewer takes it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Record {
    /// The JSON object.
    pub data: String,
    /// The way of the tool.
    pub path: Vec<Vec<u8>>,
    /// The moves.
    pub moves: Vec<Vec<u8>>,
    /// The file's text.
    pub gcode: Vec<Vec<u8>>,
}

/// The first line of a blob of G-code, from 1, and its number of lines.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct TextChunk(pub u32, pub u32);

/// Reads a text in blobs of whole lines, given its first line's number. Text that is not UTF-8 is replaced.
///
/// # Errors
/// The error from `from`, or from `each`.
pub(crate) fn text_blobs(from: impl Read, mut each: impl FnMut(TextChunk, &[u8]) -> io::Result<()>) -> io::Result<()> {
    let mut from = BufReader::new(from);
    let (mut blob, mut chunk) = (Vec::new(), TextChunk(1, 0));
    loop {
        let is_end = from.read_until(b'\n', &mut blob)? == 0;
        chunk.1 += u32::from(!is_end);
        if blob.len() >= BLOB || is_end && !blob.is_empty() {
            each(chunk, String::from_utf8_lossy(&blob).as_bytes())?;
            blob.clear();
            chunk = TextChunk(chunk.0 + chunk.1, 0);
        }
        if is_end {
            return Ok(());
        }
    }
}

/// Reads blobs of these sizes from the begin of a file.
///
/// # Errors
/// The error from the file, or from `each`.
pub(crate) fn blobs<F: Read + Seek>(
    mut file: F,
    sizes: impl Iterator<Item = usize>,
    mut each: impl FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    file.rewind()?;
    let mut from = BufReader::new(file);
    let mut bytes = Vec::new();
    for size in sizes {
        bytes.resize(size, 0);
        from.read_exact(&mut bytes)?;
        each(&bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blobs_of_text_are_whole_lines_and_all_of_it() {
        let line = "G1 X10 Y20 ; \u{e9}\n";
        let text = line.repeat(3 * BLOB / line.len()) + "M84";
        let (mut whole, mut lines) = (Vec::new(), 1);
        text_blobs(text.as_bytes(), |TextChunk(first, count), blob| {
            assert_eq!(first, lines);
            assert!(blob.len() < BLOB + line.len());
            assert!(blob.ends_with(b"\n") || blob.ends_with(b"M84"));
            lines += count;
            whole.extend_from_slice(blob);
            Ok(())
        })
        .unwrap();
        assert_eq!(whole, text.as_bytes());
        assert_eq!(lines as usize, text.lines().count() + 1);
        text_blobs(&b""[..], |_, _| panic!("nothing to show")).unwrap();
    }
}
