//! Records: settings as bytes that prove to be whole.
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | `CHBS` |
//! | 4..6 | format of the payload |
//! | 6..8 | length of the payload |
//! | 8..12 | sequence number |
//! | 12..16 | CRC-32 of all other bytes |
//! | 16.. | the settings: elements that say their id, width and number of values (`payload`) |
//!
//! Numbers are little-endian. CRC-32 finds every burst of up to 32 bits; of anything worse it misses one
//! in 2^32.

use super::payload::{Damaged, LONGEST_PAYLOAD, Unknown, read, write};
use crate::checksum::crc32;
use crate::settings::{Settings, SettingsError};

/// The version of the payload's format. It need not change with the settings: an element with an unknown id is kept as
/// it is, and a setting without an element has its default.
pub const FORMAT: u16 = 1;

const MAGIC: [u8; 4] = *b"CHBS";

pub(super) const HEADER: usize = 16;

/// Bytes of the longest record.
pub const LONGEST: usize = 1280;

const _: () = assert!(HEADER + LONGEST_PAYLOAD <= LONGEST);

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
            Self::Blank => f.write_str("empty"),
            Self::Damaged => f.write_str("damaged"),
            Self::Format(format) => write!(f, "format V{format}, this firmware has V{FORMAT}"),
            // Not the error itself: setting names hold `_max`, which OctoPrint takes for an endstop report.
            Self::Illegal(_) => f.write_str("a value is outside its legal range"),
            Self::Mechanism => f.write_str("for a machine with another mechanism"),
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
        write!(f, "({} bytes; crc {:08X})", self.bytes, self.crc)
    }
}

/// The bytes of a record.
pub(super) struct Record {
    pub bytes: [u8; LONGEST],
    pub receipt: Receipt,
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

/// The record of `settings` and of elements that this firmware does not know, or `None` if they do not fit, which the
/// assertion above excludes.
pub(super) fn encode(settings: &Settings, unknown: &Unknown, sequence: u32) -> Option<Record> {
    let mut bytes = [0; LONGEST];
    let (head, payload) = bytes.split_at_mut(HEADER);
    let length = write(settings, unknown, payload)?;
    let payload = payload.get(..length)?;
    let header = Header { format: FORMAT, length: u16::try_from(length).ok()?, sequence }.to_bytes();
    let crc = crc32(header.into_iter().chain(payload.iter().copied()));
    for (to, byte) in head.iter_mut().zip(header.into_iter().chain(crc.to_le_bytes())) {
        *to = byte;
    }
    let receipt = Receipt { bytes: HEADER + payload.len(), crc };
    Some(Record { bytes, receipt })
}

/// Bytes of the record that begins with `head`.
pub(super) fn length(head: &[u8]) -> Result<usize, Rejected> {
    let (header, _) = Header::read(head).ok_or(Rejected::Blank)?;
    let length = HEADER + usize::from(header.length);
    if length <= LONGEST { Ok(length) } else { Err(Rejected::Damaged) }
}

/// The content of a record.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Decoded {
    /// The settings, all legal.
    pub settings: Settings,
    /// Elements that this firmware does not know.
    pub unknown: Unknown,
    /// Which save it was.
    pub sequence: u32,
    /// Its size and checksum.
    pub receipt: Receipt,
}

/// The content of a record.
///
/// # Errors
/// Why there are no settings.
pub(super) fn decode(record: &[u8]) -> Result<Decoded, Rejected> {
    let (header, crc) = Header::read(record).ok_or(Rejected::Blank)?;
    let payload = record.get(HEADER..HEADER + usize::from(header.length)).ok_or(Rejected::Damaged)?;
    if crc32(header.to_bytes().into_iter().chain(payload.iter().copied())) != crc {
        return Err(Rejected::Damaged);
    }
    if header.format != FORMAT {
        return Err(Rejected::Format(header.format));
    }
    let (settings, unknown) = read(payload).map_err(|Damaged| Rejected::Damaged)?;
    settings.check().map_err(Rejected::Illegal)?;
    Ok(Decoded {
        settings,
        unknown,
        sequence: header.sequence,
        receipt: Receipt { bytes: HEADER + payload.len(), crc },
    })
}

#[cfg(test)]
mod tests;
