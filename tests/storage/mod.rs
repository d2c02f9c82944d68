//! Settings in a memory with power that can be cut. The settings saved before or the ones being saved survive, for any
//! damage to the byte or page being written.

mod long_records;
mod memories;
mod meshes;

use corehbot::port::{NoStorage, StorageError};
use corehbot::settings::Settings;
use corehbot::storage::{self, NEEDED, PAGE, Rejected, STRIDE, SaveError, Slot};
use corehbot::units::{Mm, MmPerSec};
use memories::{Cut, Eeprom, SIZE, Silent, Stuck, TORN, Torn, now};
use proptest::prelude::*;

/// Settings that differ in many bytes from one number to the next.
fn variant(n: u16) -> Settings {
    let mut s = Settings::prototype();
    for axis in [&mut s.axes.x, &mut s.axes.y] {
        axis.max_speed = MmPerSec::from_num(100 + n);
        axis.length = Mm::from_num(300 + n);
    }
    s.keepalive_s = (n % 60) as u8;
    s.soft_endstops = n.is_multiple_of(2);
    s.arc_tolerance = Mm::from_num(0.003 + f64::from(n) / 1000.0);
    s.check().unwrap();
    s
}

fn newest(eeprom: &mut Eeprom) -> Option<Settings> {
    now(storage::survey(eeprom)).unwrap().newest.map(|stored| stored.settings)
}

/// A power cut after `left` bytes.
struct PowerCut {
    left: usize,
    torn: Torn,
    whole_page: bool,
}

/// A save over `old` that is cut; afterwards one of the two must be readable.
fn cut_save(eeprom: &mut Eeprom, old: Option<Settings>, settings: &Settings, cut: PowerCut) -> Option<Settings> {
    let PowerCut { left, torn, whole_page } = cut;
    let result = now(storage::save(&mut Cut { eeprom, left, torn, whole_page, is_dead: false }, settings));
    assert_eq!(result, Err(SaveError::Storage(StorageError::Failed)), "cut after {left}");
    let now = newest(eeprom);
    assert!(now == old || now == Some(*settings), "cut after {left}: neither old nor new");
    now
}

/// CRC-32 bit by bit, as an independent check.
fn crc<'b>(bytes: impl Iterator<Item = &'b u8>) -> u32 {
    let bit = |sum: u32, _| if sum & 1 == 1 { sum >> 1 ^ 0xEDB8_8320 } else { sum >> 1 };
    !bytes.fold(!0, |sum, byte| (0..8).fold(sum ^ u32::from(*byte), bit))
}

/// Bytes that saving this here would write.
fn size_of_save(eeprom: &Eeprom, settings: &Settings) -> usize {
    let mut eeprom = eeprom.clone();
    eeprom.writes.clear();
    now(storage::save(&mut eeprom, settings)).unwrap();
    eeprom.bytes_written()
}

#[test]
fn what_was_saved_last_is_read() {
    let mut eeprom = Eeprom::blank();
    assert_eq!(newest(&mut eeprom), None);
    for n in 0..5 {
        let receipt = now(storage::save(&mut eeprom, &variant(n))).unwrap();
        let stored = now(storage::survey(&mut eeprom)).unwrap().newest.unwrap();
        assert_eq!((stored.settings, stored.receipt), (variant(n), receipt));
        assert_eq!(stored.address(), [0, STRIDE][usize::from(n % 2)], "save {n} goes to the other slot");
    }
}

#[test]
fn a_printer_starts_as_the_machine_that_was_saved_last_if_it_is_one() {
    let mut eeprom = Eeprom::blank();
    assert_eq!(now(storage::stored_machine(&mut eeprom)), None);
    for n in 0..3 {
        now(storage::save(&mut eeprom, &variant(n))).unwrap();
        assert_eq!(now(storage::stored_machine(&mut eeprom)), Some(variant(n)));
    }
    // No motor turns an axis; a save checks the other settings alone.
    let mut loose = variant(3);
    loose.mechanism.rows = Default::default();
    now(storage::save(&mut eeprom, &loose)).unwrap();
    assert_eq!(newest(&mut eeprom), Some(loose));
    assert_eq!(now(storage::stored_machine(&mut eeprom)), None);
    assert_eq!(now(storage::stored_machine(&mut NoStorage)), None);
}

