//! Records of two parts, which settings with many long values need: they are saved, cut and read as the others, next to
//! the mesh between their parts. Firmware that only knows one part names their format.

use super::memories::{Cut, Eeprom, Stuck, TORN, now};
use super::{PowerCut, crc, cut_save, newest, size_of_save, variant};
use corehbot::settings::rows::{Field, Key, Value, Visitor};
use corehbot::settings::{Settings, Thermistor};
use corehbot::storage::{self, FORMAT, MeshRejected, PAGE, Rejected, STRIDE, Slot, StoredMesh};
use corehbot::surface::{Heights, Mesh};
use corehbot::units::Mm;
use std::ops::Range;
use std::sync::LazyLock;

/// Bytes of the longest record of one part. It is spelled out: earlier firmware has this number in it.
const ONE_PART: usize = 1280;

/// Puts long values into the fields from one number to another, where they take them: `eighths` of the greatest one.
struct Lengthen {
    fields: Range<usize>,
    eighths: i64,
    at: usize,
}

impl Visitor for Lengthen {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        if self.fields.contains(&self.at) {
            let legal = key.row.legal(key.part.into());
            let most = if -legal.least > legal.most { legal.least } else { legal.most };
            // Names of motors differ from each other.
            let other = char::from(b'A' + (self.at % 26) as u8);
            let text =
                |first| Value::Text([first, other].into_iter().chain(['M'; 22]).take(legal.most as usize).collect());
            let longest = match field.get() {
                Value::Text(_) => text('M'),
                _ => Value::Number((i128::from(most) * i128::from(self.eighths) / 8) as i64),
            };
            let _ = field.set(&longest) || field.set(&text('!'));
        }
        self.at += 1;
    }
}

/// Settings with as many long values as are legal at once: of all axes together where they must be alike. `keepalive`
/// tells them apart.
fn long(keepalive: u8) -> Settings {
    static LONG: LazyLock<Settings> = LazyLock::new(|| {
        let bytes = |s: &Settings| storage::record_of(s, &mut [0; storage::LONGEST]).unwrap();
        let mut all = Lengthen { fields: 0..0, eighths: 8, at: 0 };
        let mut settings = Settings::prototype();
        settings.visit(&mut all);
        // What is legal only together.
        settings.axis_min.x = Mm::from_num(-200);
        settings.endstops.x.position = settings.axis_min.x;
        let thermistor = Thermistor::Beta { ohms: 100_000, beta: 3950, cubic: 0 };
        let heaters = &mut settings.thermal.heaters;
        for heater in [&mut heaters.hotend, &mut heaters.bed, &mut heaters.chamber] {
            heater.thermistor = thermistor;
        }
        settings.thermal.sensors.iter_mut().for_each(|sensor| sensor.thermistor = thermistor);
        settings.check().unwrap();
        for (eighths, begin, count) in [8, 7, 5]
            .into_iter()
            .flat_map(|eighths| (0..all.at).flat_map(move |at| [4, 3, 2, 1].map(|n| (eighths, at, n))))
        {
            let mut longer = settings;
            longer.visit(&mut Lengthen { fields: begin..begin + count, eighths, at: 0 });
            if longer.check().is_ok() && bytes(&longer) > bytes(&settings) {
                settings = longer;
            }
        }
        settings
    });
    let settings = Settings { keepalive_s: keepalive, ..*LONG };
    settings.check().unwrap();
    settings
}

/// A memory whose record has as many elements of later firmware as are kept, so that the next one is longer.
fn with_later_settings() -> Eeprom {
    let mut eeprom = Eeprom::with(&[variant(0)]);
    let used = 16 + usize::from(u16::from_le_bytes([eeprom.cells[6], eeprom.cells[7]]));
    let later = [0x80 | 4 << 4 | 15, 0xFF, 0x7F].into_iter().chain([0x5A; 60]);
    let end = used + later.clone().count();
    eeprom.cells[used..end].copy_from_slice(&later.collect::<Vec<u8>>());
    eeprom.cells[6..8].copy_from_slice(&(end as u16 - 16).to_le_bytes());
    let sum = crc(eeprom.cells[..12].iter().chain(&eeprom.cells[16..end]));
    eeprom.cells[12..16].copy_from_slice(&sum.to_le_bytes());
    assert_eq!(newest(&mut eeprom), Some(variant(0)));
    eeprom
}

