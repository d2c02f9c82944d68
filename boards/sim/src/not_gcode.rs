//! Not G-code: files that slicers and people mistake for it, and lines that no printer can take.

use crate::lines::LONGEST_LINE;
use anyhow::{Result, bail, ensure};

/// Bytes that identify a kind of file.
pub const HEAD: usize = 512;

const UTF_16: &str = "text in UTF-16; save it as UTF-8, or use `iconv -f UTF-16 -t UTF-8 FILE`";

/// Kinds of files by their first bytes, and a hint for each.
const KINDS: [(&[u8], &str); 16] = [
    (
        b"GCDE",
        "binary G-code (.bgcode); PrusaSlicer's File > Convert makes plain G-code of it, and Printer Settings > \
         General > Supports binary G-code switches it off",
    ),
    (
        b"PK\x03\x04",
        "a ZIP archive (.3mf, .ufp); export plain G-code, or unpack it: Bambu's G-code is Metadata/plate_1.gcode in it",
    ),
    (b"\x1f\x8b", "packed by gzip; unpack it, as by `gunzip FILE`"),
    (b"BZh", "packed by bzip2; unpack it, as by `bunzip2 FILE`"),
    (b"\xfd7zXZ\0", "packed by xz; unpack it, as by `unxz FILE`"),
    (b"\x28\xb5\x2f\xfd", "packed by zstd; unpack it, as by `unzstd FILE`"),
    (b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive; unpack it"),
    (b"\xff\xfe\0\0", "text in UTF-32; save it as UTF-8, or use `iconv -f UTF-32 -t UTF-8 FILE`"),
    (b"\xff\xfe", UTF_16),
    (b"\xfe\xff", UTF_16),
    (b"\x7fELF", "a program; an image of the firmware runs with `cargo xtask emulate`"),
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"solid ", "a model (STL); slice it first"),
    (b"ISO-10303-21", "a model (STEP); slice it first"),
];

/// Refuses a file by its first [`HEAD`] bytes.
///
/// # Errors
/// What it is instead of G-code, and what to do.
pub fn check_head(head: &[u8]) -> Result<()> {
    if let Some((_, kind)) = KINDS.iter().find(|(begin, _)| head.starts_with(begin)) {
        bail!("this is not G-code but {kind}");
    }
    // Without a mark, half of the bytes of such a text are 0 all the same.
    let zeros = head.iter().filter(|byte| **byte == 0).count();
    if 5 * zeros > 2 * head.len() && head.chunks(2).all(|pair| pair.contains(&0) != pair.iter().all(|b| *b == 0)) {
        bail!("this is not G-code but {UTF_16}");
    }
    ensure!(zeros == 0, "this is not G-code but binary data");
    Ok(())
}

/// Refuses a line, with its number, of which `command` is what comes before a comment.
///
/// # Errors
/// It is not text, or no line.
pub fn check_line(number: u32, line: &str, command: &str) -> Result<()> {
    ensure!(!line.contains('\0'), "line {number} contains a zero byte: this is not text");
    ensure!(command.len() < LONGEST_LINE, "line {number} is longer than a MiB: this is not G-code");
    let is_one = !command.trim_end().contains('\r');
    ensure!(is_one, "line {number} has a carriage return in it: save the file with LF or CRLF at the end of lines");
    Ok(())
}
