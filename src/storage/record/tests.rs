//! Tests of record: what it refuses, what it keeps, and what the first release has stored.

extern crate std;

mod longest;
mod spelled_out;

use super::*;
use crate::settings::OwnDriver;
use crate::settings::rows::{Field, Key, Value, Visitor};
use crate::units::StepsPerMm;
use proptest::prelude::*;
use spelled_out::spelled_out;
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
    let crc = crc32(&[&header, payload]);
    [&header, &crc.to_le_bytes()[..], payload].concat()
}

/// The bytes of a record, and its receipt.
fn record_of(settings: &Settings, unknown: &Unknown, sequence: u32) -> (Vec<u8>, Receipt) {
    let mut record = [0xA5; LONGEST];
    let receipt = encode(settings, unknown, sequence, &mut record).unwrap();
    (record[..receipt.bytes].to_vec(), receipt)
}

/// The settings in a record, and the rest of its content.
fn content(record: &[u8]) -> Result<(Settings, Decoded), Rejected> {
    let mut settings = Settings::prototype();
    decode(record, &mut settings).map(|decoded| (settings, decoded))
}

fn payload(settings: &Settings) -> Vec<u8> {
    record_of(settings, &Unknown::NONE, 7).0.split_off(HEADER)
}

/// The settings in a payload, and the elements that are unknown.
fn content_of_payload(payload: &[u8]) -> Result<(Settings, Unknown), Damaged> {
    let mut settings = Settings::prototype();
    read(payload, &mut settings).map(|unknown| (settings, unknown))
}

#[test]
fn the_checksum_is_that_of_zip() {
    assert_eq!(crc32(&[b"1234", b"56789"]), 0xCBF4_3926);
    assert_eq!(crc32(&[&[0; 32]]), 0x190A_55AD);
}

#[test]
fn a_record_reads_back() {
    let mut settings = Settings::prototype();
    settings.drivers.own[5] = OwnDriver { current_ma: 655, hold_percent: 99, stall_threshold: 255 };
    let (record, receipt) = record_of(&settings, &Unknown::NONE, 41);
    assert_eq!(length(&record[..HEADER]), Ok(receipt.bytes));
    let decoded = Decoded { unknown: Unknown::NONE, sequence: 41, receipt };
    assert_eq!(content(&record), Ok((settings, decoded)));
}

/// A record of the settings of `spelled_out`, of release 0.1.0.
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/storage/record/format1.bin");

#[test]
fn a_record_of_the_first_release_reads_back() {
    let (settings, decoded) = content(&std::fs::read(FILE).unwrap()).unwrap();
    assert_eq!((settings, decoded.sequence, decoded.unknown), (spelled_out(), 1, Unknown::NONE));
}

/// If an id or the shape of a value has changed, stored settings would be lost: that must not be. The values are
/// spelled out, so that new defaults do not matter. A later setting has an element more, or is a part more of an
/// element: an older reader takes the parts that it knows.
#[test]
fn ids_and_values_are_written_as_in_the_first_release() {
    let file = std::fs::read(FILE).unwrap();
    let (bytes, _) = record_of(&spelled_out(), &Unknown::NONE, 1);
    let (mut released, mut written) = (elements(&file[HEADER..]), elements(&bytes[HEADER..]));
    written.retain(|(id, _)| released.iter().any(|(other, _)| other == id));
    // Each says its id, so their order is not a part of the format.
    released.sort_unstable();
    written.sort_unstable();
    // The first byte has the kind and the number of parts.
    for ((_, first), (_, now)) in released.iter().zip(&mut written) {
        if now[0] & 0xF0 == first[0] & 0xF0 && now[0] > first[0] {
            now[0] = first[0];
            now.truncate(first.len());
        }
    }
    assert_eq!(released, written);
}

#[test]
fn records_of_other_formats_are_refused_by_their_number() {
    let settings = payload(&spelled_out());
    for format in [0, 3, 15, 99] {
        assert_eq!(content(&forge(format, &settings)), Err(Rejected::Format(format)));
    }
}

/// The elements of a payload: their ids, and all of their bytes with the id among them. Written a second time, as a
/// check.
fn elements(payload: &[u8]) -> Vec<(u16, Vec<u8>)> {
    let (mut elements, mut rest, mut id) = (Vec::new(), payload, 0);
    while let [head, after @ ..] = rest {
        let mut at = 0;
        id += 1;
        if head & 128 != 0 {
            (id, at) = (u16::from(after[0]), 1);
            if id >= 128 {
                (id, at) = (id & 127 | u16::from(after[1]) << 7, 2);
            }
        }
        let before_width = at;
        let mut width = head >> 4 & 7;
        if width == 0 {
            (width, at) = (after[at], at + 1);
        }
        let end = at + usize::from(width) * usize::from(head & 15);
        elements.push((id, [&[head | 128][..], &number(id), &after[before_width..end]].concat()));
        rest = &after[end..];
    }
    elements
}

