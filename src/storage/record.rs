//! Records: settings as bytes that prove to be whole.
//!
//! | bytes | what |
//! |---|---|
//! | 0..4 | `CHBS` |
//! | 4..6 | format of the payload |
//! | 6..8 | length of the payload |
//! | 8..12 | sequence number |
//! | 12..16 | CRC-32 of all other bytes |
//! | 16.. | the settings in postcard's encoding |
//!
//! Numbers are little-endian. CRC-32 finds every burst of up to 32 bits; of anything worse it misses one
//! in 2^32.

use crate::checksum::crc32;
use crate::connectors::HEATERS;
use crate::kinematics::Mechanism;
use crate::settings::{
    Advance, Axes, AxisSettings, Bed, Belt, Cartesian, CornerRule, Endstop, EndstopPlug, HeaterModel, Homing,
    MachineName, Pause, Pid, Settings, SettingsError, Shapers, Wiring,
};

/// What the payload looks like. Every released change of the shape of [`Settings`] needs the next number; a test
/// notices when that was forgotten. Records of other formats are refused, and the user is told.
pub const FORMAT: u16 = 15;

const MAGIC: [u8; 4] = *b"CHBS";

pub(super) const HEADER: usize = 16;

/// Bytes of the longest record.
pub const LONGEST: usize = 1280;

/// What of the settings has no u16, as far as it lies together without padding.
type Wide = (
    Axes<AxisSettings>,
    Cartesian<Homing>,
    Shapers,
    Cartesian<Endstop>,
    [(HeaterModel, Pid); HEATERS],
    Bed,
    Belt,
    Pause,
    Advance,
    CornerRule,
);

/// Names of connectors: eight bytes, before which stands their length, and a `bool`.
type Plugs = (Wiring, EndstopPlug);

/// The longest payload. Postcard writes an integer of n bytes in at most n * 8 / 7 rounded up: 3 for u16, 5 for u32, 19 for i128,
/// which the mechanism is stored as.
const LONGEST_PAYLOAD: usize = {
    let (wide, plugs) = (size_of::<Wide>(), size_of::<Plugs>());
    // A text, before which stands its length.
    let name = MachineName::LONGEST;
    let rest = size_of::<Settings>() - size_of::<Mechanism>() - plugs - wide - name;
    rest * 3 / 2 + wide * 5 / 4 + 19 + plugs * 10 / 9 + name + 1
};
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
    /// The record is that of a machine with other motors.
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

/// The record of `settings`, or `None` if they do not fit, which the assertion above excludes.
pub(super) fn encode(settings: &Settings, sequence: u32) -> Option<Record> {
    let mut bytes = [0; LONGEST];
    let (head, payload) = bytes.split_at_mut(HEADER);
    let payload = postcard::to_slice(settings, payload).ok()?;
    let header = Header { format: FORMAT, length: u16::try_from(payload.len()).ok()?, sequence }.to_bytes();
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

/// The settings and the sequence number in a record.
pub(super) fn decode(record: &[u8]) -> Result<(Settings, u32, Receipt), Rejected> {
    let (header, crc) = Header::read(record).ok_or(Rejected::Blank)?;
    let payload = record.get(HEADER..HEADER + usize::from(header.length)).ok_or(Rejected::Damaged)?;
    if crc32(header.to_bytes().into_iter().chain(payload.iter().copied())) != crc {
        return Err(Rejected::Damaged);
    }
    if header.format != FORMAT {
        return Err(Rejected::Format(header.format));
    }
    match postcard::take_from_bytes::<Settings>(payload) {
        Ok((settings, [])) => {
            settings.check().map_err(Rejected::Illegal)?;
            Ok((settings, header.sequence, Receipt { bytes: HEADER + payload.len(), crc }))
        }
        // Whole, but of another shape: somebody forgot to count FORMAT up.
        _ => Err(Rejected::Damaged),
    }
}

#[cfg(test)]
mod tests;
