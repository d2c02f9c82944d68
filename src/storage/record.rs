//! Records: settings as bytes that prove to be whole.
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | `CHBS` |
//! | 4..6 | format: 1, or 2 for a record of two parts |
//! | 6..8 | length of the rest of the first part |
//! | 8..12 | sequence number |
//! | 12..16 | CRC-32 of all other bytes of the first part |
//! | 16..22 | only in format 2: length and CRC-32 of the second part |
//! | then | the settings: elements that say their id, width and number of values (`payload`) |
//!
//! Numbers are little-endian. CRC-32 finds every burst of up to 32 bits; of anything worse it misses one
//! in 2^32.
//!
//! A record of up to [`FIRST`] bytes has one part. A longer one has two parts, and its first part has [`FIRST`] bytes
//! and is whole by itself. So firmware that only knows format 1 reads all shorter records, and names the format of a
//! longer one instead of calling it damaged.

use super::payload::{Damaged, LONGEST_PAYLOAD, Unknown, read, write};
use crate::checksum::crc32;
use crate::settings::{Settings, SettingsError};

/// The newest format that this firmware knows. It need not change with the settings: an element with an unknown id is
/// kept as it is, and a setting without an element has its default.
pub const FORMAT: u16 = TWO_PARTS;

/// The format of a record of one part.
const ONE_PART: u16 = 1;

/// The format of a record of two parts.
const TWO_PARTS: u16 = 2;

const MAGIC: [u8; 4] = *b"CHBS";

pub(super) const HEADER: usize = 16;

/// Bytes of the length and the checksum of a second part.
const SECOND_HEADER: usize = 6;

/// Bytes of the longest record of one part, and of the first of two parts.
pub(super) const FIRST: usize = 1280;

/// Bytes of the longest record.
pub const LONGEST: usize = 1664;

/// Bytes of the longest payload that a record has room for; docs/explanation/flow.md says how many are free.
pub(super) const ROOM: usize = LONGEST - HEADER - SECOND_HEADER;

const _: () = assert!(LONGEST_PAYLOAD <= ROOM);

/// Why a slot's content is no settings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Rejected {
    /// There is no record.
    Blank,
    /// The record is not whole: a save was cut, or the memory fails.
    Damaged,
    /// The record is whole, but another firmware wrote it in this format.
    Format(u16),
    /// The record is whole, but this firmware forbids a value in it.
    Illegal(SettingsError),
    /// The record belongs to a machine with other motors.
    Mechanism,
}

impl core::fmt::Display for Rejected {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Blank => put!(f, "empty"),
            Self::Damaged => put!(f, "damaged"),
            Self::Format(format) => put!(f, "format V{format}, this firmware has V{FORMAT}"),
            // Not the error itself: setting names hold `_max`, which OctoPrint takes for an endstop report.
            Self::Illegal(_) => put!(f, "a value is outside its legal range"),
            Self::Mechanism => put!(f, "for a machine with another mechanism"),
        }
    }
}

/// Size and checksum of a stored record, for the user to compare.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Receipt {
    /// Bytes of the whole record.
    pub bytes: usize,
    /// Its CRC-32.
    pub crc: u32,
}

impl core::fmt::Display for Receipt {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        put!(f, "({} bytes; crc {:08X})", self.bytes, self.crc)
    }
}

/// The header of a record.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Header {
    format: u16,
    length: u16,
    sequence: u32,
}

impl Header {
    fn to_bytes(self) -> [u8; 12] {
        let ([m0, m1, m2, m3], [f0, f1], [l0, l1]) = (MAGIC, self.format.to_le_bytes(), self.length.to_le_bytes());
        let [s0, s1, s2, s3] = self.sequence.to_le_bytes();
        [m0, m1, m2, m3, f0, f1, l0, l1, s0, s1, s2, s3]
    }

    /// The header and the checksum after it.
    fn read(bytes: &[u8]) -> Option<(Self, u32)> {
        let [m0, m1, m2, m3, f0, f1, l0, l1, s0, s1, s2, s3, c0, c1, c2, c3] = *bytes.first_chunk::<HEADER>()?;
        let header = Self {
            format: u16::from_le_bytes([f0, f1]),
            length: u16::from_le_bytes([l0, l1]),
            sequence: u32::from_le_bytes([s0, s1, s2, s3]),
        };
        ([m0, m1, m2, m3] == MAGIC).then_some((header, u32::from_le_bytes([c0, c1, c2, c3])))
    }
}

/// Writes the record of `settings` and of elements that this firmware does not know; `None` if they do not fit, which
/// the assertion above excludes.
pub(super) fn encode(
    settings: &Settings,
    unknown: &Unknown,
    sequence: u32,
    record: &mut [u8; LONGEST],
) -> Option<Receipt> {
    let length = write(settings, unknown, record.get_mut(HEADER..)?)?;
    finish(record, length, sequence)
}