/// An id as an element has it.
fn number(id: u16) -> Vec<u8> {
    if id < 128 { [id as u8].to_vec() } else { [id as u8 & 127 | 128, (id >> 7) as u8].to_vec() }
}

#[test]
fn a_setting_that_a_record_does_not_have_is_at_its_default() {
    let whole = payload(&spelled_out());
    let elements = elements(&whole);
    assert!(elements.len() > 95, "{}", elements.len());
    let default = Settings::prototype();
    for (left_out, _) in &elements {
        let kept: Vec<u8> =
            elements.iter().filter(|(id, _)| id != left_out).flat_map(|(_, bytes)| bytes.clone()).collect();
        let (settings, unknown) = content_of_payload(&kept).unwrap();
        assert_eq!(unknown, Unknown::NONE);
        // Only that one, of all parts that have it.
        for ((key, value), (_, spelled)) in values(&settings).into_iter().zip(values(&spelled_out())) {
            // The rule for corners has two keys; the other one has a value then.
            let is_left_out = key.row.id == *left_out || [key.row.id, *left_out] == [19, 99];
            let expected = if is_left_out { values_of(&default, key) } else { spelled };
            assert_eq!(value, expected, "{key} without {left_out}");
        }
    }
}

/// Every key with its value.
fn values(settings: &Settings) -> Vec<(Key, Value)> {
    struct All(Vec<(Key, Value)>);
    impl Visitor for All {
        fn visit(&mut self, key: Key, field: &mut dyn Field) {
            self.0.push((key, field.get()));
        }
    }
    let mut all = All(Vec::new());
    settings.clone().visit(&mut all);
    all.0
}

fn values_of(settings: &Settings, key: Key) -> Value {
    // Without its element the rule is the default one, and so its other key has no value.
    values(settings).into_iter().find(|(other, _)| *other == key).unwrap().1
}

#[test]
fn what_later_firmware_has_stored_is_kept_and_known_by_its_ids() {
    // One with its width in its head, an empty one without an id, one with no width.
    let (first, second, third) = ([0xA1, 0xFF, 0x03, 7, 8], [0x10], [0x81, 0x81, 0x04, 0]);
    let settings = elements(&payload(&spelled_out())).into_iter().flat_map(|(_, bytes)| bytes);
    let mut later: Vec<u8> = first.into_iter().chain(second).chain(settings).collect();
    later.extend(third);
    let (settings, decoded) = content(&forge(ONE_PART, &later)).unwrap();
    assert_eq!(settings, spelled_out());
    assert_eq!(decoded.unknown.ids().collect::<Vec<_>>(), [511, 512, 513]);
    // They are in the next record too, behind all others.
    let (again, _) = record_of(&Settings::prototype(), &decoded.unknown, 8);
    let kept = [&[0x81, 0xFF, 0x03, 2, 7, 8][..], &[0x80, 0x80, 0x04, 1], &third].concat();
    assert!(again.ends_with(&kept), "{again:?}");
    assert_eq!(content(&again).unwrap().1.unknown, decoded.unknown);
    // Elements without room are lost, and the rest is kept.
    let mut long = payload(&Settings::prototype());
    long.extend([0x81, 0xFF, 0x03, 61]);
    long.extend([1; 61]);
    long.extend([0x90, 0x80, 0x04]);
    assert_eq!(content(&forge(ONE_PART, &long)).unwrap().1.unknown.ids().collect::<Vec<_>>(), [512]);
}

#[test]
fn a_machine_with_more_or_fewer_parts_reads_those_that_it_has() {
    let whole = payload(&spelled_out());
    let mut other: Vec<u8> = Vec::new();
    for (id, bytes) in elements(&whole) {
        match id {
            // One motor more than there is, and one fan less, which take eight bytes and one.
            96 => {
                other.extend([bytes[0] + 1, 96]);
                other.extend(&bytes[2..]);
                other.extend(b"M9\0\0\0\0\0\0");
            }
            93 => {
                other.extend([bytes[0] - 1, 93]);
                other.extend(&bytes[2..bytes.len() - 1]);
            }
            _ => other.extend(bytes),
        }
    }
    let (settings, _) = content_of_payload(&other).unwrap();
    let mut expected = spelled_out();
    expected.thermal.fans[5].kick_ms = Settings::prototype().thermal.fans[5].kick_ms;
    assert_eq!(settings, expected);
}

