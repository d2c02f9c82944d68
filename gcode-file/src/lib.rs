//! G-code files as people have them, and the text in them.
//!
//! | file | job |
//! |---|---|
//! | `binary` | the blocks of binary G-code (.bgcode) |
//! | `heatshrink`, `meatpack` | how such blocks may be packed and encoded |
//! | `archive`, `plate` | the plates of a .3mf, or the file in another ZIP archive |
//! | `text` | line ends, and a bound for what inflates |
//!
//! The text has the lines that a printer gets, so its line numbers count in messages and reports. What has a text
//! already stays as it is ([`Unpacked::AsItIs`]). A damaged file is refused; half of a print is no print.
//!
//! Nothing here opens a file, so the page reads the same files by the same rules.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod archive;
mod binary;
mod error;
mod heatshrink;
mod meatpack;
mod plate;
mod text;

use corehbot_machine_file::file_kind::{FileKind, START, Wanted};
pub use error::GcodeFileError;
use flate2::read::MultiGzDecoder;
pub use plate::Plate;
use std::io::{BufReader, Chain, Cursor, Read, Seek, SeekFrom, Write};
use text::{Bounded, LineFeeds, has_old_ends};

/// Where the text is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Unpacked {
    /// The file is the text.
    AsItIs,
    /// The text was written.
    Written,
}

/// The plates in a file, by their numbers: none unless it is an archive of them.
///
/// # Errors
/// It cannot be read, or is a damaged archive.
pub fn plates(mut from: impl Read + Seek) -> Result<Vec<Plate>, GcodeFileError> {
    let (kind, _) = kind_of(&mut from)?;
    if kind == FileKind::Zip { archive::plates(from) } else { Ok(Vec::new()) }
}

/// Writes the text of a file, `most` bytes of it at most; `plate` chooses one of several.
///
/// # Errors
/// It is no G-code, damaged, longer than `most`, or has several plates and none is chosen.
pub fn unpack(
    mut from: impl Read + Seek,
    into: impl Write,
    plate: Option<u32>,
    most: u64,
) -> Result<Unpacked, GcodeFileError> {
    let (kind, _) = kind_of(&mut from)?;
    Wanted::Gcode.check(kind)?;
    if plate.is_some() && kind != FileKind::Zip {
        return Err(GcodeFileError::NoPlates);
    }
    let mut into = LineFeeds::new(Bounded::new(into, most));
    match kind {
        FileKind::BinaryGcode => binary::unpack(from, &mut into, most)?,
        FileKind::Gzip => copy_text(MultiGzDecoder::new(BufReader::new(from)), &mut into)?,
        FileKind::Zip => archive::unpack(from, plate, |text| copy_text(text, &mut into))?,
        _ if has_old_ends(&mut from)? => {
            from.rewind()?;
            std::io::copy(&mut from, &mut into)?;
        }
        _ => {
            from.rewind()?;
            return Ok(Unpacked::AsItIs);
        }
    }
    into.flush()?;
    Ok(Unpacked::Written)
}

/// What a file is; it is then at its begin again.
fn kind_of(from: &mut (impl Read + Seek)) -> Result<(FileKind, u64), GcodeFileError> {
    let length = from.seek(SeekFrom::End(0))?;
    from.rewind()?;
    let mut start = Vec::new();
    from.take(START as u64).read_to_end(&mut start)?;
    from.rewind()?;
    Ok((FileKind::of(&start, length), length))
}

/// Copies what was packed, if it is the text of G-code.
fn copy_text(mut packed: impl Read, into: &mut impl Write) -> Result<(), GcodeFileError> {
    let mut start = Vec::new();
    packed.by_ref().take(START as u64).read_to_end(&mut start)?;
    // Only a text that ends within its begin is whole there.
    let length = start.len() as u64 + u64::from(start.len() == START);
    let kind = FileKind::of(&start, length);
    if matches!(kind, FileKind::BinaryGcode | FileKind::Gzip | FileKind::Zip) {
        return Err(GcodeFileError::Nested(kind));
    }
    Wanted::Gcode.check(kind)?;
    let mut all: Chain<Cursor<Vec<u8>>, _> = Cursor::new(start).chain(packed);
    std::io::copy(&mut all, into)?;
    Ok(())
}