/// Makes a record of a payload of so many bytes that stands behind the place for a header.
fn finish(record: &mut [u8; LONGEST], length: usize, sequence: u32) -> Option<Receipt> {
    let bytes = HEADER + length;
    if bytes <= FIRST { seal(record, ONE_PART, bytes, sequence) } else { seal_two_parts(record, length, sequence) }
}

/// Makes room in front of a payload, and makes two parts of it.
fn seal_two_parts(record: &mut [u8; LONGEST], length: usize, sequence: u32) -> Option<Receipt> {
    let begin = HEADER + SECOND_HEADER;
    let bytes = Some(begin + length).filter(|bytes| *bytes <= LONGEST)?;
    record.copy_within(HEADER..HEADER + length, begin);
    let second = record.get(FIRST..bytes)?;
    let ([l0, l1], [c0, c1, c2, c3]) =
        (u16::try_from(second.len()).ok()?.to_le_bytes(), crc32(&[second]).to_le_bytes());
    record.get_mut(HEADER..begin)?.copy_from_slice(&[l0, l1, c0, c1, c2, c3]);
    seal(record, TWO_PARTS, FIRST, sequence).map(|receipt| Receipt { bytes, ..receipt })
}

/// Writes the header of a part of so many bytes.
fn seal(record: &mut [u8; LONGEST], format: u16, bytes: usize, sequence: u32) -> Option<Receipt> {
    let (head, rest) = record.get_mut(..bytes)?.split_at_mut_checked(HEADER)?;
    let header = Header { format, length: u16::try_from(rest.len()).ok()?, sequence }.to_bytes();
    let crc = crc32(&[&header, rest]);
    let (place, crc_place) = head.split_at_mut_checked(header.len())?;
    place.copy_from_slice(&header);
    crc_place.copy_from_slice(&crc.to_le_bytes());
    Some(Receipt { bytes, crc })
}

/// The length and the checksum of the second part, by the bytes after a header.
fn second_part(after_header: &[u8]) -> Option<(usize, u32)> {
    let [l0, l1, c0, c1, c2, c3] = *after_header.first_chunk::<SECOND_HEADER>()?;
    Some((u16::from_le_bytes([l0, l1]).into(), u32::from_le_bytes([c0, c1, c2, c3])))
}

/// Bytes of the record that begins with `head`.
pub(super) fn length(head: &[u8]) -> Result<usize, Rejected> {
    let (header, _) = Header::read(head).ok_or(Rejected::Blank)?;
    let second = head.get(HEADER..).filter(|_| header.format == TWO_PARTS).and_then(second_part);
    let length = HEADER + usize::from(header.length) + second.map_or(0, |(length, _)| length);
    if length <= LONGEST { Ok(length) } else { Err(Rejected::Damaged) }
}

/// The content of a record apart from its settings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Decoded {
    /// Elements that this firmware does not know.
    pub unknown: Unknown,
    /// Which save it was.
    pub sequence: u32,
    /// Its size and checksum.
    pub receipt: Receipt,
}

/// Reads a record into `settings`, which are all legal then. They go to a place of the caller's, because they are
/// large: a result would be a second copy on the stack.
///
/// # Errors
/// Why there are no settings; `settings` may hold anything then.
pub(super) fn decode(record: &[u8], settings: &mut Settings) -> Result<Decoded, Rejected> {
    let (header, crc) = Header::read(record).ok_or(Rejected::Blank)?;
    let first = HEADER + usize::from(header.length);
    let rest = record.get(HEADER..first).ok_or(Rejected::Damaged)?;
    // Before the format: only a whole record can be said to be of another firmware.
    if crc32(&[&header.to_bytes(), rest]) != crc {
        return Err(Rejected::Damaged);
    }
    let (payload, bytes) = match header.format {
        ONE_PART => (rest, first),
        TWO_PARTS => {
            let (length, crc) = second_part(rest).ok_or(Rejected::Damaged)?;
            let second = record.get(first..first + length).ok_or(Rejected::Damaged)?;
            if crc32(&[second]) != crc {
                return Err(Rejected::Damaged);
            }
            (record.get(HEADER + SECOND_HEADER..first + length).unwrap_or_default(), first + length)
        }
        other => return Err(Rejected::Format(other)),
    };
    let unknown = read(payload, settings).map_err(|Damaged| Rejected::Damaged)?;
    settings.check().map_err(Rejected::Illegal)?;
    Ok(Decoded { unknown, sequence: header.sequence, receipt: Receipt { bytes, crc } })
}

#[cfg(test)]
mod tests;