/// No settings are that long yet, so the room is filled byte by byte.
#[test]
fn a_record_that_is_too_long_for_one_part_has_two() {
    let settings = Settings::prototype();
    let payload = payload(&settings);
    for length in [FIRST - HEADER, FIRST - HEADER + 1, ROOM - 1, ROOM] {
        let mut bytes = [0xA5; LONGEST];
        bytes[HEADER..HEADER + length].fill(0x10);
        bytes[HEADER..HEADER + payload.len()].copy_from_slice(&payload);
        let receipt = finish(&mut bytes, length, 9).unwrap();
        let parts = if length <= FIRST - HEADER { ONE_PART } else { TWO_PARTS };
        let more = if parts == ONE_PART { 0 } else { SECOND_HEADER };
        assert_eq!((bytes[4], receipt.bytes), (parts as u8, HEADER + more + length));
        assert_eq!(super::length(&bytes[..32]), Ok(receipt.bytes));
        let whole = &bytes[..receipt.bytes];
        let found = content(whole).unwrap();
        assert_eq!((found.0, found.1.sequence, found.1.receipt), (settings, 9, receipt));
        // All of it counts, and a first part never goes with another second one.
        for at in (0..whole.len()).chain([whole.len() - 1]) {
            let mut spoilt = whole.to_vec();
            spoilt[at] ^= 1 << (at % 8);
            assert!(content(&spoilt).is_err(), "{at}");
            assert!(content(&whole[..at]).is_err(), "{at}");
        }
        // Earlier firmware takes the first part for a whole record, and looks at its format last.
        let first = &whole[..whole.len().min(FIRST)];
        let sum = crc32(&[&first[..12], &first[HEADER..]]);
        assert_eq!(first[12..16], sum.to_le_bytes());
        assert_eq!(usize::from(u16::from_le_bytes([first[6], first[7]])), first.len() - HEADER);
    }
    assert_eq!(finish(&mut [0; LONGEST], ROOM + 1, 9), None);
    assert_eq!(finish(&mut [0; LONGEST], LONGEST, 9), None);
}

#[test]
fn a_damaged_format_is_no_other_format() {
    let mut record = forge(ONE_PART, &payload(&Settings::prototype()));
    assert!(content(&record).is_ok());
    record[4] ^= 2;
    assert_eq!(content(&record), Err(Rejected::Damaged));
}

#[test]
fn values_that_are_illegal_today_are_rejected() {
    let mut s = Settings::prototype();
    s.axes.x.steps_per_mm = StepsPerMm::from_num(160);
    let record = forge(ONE_PART, &payload(&s));
    assert_eq!(content(&record), Err(Rejected::Illegal(SettingsError::ResolutionsDiffer("x and y"))));
    let mut s = Settings::prototype();
    s.drivers.z.microsteps = 32;
    assert!(content(&forge(ONE_PART, &payload(&s))).is_ok());
    (s.mechanism.rows[1], s.axes.z.steps_per_mm) = ([-1, -1, 1, 0], s.axes.x.steps_per_mm);
    let record = content(&forge(ONE_PART, &payload(&s)));
    assert!(matches!(record, Err(Rejected::Illegal(SettingsError::MicrostepsDiffer { .. }))), "{record:?}");
}

#[test]
fn a_payload_that_is_cut_or_has_a_value_of_another_type_is_rejected() {
    let whole = payload(&Settings::prototype());
    let damaged = |bytes: &[u8]| assert_eq!(content(&forge(ONE_PART, bytes)), Err(Rejected::Damaged), "{bytes:?}");
    damaged(&whole[..whole.len() - 1]);
    damaged(&[whole.clone(), [0xFF].to_vec()].concat());
    // A switch that is 2, an unknown choice, an illegal name, a speed of 48 bits, a speed of nine bytes, and the rows
    // 641 and -641 of motors.
    for element in [
        &[0x91, 11, 2][..],
        &[0x91, 58, 20],
        &[0xA1, 1, b'a', b':'],
        &[0xF1, 2, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0],
        &[0x81, 2, 9, 1, 0, 0, 0, 0, 0, 0, 0, 0],
        &[0xA1, 98, 0x81, 2],
        &[0xA1, 98, 0x7F, 0xFD],
    ] {
        damaged(element);
    }
    // An empty one has no value.
    for empty in [&[0x90, 2][..], &[0x81, 2, 0], &[0x80, 2, 4]] {
        let and_all = elements(&whole).into_iter().flat_map(|(_, bytes)| bytes);
        let payload: Vec<u8> = empty.iter().copied().chain(and_all).collect();
        assert!(content(&forge(ONE_PART, &payload)).is_ok(), "{empty:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// The result for any content of a record with a right checksum: legal settings or none.
    #[test]
    fn any_payload_is_legal_or_rejected(
        format in 0..=FORMAT,
        bytes in proptest::collection::vec(any::<u8>(), 0..LONGEST - HEADER),
    ) {
        if let Ok((settings, _)) = content(&forge(format, &bytes)) {
            prop_assert_eq!(settings.check(), Ok(()));
        }
    }

    /// The same with payloads that are nearly settings.
    #[test]
    fn a_changed_payload_is_legal_or_rejected(
        changes in proptest::collection::vec((any::<usize>(), any::<u8>()), 1..9),
    ) {
        let mut bytes = std::fs::read(FILE).unwrap().split_off(HEADER);
        for (at, value) in changes {
            let at = at % bytes.len();
            bytes[at] = value;
        }
        if let Ok((settings, _)) = content(&forge(ONE_PART, &bytes)) {
            prop_assert_eq!(settings.check(), Ok(()));
        }
    }

    #[test]
    fn any_bytes_are_no_settings(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        let _ = length(&bytes);
        prop_assert!(content(&bytes).is_err());
    }
}