/// A memory with a mesh and these settings, all of them with elements of later firmware.
fn with(settings: &[Settings]) -> Eeprom {
    let mut eeprom = with_later_settings();
    for s in settings {
        now(storage::save(&mut eeprom, s)).unwrap();
    }
    now(storage::save_mesh(&mut eeprom, &mesh(3), &Settings::prototype())).unwrap();
    now(storage::save_mesh(&mut eeprom, &mesh(4), &Settings::prototype())).unwrap();
    eeprom.writes.clear();
    eeprom
}

fn mesh(seed: i16) -> StoredMesh {
    let mut heights = Heights::flat(7, 7).unwrap();
    (0..49).for_each(|place| heights.set(place % 7, place / 7, seed * place as i16));
    let corner = |mm| [Mm::from_num(mm); 2];
    let mesh = Mesh::new(heights, corner(10), corner(380), Mm::from_num(20)).unwrap();
    StoredMesh { mesh, reference: corner(195), temperatures: [None; 2] }
}

fn loaded(eeprom: &mut Eeprom) -> Result<StoredMesh, MeshRejected> {
    now(storage::load_mesh(eeprom, &Settings::prototype())).unwrap()
}

/// What firmware before format 2 does with a slot, written a second time.
fn earlier_firmware(slot: &[u8]) -> Result<(), Rejected> {
    let number = |at: usize| u16::from_le_bytes([slot[at], slot[at + 1]]);
    let end = 16 + usize::from(number(6));
    if slot[..4] != *b"CHBS" {
        return Err(Rejected::Blank);
    }
    if end > ONE_PART || crc(slot[..12].iter().chain(&slot[16..end])).to_le_bytes() != slot[12..16] {
        return Err(Rejected::Damaged);
    }
    if number(4) == 1 { Ok(()) } else { Err(Rejected::Format(number(4))) }
}

#[test]
fn long_settings_are_kept_in_turns_and_the_mesh_stays() {
    let mut eeprom = with(&[variant(1)]);
    for n in 2..7 {
        eeprom.writes.clear();
        let s = if n == 4 { variant(4) } else { long(n) };
        let receipt = now(storage::save(&mut eeprom, &s)).unwrap();
        assert_eq!(receipt.bytes > ONE_PART, n != 4, "{} bytes", receipt.bytes);
        assert_eq!((eeprom.bytes_written(), eeprom.writes.len()), (receipt.bytes, receipt.bytes.div_ceil(PAGE)));
        assert!(eeprom.writes.is_sorted_by(|(a, _), (b, _)| a > b), "the header goes last: {:?}", eeprom.writes);
        let stored = now(storage::survey(&mut eeprom)).unwrap().newest.unwrap();
        assert_eq!((stored.settings, stored.receipt), (s, receipt));
        assert_eq!(stored.address(), [0, STRIDE][usize::from(n % 2)], "save {n} goes to the other slot");
        assert_eq!(stored.unknown.ids().collect::<Vec<_>>(), [0x3FFF], "and so do settings of later firmware");
        eeprom.writes.clear();
        assert_eq!(now(storage::save(&mut eeprom, &s)), Ok(receipt));
        assert_eq!(eeprom.writes, []);
        assert_eq!(loaded(&mut eeprom), Ok(mesh(4)));
    }
}