#[test]
fn a_cut_at_any_byte_leaves_the_old_or_the_new() {
    for begin in [&[][..], &[variant(0)], &[variant(0), variant(1)], &[variant(0), variant(1), variant(2)]] {
        let fresh = Eeprom::with(begin);
        let next = variant(7);
        let size = size_of_save(&fresh, &next);
        assert!(size > 100);
        let mut kept_old = 0;
        let old = newest(&mut fresh.clone());
        for torn in TORN {
            for whole_page in [false, true] {
                for left in 0..size {
                    let mut eeprom = fresh.clone();
                    let cut = PowerCut { left, torn, whole_page };
                    kept_old += usize::from(cut_save(&mut eeprom, old, &next, cut) != Some(next));
                    // And with power back, the same save succeeds.
                    now(storage::save(&mut eeprom, &next)).unwrap();
                    assert_eq!(newest(&mut eeprom), Some(next));
                }
            }
        }
        assert!(kept_old > 9 * size, "nearly every cut comes before the record is whole");
    }
}

/// The first cut comes at every third byte, so at every place of a page of 32 bytes in each three pages; the test of
/// one cut has all bytes. The second cut comes at every thirteenth byte, from another one for each first cut. So it
/// comes at every byte, and with every kind of damage, over the first ones.
#[test]
fn a_cut_save_may_be_followed_by_another() {
    let fresh = Eeprom::with(&[variant(0), variant(1)]);
    let size = size_of_save(&fresh, &variant(2));
    for first in (0..size).step_by(3) {
        let mut once = fresh.clone();
        let cut = PowerCut { left: first, torn: TORN[4], whole_page: first % 2 == 0 };
        let after_first = cut_save(&mut once, Some(variant(1)), &variant(2), cut);
        for second in (first % 13..size_of_save(&once, &variant(3)).min(size)).step_by(13) {
            let mut twice = once.clone();
            let cut = PowerCut { left: second, torn: TORN[second % 6], whole_page: second % 2 == 0 };
            let after_second = cut_save(&mut twice, after_first, &variant(3), cut);
            assert!(after_second == after_first || after_second == Some(variant(3)));
            now(storage::save(&mut twice, &variant(4))).unwrap();
            assert_eq!(newest(&mut twice), Some(variant(4)));
        }
    }
}

#[test]
fn no_flipped_bit_gives_other_settings() {
    let fresh = Eeprom::with(&[variant(0), variant(1)]);
    let used = now(storage::survey(&mut fresh.clone())).unwrap().newest.unwrap().receipt.bytes;
    let mut noticed = 0;
    for bit in 0..SIZE * 8 {
        let mut eeprom = fresh.clone();
        eeprom.cells[bit / 8] ^= 1 << (bit % 8);
        let survey = now(storage::survey(&mut eeprom)).unwrap();
        let found = survey.newest.unwrap().settings;
        noticed += usize::from(survey.rejected.iter().any(|(_, why)| why.is_some()));
        // The newest are in slot B; if they are damaged, those before them count.
        let in_b = (STRIDE as usize..STRIDE as usize + used).contains(&(bit / 8));
        assert_eq!(found, variant(u16::from(!in_b)), "bit {bit}");
    }
    assert_eq!(noticed, 2 * used * 8);
}

#[test]
fn slots_take_turns_and_unchanged_settings_cost_nothing() {
    let mut eeprom = Eeprom::blank();
    let mut counts = [0; 2];
    for n in 0..10 {
        eeprom.writes.clear();
        let receipt = now(storage::save(&mut eeprom, &variant(n))).unwrap();
        assert_eq!(eeprom.bytes_written(), receipt.bytes);
        assert_eq!(eeprom.writes.len(), receipt.bytes.div_ceil(PAGE), "each page is written once");
        let slot = eeprom.writes[0].0 / STRIDE;
        assert!(eeprom.writes.iter().all(|(at, _)| at / STRIDE == slot));
        assert!(eeprom.writes.is_sorted_by(|(a, _), (b, _)| a > b), "the header goes last: {:?}", eeprom.writes);
        counts[slot as usize] += 1;
        eeprom.writes.clear();
        assert_eq!(now(storage::save(&mut eeprom, &variant(n))), Ok(receipt));
        assert_eq!(eeprom.writes, []);
    }
    assert_eq!(counts, [5, 5]);
}

#[test]
fn a_record_of_another_format_is_left_until_its_turn() {
    let mut eeprom = Eeprom::with(&[variant(0)]);
    // The next format, at first without and then with the right checksum.
    let next = storage::FORMAT + 1;
    eeprom.cells[4..6].copy_from_slice(&next.to_le_bytes());
    assert_eq!(now(storage::survey(&mut eeprom)).unwrap().rejected[0], (Slot::A, Some(Rejected::Damaged)));
    let used = 16 + usize::from(u16::from_le_bytes([eeprom.cells[6], eeprom.cells[7]]));
    let sum = crc(eeprom.cells[..12].iter().chain(&eeprom.cells[16..used]));
    eeprom.cells[12..16].copy_from_slice(&sum.to_le_bytes());
    let survey = now(storage::survey(&mut eeprom)).unwrap();
    assert_eq!((survey.newest, survey.rejected[0].1), (None, Some(Rejected::Format(next))));
    now(storage::save(&mut eeprom, &variant(1))).unwrap();
    assert_eq!(newest(&mut eeprom), Some(variant(1)));
}

