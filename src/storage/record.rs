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

use crate::kinematics::Mechanism;
use crate::settings::{Settings, SettingsError};

/// What the payload looks like. Every change of the shape of [`Settings`] needs the next number; a test
/// notices when that was forgotten.
pub const FORMAT: u16 = 6;

const MAGIC: [u8; 4] = *b"CHBS";

pub(super) const HEADER: usize = 16;

/// Longest record.
pub(super) const LONGEST: usize = 512;

// Postcard writes an integer of n bytes in at most n * 8 / 7 rounded up: 3 for u16, 5 for u32, 10 for i64, which the
// mechanism is stored as.
const _: () = assert!(HEADER + (size_of::<Settings>() - size_of::<Mechanism>()) * 3 / 2 + 10 <= LONGEST);

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

/// CRC-32 as in Ethernet and zip (IEEE 802.3, section 3.2.9). Ten lines instead of the `crc` crate, and bit by
/// bit instead of a table of 1 KiB: a record takes about 0.1 ms, a page of EEPROM 5 ms.
fn crc32(bytes: impl Iterator<Item = u8>) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            let divisor = if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
            crc = (crc >> 1) ^ divisor;
        }
    }
    !crc
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::settings::{Advance, AxisSettings, CornerRule, DriverSettings, Homing, Shaper, ShaperKind};
    use crate::units::{Hertz, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm};
    use proptest::prelude::*;
    use std::vec::Vec;

    #[test]
    fn users_read_what_was_found() {
        assert_eq!(std::format!("{}", Receipt { bytes: 241, crc: 0xABC }), "(241 bytes; crc 00000ABC)");
        let format = std::format!("{}", Rejected::Format(3));
        assert_eq!(format, std::format!("format V3, this firmware has V{FORMAT}"));
        let words = [Rejected::Blank, Rejected::Damaged, Rejected::Mechanism].map(|why| std::format!("{why}"));
        assert_eq!(words, ["empty", "damaged", "for a machine with another mechanism"]);
    }

    /// A whole record around any payload.
    fn forge(format: u16, payload: &[u8]) -> Vec<u8> {
        let header = Header { format, length: payload.len() as u16, sequence: 7 }.to_bytes();
        let crc = crc32(header.into_iter().chain(payload.iter().copied()));
        [&header, &crc.to_le_bytes()[..], payload].concat()
    }

    fn payload(settings: &Settings) -> Vec<u8> {
        let record = encode(settings, 7).unwrap();
        record.bytes[HEADER..record.receipt.bytes].to_vec()
    }

    #[test]
    fn the_checksum_is_that_of_zip() {
        assert_eq!(crc32(b"123456789".iter().copied()), 0xCBF4_3926);
        assert_eq!(crc32([0; 32].into_iter()), 0x190A_55AD);
    }

    #[test]
    fn a_record_reads_back() {
        let settings = Settings::prototype();
        let record = encode(&settings, 41).unwrap();
        assert_eq!(length(&record.bytes[..HEADER]), Ok(record.receipt.bytes));
        assert_eq!(decode(&record.bytes), Ok((settings, 41, record.receipt)));
    }

    /// If this fails because [`Settings`] changed its shape, count [`FORMAT`] up, then put the new figures
    /// here. The values are spelled out, so that new defaults do not matter.
    #[test]
    fn the_shape_of_this_format_is_known() {
        let mut s = Settings::prototype();
        for (i, axis) in [&mut s.axes.x, &mut s.axes.y, &mut s.axes.z, &mut s.axes.e].into_iter().enumerate() {
            let i = i as i32;
            *axis = AxisSettings {
                steps_per_mm: StepsPerMm::from_num(100),
                max_speed: MmPerSec::from_num(200 + i),
                max_acceleration: MmPerSec2::from_num(3000 + i),
                length: Mm::from_num(400 + i),
            };
        }
        let homing = Homing { fast: MmPerSec::ONE, slow: MmPerSec::lit("0.5"), back_off: Mm::lit("2.5") };
        (s.homing.x, s.homing.y, s.homing.z) = (homing, homing, homing);
        (s.motor_max_speed, s.motor_max_acceleration) = (MmPerSec::from_num(451), MmPerSec2::from_num(7501));
        (s.print_acceleration, s.retract_acceleration) = (MmPerSec2::from_num(3001), MmPerSec2::from_num(3002));
        s.travel_acceleration = MmPerSec2::from_num(5001);
        s.corner = CornerRule::SquareCorner(MmPerSec::from_num(9));
        s.extruder_jerk = MmPerSec::from_num(6);
        (s.min_feed, s.min_travel) = (MmPerSec::ONE, MmPerSec::ZERO);
        let shaper = |kind, hertz| Shaper {
            span: Mm::from_num(800),
            motor_frequency: Hertz::from_num(300),
            ..Shaper::new(kind, Hertz::from_num(hertz), Ratio::lit("0.05"))
        };
        (s.shapers.x, s.shapers.y) = (shaper(ShaperKind::Mzv, 61), shaper(ShaperKind::TwoHumpEi, 42));
        s.advance = Advance { time: Seconds::lit("0.06"), window: Seconds::lit("0.03") };
        (s.soft_endstops, s.arc_tolerance, s.keepalive_s) = (true, Mm::lit("0.005"), 2);
        (s.patience_ms, s.advanced_ok) = (700, true);
        s.lookahead_time = Seconds::const_from_int(3);
        s.minimum_cruise_ratio = Ratio::lit("0.4");
        for (i, drivers) in [&mut s.drivers.belt, &mut s.drivers.z, &mut s.drivers.e].into_iter().enumerate() {
            *drivers = DriverSettings {
                current_ma: 900 + i as u16,
                hold_percent: 60,
                microsteps: 32,
                stealth: true,
                hybrid_threshold: MmPerSec::from_num(120),
                stall_threshold: 70,
            };
        }
        s.mechanism = Mechanism::corehbot();
        s.require_homing = true;
        let receipt = encode(&s, 1).unwrap().receipt;
        assert_eq!((FORMAT, receipt), (6, Receipt { bytes: 241, crc: 2_079_842_538 }));
    }

    #[test]
    fn the_longest_values_fit() {
        let mut s = Settings::prototype();
        let axis = AxisSettings {
            steps_per_mm: StepsPerMm::MAX,
            max_speed: MmPerSec::MAX,
            max_acceleration: MmPerSec2::MAX,
            length: Mm::MIN,
        };
        (s.axes.x, s.axes.y, s.axes.z, s.axes.e) = (axis, axis, axis, axis);
        let homing = Homing { fast: MmPerSec::MAX, slow: MmPerSec::MAX, back_off: Mm::MIN };
        (s.homing.x, s.homing.y, s.homing.z) = (homing, homing, homing);
        s.corner = CornerRule::JunctionDeviation(Mm::MIN);
        let shaper = Shaper {
            span: Mm::MIN,
            motor_frequency: Hertz::MAX,
            ..Shaper::new(ShaperKind::TwoHumpEi, Hertz::MAX, Ratio::MAX)
        };
        (s.shapers.x, s.shapers.y) = (shaper, shaper);
        s.advance = Advance { time: Seconds::MAX, window: Seconds::MAX };
        let drivers = DriverSettings {
            current_ma: u16::MAX,
            hold_percent: u8::MAX,
            microsteps: u16::MAX,
            stealth: true,
            hybrid_threshold: MmPerSec::MAX,
            stall_threshold: u8::MAX,
        };
        (s.drivers.belt, s.drivers.z, s.drivers.e) = (drivers, drivers, drivers);
        assert!(encode(&s, u32::MAX).unwrap().receipt.bytes <= LONGEST);
    }

    #[test]
    fn a_record_of_another_format_is_no_damaged_one() {
        let settings = payload(&Settings::prototype());
        assert_eq!(decode(&forge(FORMAT + 1, &settings)), Err(Rejected::Format(FORMAT + 1)));
        let mut record = forge(FORMAT, &settings);
        assert!(decode(&record).is_ok());
        record[4] ^= 2;
        assert_eq!(decode(&record), Err(Rejected::Damaged));
    }

    #[test]
    fn values_that_are_illegal_today_are_rejected() {
        let mut s = Settings::prototype();
        s.axes.x.steps_per_mm = StepsPerMm::from_num(160);
        let record = forge(FORMAT, &payload(&s));
        assert_eq!(decode(&record), Err(Rejected::Illegal(SettingsError::ResolutionsDiffer("x and y"))));
    }

    #[test]
    fn a_payload_of_another_shape_is_rejected() {
        let mut longer = payload(&Settings::prototype());
        longer.push(0);
        assert_eq!(decode(&forge(FORMAT, &longer)), Err(Rejected::Damaged));
        longer.truncate(longer.len() - 2);
        assert_eq!(decode(&forge(FORMAT, &longer)), Err(Rejected::Damaged));
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Whatever is inside a record with a right checksum: legal settings or none.
        #[test]
        fn any_payload_is_legal_or_rejected(bytes in proptest::collection::vec(any::<u8>(), 0..LONGEST - HEADER)) {
            if let Ok((settings, ..)) = decode(&forge(FORMAT, &bytes)) {
                prop_assert_eq!(settings.check(), Ok(()));
            }
        }

        /// The same with payloads that are nearly settings.
        #[test]
        fn a_changed_payload_is_legal_or_rejected(changes in proptest::collection::vec((any::<usize>(), any::<u8>()), 1..9)) {
            let mut bytes = payload(&Settings::prototype());
            for (at, value) in changes {
                let at = at % bytes.len();
                bytes[at] = value;
            }
            if let Ok((settings, ..)) = decode(&forge(FORMAT, &bytes)) {
                prop_assert_eq!(settings.check(), Ok(()));
            }
        }

        #[test]
        fn any_bytes_are_no_settings(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
            let _ = length(&bytes);
            prop_assert!(decode(&bytes).is_err());
        }
    }
}