/// From a record of one part to one of two, from two to two, and back.
#[test]
fn a_cut_at_any_byte_leaves_the_old_or_the_new_for_long_records_too() {
    let cases = [
        (&[variant(1)][..], long(9)),
        (&[variant(1), long(2)], long(9)),
        (&[long(1), long(2), long(3)], long(9)),
        (&[long(1), long(2)], variant(9)),
    ];
    for (begin, next) in cases {
        let fresh = with(begin);
        let size = size_of_save(&fresh, &next);
        assert!(size > ONE_PART || next == variant(9));
        let (mut kept_old, old) = (0, newest(&mut fresh.clone()));
        for left in 0..size {
            for (torn, whole_page) in [(TORN[left % 6], false), (TORN[(left + 1) % 6], true)] {
                let mut eeprom = fresh.clone();
                let cut = PowerCut { left, torn, whole_page };
                kept_old += usize::from(cut_save(&mut eeprom, old, &next, cut) != Some(next));
                assert_eq!(loaded(&mut eeprom), Ok(mesh(4)));
                // And with power back, the same save succeeds.
                now(storage::save(&mut eeprom, &next)).unwrap();
                assert_eq!(newest(&mut eeprom), Some(next));
            }
        }
        assert!(kept_old > 2 * size - 50, "nearly every cut comes before the record is whole");
    }
}

#[test]
fn a_cut_mesh_never_costs_long_settings() {
    let fresh = with(&[long(1), long(2)]);
    for left in 0..148 {
        for torn in TORN {
            let mut eeprom = fresh.clone();
            let mut cut = Cut { eeprom: &mut eeprom, left, torn, whole_page: true, is_dead: false };
            now(storage::save_mesh(&mut cut, &mesh(5), &Settings::prototype())).unwrap_err();
            assert_eq!(newest(&mut eeprom), Some(long(2)));
            assert!([Ok(mesh(4)), Ok(mesh(5))].contains(&loaded(&mut eeprom)), "cut after {left}");
        }
    }
}

#[test]
fn no_flipped_bit_of_a_long_record_gives_other_settings() {
    let fresh = with(&[long(1), long(2)]);
    let used = now(storage::survey(&mut fresh.clone())).unwrap().newest.unwrap().receipt.bytes;
    let mut noticed = 0;
    for at in 0..fresh.cells.len() {
        let mut eeprom = fresh.clone();
        eeprom.cells[at] ^= 1 << (at % 8);
        let survey = now(storage::survey(&mut eeprom)).unwrap();
        let is_newest = survey.newest.unwrap().settings == long(2);
        noticed += usize::from(survey.rejected.iter().any(|(_, why)| why.is_some()));
        assert!(is_newest || survey.rejected[0].1.is_some(), "byte {at}");
    }
    assert_eq!(noticed, 2 * used);
}

#[test]
fn a_worn_cell_of_a_second_part_is_noticed_by_reading_back() {
    let fresh = with(&[variant(0), variant(1), variant(2)]);
    let mut stuck = Stuck(fresh, STRIDE as usize + ONE_PART + 160);
    stuck.0.cells[stuck.1] ^= 0xFF;
    assert_eq!(now(storage::save(&mut stuck, &long(5))), Err(storage::SaveError::NotKept));
    assert_eq!(newest(&mut stuck.0), Some(variant(2)));
}

/// Every record of one part is as before, so an owner may go back to earlier firmware.
#[test]
fn earlier_firmware_reads_short_records_and_names_the_format_of_long_ones() {
    let mut eeprom = with(&[variant(1), long(2)]);
    let slot = |eeprom: &Eeprom, slot: u32| earlier_firmware(&eeprom.cells[(slot * STRIDE) as usize..]);
    assert_eq!([slot(&eeprom, 0), slot(&eeprom, 1)], [Err(Rejected::Format(FORMAT)), Ok(())]);
    now(storage::save(&mut eeprom, &long(3))).unwrap();
    assert_eq!([slot(&eeprom, 0), slot(&eeprom, 1)], [Err(Rejected::Format(2)); 2]);
    // It stores its own, in the first slot; this firmware then takes the newer one, which is in the other slot.
    let theirs = Eeprom::with(&[variant(7)]);
    eeprom.cells[..ONE_PART].copy_from_slice(&theirs.cells[..ONE_PART]);
    let survey = now(storage::survey(&mut eeprom)).unwrap();
    assert_eq!(survey.newest.map(|stored| stored.settings), Some(long(3)));
    assert_eq!(survey.rejected, [(Slot::A, None), (Slot::B, None)]);
    assert_eq!(loaded(&mut eeprom), Ok(mesh(4)), "the mesh has its place");
}