#[test]
fn a_worn_cell_is_noticed_by_reading_back() {
    let fresh = Eeprom::with(&[variant(0), variant(1)]);
    // Cells of slot A in which the records of 0 and 2 differ.
    let mut new = fresh.clone();
    now(storage::save(&mut new, &variant(2))).unwrap();
    let differ: Vec<usize> = (0..SIZE).filter(|at| fresh.cells[*at] != new.cells[*at]).collect();
    assert!(differ.len() > 10);
    for at in differ {
        let mut stuck = Stuck(fresh.clone(), at);
        assert_eq!(now(storage::save(&mut stuck, &variant(2))), Err(SaveError::NotKept));
        assert_eq!(newest(&mut stuck.0), Some(variant(1)));
    }
}

#[test]
fn what_cannot_be_read_is_not_taken_for_empty() {
    let fresh = Eeprom::with(&[variant(0), variant(1)]);
    let mut reads = 0;
    loop {
        let mut silent = Silent(fresh.clone(), reads);
        let result = now(storage::save(&mut silent, &variant(2)));
        if result.is_ok() {
            break;
        }
        assert_eq!(result, Err(SaveError::Storage(StorageError::Failed)));
        // Only the read-back comes after the writes.
        assert!(silent.0.writes.is_empty() || newest(&mut silent.0) == Some(variant(2)));
        reads += 1;
    }
    assert!(reads > 10);
}

#[test]
fn no_storage_is_said_and_too_little_is_none() {
    assert!(!storage::is_present(&NoStorage));
    let absent = StorageError::Absent;
    assert_eq!(now(storage::survey(&mut NoStorage)), Err(absent));
    assert_eq!(now(storage::save(&mut NoStorage, &variant(0))), Err(SaveError::Storage(absent)));
    let mut small = Eeprom::holding(vec![0xFF; NEEDED as usize - 1]);
    assert_eq!(now(storage::save(&mut small, &variant(0))), Err(SaveError::Storage(absent)));
    let mut exact = Eeprom::holding(vec![0xFF; NEEDED as usize]);
    assert!(storage::is_present(&exact) && now(storage::save(&mut exact, &variant(0))).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Random bytes, also after a header that looks right, are no settings and take a save.
    #[test]
    fn any_content_is_survived(
        seed in proptest::collection::vec(any::<u8>(), 64),
        magic: [bool; 2],
        length in 0u16..2000,
        format in 0u16..3,
    ) {
        let mut cells: Vec<u8> = (0..SIZE).map(|i| seed[i % 64] ^ seed[i / 64] ^ (i % 251) as u8).collect();
        for (slot, magic) in magic.into_iter().enumerate() {
            if magic {
                let head = &mut cells[slot * STRIDE as usize..];
                head[..4].copy_from_slice(b"CHBS");
                head[4..6].copy_from_slice(&format.to_le_bytes());
                head[6..8].copy_from_slice(&length.to_le_bytes());
            }
        }
        let mut eeprom = Eeprom::holding(cells);
        let survey = now(storage::survey(&mut eeprom)).unwrap();
        prop_assert_eq!(survey.newest, None);
        for (magic, (_, why)) in magic.into_iter().zip(survey.rejected) {
            prop_assert_eq!(why, Some(if magic { Rejected::Damaged } else { Rejected::Blank }));
        }
        now(storage::save(&mut eeprom, &variant(3))).unwrap();
        prop_assert_eq!(newest(&mut eeprom), Some(variant(3)));
    }

    /// Any number of saves, each perhaps cut: never anything but the last that was whole or the one after.
    #[test]
    fn any_history_of_cuts_leaves_something_that_was_saved(
        history in proptest::collection::vec((any::<bool>(), 0usize..200, 0usize..6, any::<bool>()), 1..40),
    ) {
        let mut eeprom = Eeprom::blank();
        for (n, (is_cut, left, torn, whole_page)) in history.into_iter().enumerate() {
            let settings = variant(n as u16);
            if is_cut && left < size_of_save(&eeprom, &settings) {
                let old = newest(&mut eeprom);
                cut_save(&mut eeprom, old, &settings, PowerCut { left, torn: TORN[torn], whole_page });
            } else {
                now(storage::save(&mut eeprom, &settings)).unwrap();
                prop_assert_eq!(newest(&mut eeprom), Some(settings));
            }
        }
    }
}

/// A baseline counts for the model with its sum alone, and one that is cut while it is stored is the old one or none.
#[test]
fn a_baseline_is_of_its_model_and_a_cut_one_is_the_old_one_or_none() {
    let mut eeprom = Eeprom::blank();
    let read = |eeprom: &mut Eeprom, heater, subject| now(storage::baseline(eeprom, heater, subject)).unwrap();
    assert_eq!(read(&mut eeprom, 0, 7), None);
    now(storage::note_baseline(&mut eeprom, 0, 7, [250, 260])).unwrap();
    now(storage::note_baseline(&mut eeprom, 1, 7, [300, 310])).unwrap();
    assert_eq!([read(&mut eeprom, 0, 7), read(&mut eeprom, 0, 8)], [Some([250, 260]), None]);
    for left in 0..8 {
        for torn in TORN {
            let mut copy = eeprom.clone();
            let mut cut = Cut { eeprom: &mut copy, left, torn, whole_page: false, is_dead: false };
            now(storage::note_baseline(&mut cut, 0, 9, [200, 210])).unwrap_err();
            assert!([None, Some([250, 260])].contains(&read(&mut copy, 0, 7)), "{left}");
            assert!([None, Some([200, 210])].contains(&read(&mut copy, 0, 9)), "{left}");
            assert_eq!(read(&mut copy, 1, 7), Some([300, 310]), "{left}");
        }
    }
    // Erased by M303 or M306.
    now(storage::note_baseline(&mut eeprom, 0, 0, [0; 2])).unwrap();
    assert_eq!([read(&mut eeprom, 0, 7), read(&mut eeprom, 0, 0)], [None; 2]);
}

#[test]
fn a_cut_note_of_a_self_test_is_the_old_one_or_none_and_never_costs_settings() {
    let mut before = Eeprom::blank();
    now(storage::save(&mut before, &variant(1))).unwrap();
    assert_eq!(now(storage::passed_test(&mut before)), Ok(None));
    now(storage::note_passed_test(&mut before, 0x1234_5678)).unwrap();
    assert_eq!(now(storage::passed_test(&mut before)), Ok(Some(0x1234_5678)));
    for (left, torn, whole_page) in
        (0..8).flat_map(|left| TORN.map(|torn| (left, torn, false))).chain([(3, TORN[3], true)])
    {
        let mut eeprom = before.clone();
        let mut cut = Cut { eeprom: &mut eeprom, left, torn, whole_page, is_dead: false };
        now(storage::note_passed_test(&mut cut, 0x8765_4321)).unwrap_err();
        let found = now(storage::passed_test(&mut eeprom)).unwrap();
        assert!(matches!(found, None | Some(0x1234_5678 | 0x8765_4321)), "cut after {left}: {found:?}");
        assert_eq!(newest(&mut eeprom), Some(variant(1)));
    }
}

/// A board is put together as the machine that is stored, if its motors make one.
#[test]
fn a_board_is_started_as_the_machine_that_is_stored() {
    let stored = |settings: &Settings| {
        let mut eeprom = Eeprom::blank();
        now(storage::save(&mut eeprom, settings)).unwrap();
        now(storage::stored_machine(&mut eeprom))
    };
    let made = Settings::prototype();
    let mut other = variant(7);
    assert_eq!(stored(&other), Some(other));
    assert!(other.is_built_as(&made), "the same motors with other settings");
    other.mechanism.rows.swap(0, 1);
    assert_eq!(stored(&other), Some(other));
    assert!(!other.is_built_as(&made) && !Settings { baud: 9600, ..made }.is_built_as(&made));
    other.mechanism.rows = Default::default();
    assert_eq!(stored(&other), None, "nothing moves: no machine");
    assert_eq!(now(storage::stored_machine(&mut Eeprom::blank())), None);
    assert_eq!(now(storage::stored_machine(&mut NoStorage)), None);
}

/// Both slots and the note have separate places, and all of them are within the declared size.
#[test]
fn a_note_of_a_self_test_and_two_records_do_not_touch_each_other() {
    let mut eeprom = Eeprom::holding(vec![0xFF; NEEDED as usize]);
    for n in 0..4 {
        now(storage::save(&mut eeprom, &variant(n))).unwrap();
        now(storage::note_passed_test(&mut eeprom, u32::from(n))).unwrap();
        let survey = now(storage::survey(&mut eeprom)).unwrap();
        assert_eq!(survey.newest.map(|stored| stored.settings), Some(variant(n)));
        let whole = survey.rejected.iter().filter(|(_, why)| why.is_none()).count();
        assert_eq!(whole, usize::from(n + 1).min(2), "{:?}", survey.rejected);
        assert_eq!(now(storage::passed_test(&mut eeprom)), Ok(Some(n.into())));
    }
    let last = eeprom.writes.iter().map(|(at, size)| at + *size as u32).max();
    assert!(last.is_some_and(|last| last <= NEEDED && last > NEEDED - PAGE as u32));
}
